// SPDX-License-Identifier: BSD-3-Clause
#include "bag_index.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>

#include <bzlib.h>
#include <rosbag/constants.h>
#include <rosbag/stream.h>

#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

// The records' field `op`.
constexpr char kMessage = 2, kFileHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7;
constexpr std::string_view kVersion = "#ROSBAG V2.0\n";
constexpr std::size_t kIndexEntry_bytes = 12;  // time and place

[[noreturn]] void refuse(const std::string& reason) {
  throw std::runtime_error("it is damaged (" + reason + "); 'rosbag reindex' may mend it");
}

template <typename Number>
Number number_at(std::string_view bytes, std::size_t at) {
  Number number = 0;
  if (at + sizeof number > bytes.size()) refuse("a number is cut off");
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

// A length and as many bytes behind it, which begin at `at`.
std::string_view part_at(std::string_view bytes, std::size_t at) {
  const auto length = number_at<std::uint32_t>(bytes, at);
  if (length > bytes.size() - at - 4) refuse("a record is longer than what holds it");
  return bytes.substr(at + 4, length);
}

Fields fields_of(std::string_view header) {
  Fields fields;
  for (std::size_t at = 0; at < header.size();) {
    const std::string_view field = part_at(header, at);
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) refuse("a field without a value");
    fields[std::string(field.substr(0, equals))] = field.substr(equals + 1);
    at += 4 + field.size();
  }
  return fields;
}

const std::string& value_of(const Fields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end()) refuse("a record without '" + std::string(name) + "'");
  return found->second;
}

template <typename Number>
Number number_of(const Fields& fields, std::string_view name) {
  return number_at<Number>(value_of(fields, name), 0);
}

char kind_of(const Fields& fields) {
  const std::string& kind = value_of(fields, "op");
  if (kind.size() != 1) refuse("a record of no kind");
  return kind[0];
}

class BagReader {
 public:
  explicit BagReader(const std::string& path) : file_(path, std::ios::binary) {
    file_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(file_.tellg());
    file_.seekg(0);
  }

  bool is_open() const { return file_.is_open(); }
  bool is_bag() {
    std::string line(kVersion.size(), '\0');
    return file_.read(line.data(), static_cast<std::streamsize>(line.size())) && line == kVersion;
  }
  std::uint64_t place() { return static_cast<std::uint64_t>(file_.tellg()); }
  bool at_end() { return place() >= size_; }

  // A length and as many bytes.
  std::string part() {
    std::uint32_t length = 0;
    if (!file_.read(reinterpret_cast<char*>(&length), sizeof length) || length > size_ - place())
      refuse("a record goes beyond the end of the file");
    std::string bytes(length, '\0');
    file_.read(bytes.data(), static_cast<std::streamsize>(length));
    return bytes;
  }

 private:
  std::ifstream file_;
  std::uint64_t size_ = 0;
};

// rosbag takes as many bytes as the chunk announces, also where unpacking gives fewer.
std::string unpacked_bz2(std::string packed, std::uint32_t size) {
  std::string data(size, '\0');
  unsigned int unpacked = size;
  const int result =
      BZ2_bzBuffToBuffDecompress(data.data(), &unpacked, packed.data(), static_cast<unsigned int>(packed.size()), 0, 0);
  if (result != BZ_OK || unpacked != size) refuse("a chunk cannot be unpacked to the size that it says");
  return data;
}

std::string unpacked_lz4(std::string packed, std::uint32_t size) {
  std::string data(size, '\0');
  rosbag::LZ4Stream(nullptr).decompress(reinterpret_cast<std::uint8_t*>(data.data()), size,
                                        reinterpret_cast<std::uint8_t*>(packed.data()),
                                        static_cast<unsigned int>(packed.size()));
  return data;
}

// What a chunk holds, unpacked.
std::string chunk_of(const Fields& fields, std::string data) {
  const std::string& compression = value_of(fields, "compression");
  const auto size = number_of<std::uint32_t>(fields, "size");
  if (size > limits::kChunk_bytes)
    throw std::runtime_error("a chunk of " + std::to_string(size) + " bytes, must be at most " +
                             std::to_string(limits::kChunk_bytes));
  if (compression == rosbag::COMPRESSION_BZ2) return unpacked_bz2(std::move(data), size);
  if (compression == rosbag::COMPRESSION_LZ4) return unpacked_lz4(std::move(data), size);
  if (compression != rosbag::COMPRESSION_NONE) refuse("a chunk packed in a way that is not known");
  if (size != data.size()) refuse("a chunk of another size than it says");
  return data;
}

// Where its messages begin.
std::set<std::uint32_t> messages_of(std::string_view chunk) {
  std::set<std::uint32_t> messages;
  for (std::size_t at = 0; at < chunk.size();) {
    const std::string_view header = part_at(chunk, at);
    const char kind = kind_of(fields_of(header));
    if (kind == kMessage) messages.insert(messages.end(), static_cast<std::uint32_t>(at));
    at += 4 + header.size();
    const std::string_view data = part_at(chunk, at);
    if (kind == kConnection) fields_of(data);
    at += 4 + data.size();
  }
  return messages;
}

// The records of a bag, one after the other, as rosbag finds them by their places.
class Records {
 public:
  void add(std::uint64_t place, std::string_view header, std::string data) {
    const Fields fields = fields_of(header);
    const char kind = kind_of(fields);
    if (places_.empty() != (kind == kFileHeader)) refuse("its first record is no header of a file, or a later one is");
    places_.insert(places_.end(), place);
    if (kind == kFileHeader) add_file_header(fields);
    if (kind == kChunk) add_chunk(place, fields, std::move(data));
    if (kind == kIndex) add_index(fields, data);
    if (kind == kChunkInfo && chunks_.count(number_of<std::uint64_t>(fields, "chunk_pos")) == 0)
      refuse("it names a chunk where none is");
    if (kind != kConnection) return;
    fields_of(data);  // they are read as the header is
    if (place >= index_) connections_.insert(number_of<std::uint32_t>(fields, "conn"));
  }

  void require_whole(std::uint64_t end) const {
    if (index_ != 0 && index_ != end && places_.count(index_) == 0) refuse("it names an index where none is");
    for (const std::uint32_t connection : indexed_)
      if (connections_.count(connection) == 0) refuse("it has messages of a topic that it does not name");
  }

 private:
  void add_file_header(const Fields& fields) {
    const auto encryptor = fields.find("encryptor");
    if (encryptor != fields.end() && !encryptor->second.empty()) throw std::runtime_error("it is encrypted");
    index_ = number_of<std::uint64_t>(fields, "index_pos");
  }
  void add_chunk(std::uint64_t place, const Fields& fields, std::string data) {
    chunks_.insert(chunks_.end(), place);
    messages_ = messages_of(chunk_of(fields, std::move(data)));
  }
  void add_index(const Fields& fields, std::string_view index) {
    indexed_.insert(number_of<std::uint32_t>(fields, "conn"));
    if (number_of<std::uint32_t>(fields, "count") * kIndexEntry_bytes != index.size())
      refuse("it announces other entries than it has");
    for (std::size_t at = 0; at < index.size(); at += kIndexEntry_bytes)
      if (messages_.count(number_at<std::uint32_t>(index, at + 8)) == 0) refuse("it points to no message of its chunk");
  }

  std::set<std::uint64_t> places_, chunks_;
  std::set<std::uint32_t> messages_;               // of the last chunk
  std::set<std::uint32_t> connections_, indexed_;  // topics by number: that are named, and that have messages
  std::uint64_t index_ = 0;                        // where what lies behind the chunks begins
};

}  // namespace

void require_sound(const std::string& bag) {
  BagReader reader(bag);
  if (!reader.is_open()) return;  // rosbag says why
  if (!reader.is_bag()) throw std::runtime_error("cannot be read as a bag: it does not begin with '#ROSBAG V2.0'");
  Records records;
  while (!reader.at_end()) {
    const std::uint64_t place = reader.place();
    const std::string header = reader.part();
    records.add(place, header, reader.part());
  }
  records.require_whole(reader.place());
}

}  // namespace soft_robot_lab
