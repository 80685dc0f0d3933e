// SPDX-License-Identifier: BSD-3-Clause
#include "bag_index.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

namespace soft_robot_lab {
namespace {

using Fields = std::map<std::string, std::string>;

constexpr char kChunk = 5, kIndex = 4, kChunkInfo = 6;  // the records' field `op`
constexpr char kVersion[] = "#ROSBAG V2.0\n";
constexpr std::size_t kIndexEntry_bytes = 12;  // time and place

[[noreturn]] void refuse(const std::string& reason) {
  throw std::runtime_error("its index is damaged (" + reason + "); 'rosbag reindex' may mend it");
}

template <typename Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number = 0;
  if (at + sizeof number > bytes.size()) refuse("a number is cut off");
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

// A length and as many bytes behind it, which begin at `at`.
std::string part_at(const std::string& bytes, std::size_t at) {
  const auto length = number_at<std::uint32_t>(bytes, at);
  if (length > bytes.size() - at - 4) refuse("a record is longer than what holds it");
  return bytes.substr(at + 4, length);
}

Fields fields_of(const std::string& header) {
  Fields fields;
  for (std::size_t at = 0; at < header.size();) {
    const std::string field = part_at(header, at);
    const std::size_t equals = field.find('=');
    if (equals == std::string::npos) refuse("a field without a value");
    fields[field.substr(0, equals)] = field.substr(equals + 1);
    at += 4 + field.size();
  }
  return fields;
}

class BagReader {
 public:
  explicit BagReader(const std::string& path) : file_(path, std::ios::binary) {
    file_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(file_.tellg());
    file_.seekg(0);
  }

  bool is_bag() {
    std::string line(sizeof kVersion - 1, '\0');
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

struct Chunk {
  std::uint64_t size = 0;           // unpacked
  std::optional<std::string> data;  // where it is not compressed
};

Chunk chunk_of(const Fields& fields, std::string data) {
  const auto compression = fields.find("compression"), size = fields.find("size");
  if (compression == fields.end() || size == fields.end()) refuse("a chunk without compression or size");
  if (compression->second != "none") return {number_at<std::uint32_t>(size->second, 0), std::nullopt};
  if (number_at<std::uint32_t>(size->second, 0) != data.size()) refuse("a chunk of another size than it says");
  return {data.size(), std::move(data)};
}

void require_entries(const std::string& index, const Chunk& chunk) {
  for (std::size_t at = 0; at + kIndexEntry_bytes <= index.size(); at += kIndexEntry_bytes) {
    const std::size_t place = number_at<std::uint32_t>(index, at + 8);
    if (place >= chunk.size) refuse("it points beyond a chunk");
    if (!chunk.data) continue;
    const std::size_t header = part_at(*chunk.data, place).size();
    part_at(*chunk.data, place + 4 + header);
  }
}

void require_index(const Fields& fields, const std::string& index, const Chunk& chunk) {
  const auto count = fields.find("count");
  if (count == fields.end() || number_at<std::uint32_t>(count->second, 0) != index.size() / kIndexEntry_bytes)
    refuse("it announces other entries than it has");
  require_entries(index, chunk);
}

}  // namespace

void require_sound_index(const std::string& bag) {
  BagReader reader(bag);
  if (!reader.is_bag()) return;  // rosbag says what it is
  std::set<std::uint64_t> chunks;
  Chunk chunk;
  while (!reader.at_end()) {
    const std::uint64_t place = reader.place();
    const Fields fields = fields_of(reader.part());
    std::string data = reader.part();
    const auto op = fields.find("op");
    if (op == fields.end() || op->second.size() != 1) refuse("a record of no kind");
    if (op->second[0] == kChunk) {
      chunks.insert(place);
      chunk = chunk_of(fields, std::move(data));
    } else if (op->second[0] == kIndex) {
      require_index(fields, data, chunk);
    } else if (op->second[0] == kChunkInfo) {
      const auto position = fields.find("chunk_pos");
      if (position == fields.end() || chunks.count(number_at<std::uint64_t>(position->second, 0)) == 0)
        refuse("it names a chunk where none is");
    }
  }
}

}  // namespace soft_robot_lab
