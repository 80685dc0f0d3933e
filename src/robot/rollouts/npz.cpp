// SPDX-License-Identifier: BSD-3-Clause
#include "npz.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include <boost/crc.hpp>

#include "settings/limits.h"
#include "settings/read_name.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

// Signatures of a file, of its row in the directory, and of the directory's end.
constexpr std::uint32_t kFile = 0x04034b50, kRow = 0x02014b50, kEnd = 0x06054b50;
constexpr std::size_t kFileHeader = 30, kRowHeader = 46, kEndHeader = 22;
constexpr std::uint64_t kNameIsUtf8 = 1 << 11;
constexpr std::size_t kLargest_bytes = limits::kArchive_bytes, kNone = static_cast<std::size_t>(-1);
const std::string kMagic = "\x93NUMPY";

void expect(bool good, const std::string& why) {
  if (!good) throw std::invalid_argument("npz: " + why);
}

// Least byte first, as both formats have it.
void put(std::uint64_t value, int bytes, std::string& to) {
  for (int i = 0; i < bytes; ++i) to += static_cast<char>(value >> (8 * i) & 0xff);
}

std::uint64_t get(const std::string& from, std::size_t at, int bytes) {
  expect(at + static_cast<std::size_t>(bytes) <= from.size(), "the file is cut off");
  std::uint64_t value = 0;
  for (int i = bytes; i-- > 0;) value = value << 8 | static_cast<unsigned char>(from[at + static_cast<std::size_t>(i)]);
  return value;
}

std::string part(const std::string& from, std::size_t at, std::size_t size) {
  expect(at <= from.size() && size <= from.size() - at, "the file is cut off");
  return from.substr(at, size);
}

std::string npy(const NpzArray& array) {
  std::string shape;
  for (const std::size_t size : array.shape) shape += std::to_string(size) + ", ";
  std::string header = "{'descr': '" + array.type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  constexpr std::size_t alignment = 64, before = 10;
  header.resize(header.size() + alignment - (before + header.size() + 1) % alignment, ' ');
  header += '\n';
  std::string all = kMagic;
  put(1, 2, all);  // version 1.0
  put(header.size(), 2, all);
  return all + header + array.bytes;
}

std::uint32_t checksum(const std::string& content) {
  boost::crc_32_type crc;
  crc.process_bytes(content.data(), content.size());
  return crc.checksum();
}

// The characters of UTF-8, as NumPy stores them; a byte that is none is one of its own.
std::vector<std::uint32_t> characters_of(const std::string& text) {
  std::vector<std::uint32_t> characters;
  for (std::size_t at = 0; at < text.size();) {
    const auto first = static_cast<unsigned char>(text[at]);
    const std::size_t length = std::max<std::size_t>(1, utf8_length(text, at));
    std::uint32_t character = length == 1 ? first : first & (0xffU >> (length + 1));
    for (std::size_t i = 1; i < length; ++i)
      character = character << 6 | (static_cast<unsigned char>(text[at + i]) & 0x3fU);
    characters.push_back(character);
    at += length;
  }
  return characters;
}

bool is_ascii(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

// What a file's header and its row share, from the version needed to the length of the extra field.
std::string shared_header(const std::string& name, const std::string& content) {
  std::string header;
  put(20, 2, header);                                // version 2.0
  put(is_ascii(name) ? 0 : kNameIsUtf8, 2, header);  // flags
  put(0, 2, header);                                 // stored
  put(0x00210000, 4, header);                        // 1980-01-01, so that equal data are equal files
  put(checksum(content), 4, header);
  put(content.size(), 4, header);
  put(content.size(), 4, header);
  put(name.size(), 2, header);
  put(0, 2, header);
  return header;
}

struct Directory {
  std::size_t rows, start;
};

Directory directory_of(const std::string& bytes) {
  expect(bytes.size() >= kEndHeader, "not an archive of numpy.savez");
  for (std::size_t at = bytes.size() - kEndHeader;; --at) {
    if (get(bytes, at, 4) == kEnd) return {get(bytes, at + 10, 2), get(bytes, at + 16, 4)};
    expect(at > 0 && bytes.size() - at < 0xffff + kEndHeader, "not an archive of numpy.savez");
  }
}

// What stands after 'key': in the header of an array, up to one of `ends`.
std::string value_of(const std::string& header, const std::string& key, const char* ends) {
  const std::size_t at = header.find("'" + key + "':");
  expect(at != std::string::npos, "an array's header has no " + key);
  expect(header.find("'" + key + "':", at + 1) == std::string::npos, "an array's header has " + key + " twice");
  const std::size_t from = header.find_first_not_of(' ', at + key.size() + 3);
  const std::size_t to = from == std::string::npos ? from : header.find_first_of(ends, from + 1);
  expect(to != std::string::npos, "an array's header has no end of " + key);
  return header.substr(from, to - from);
}

std::vector<std::size_t> shape_of(const std::string& words) {
  std::vector<std::size_t> shape;
  for (std::size_t at = 1; at < words.size();) {
    const std::size_t end = std::min(words.find(',', at), words.size());
    std::string number = words.substr(at, end - at);
    number.erase(std::remove(number.begin(), number.end(), ' '), number.end());
    if (!number.empty()) shape.push_back(parse_number<std::size_t>(number).value_or(kNone));
    expect(number.empty() || shape.back() != kNone, "an array's shape " + words + ") is none");
    at = end + 1;
  }
  return shape;
}

std::size_t entry_bytes(const std::string& type) {
  const std::size_t size = type.size() > 2 ? parse_number<std::size_t>(type.substr(2)).value_or(0) : 0;
  expect(size > 0 && size < 0xffff, "an array's type " + type + " is not known");
  return type[1] == 'U' ? 4 * size : size;
}

NpzArray array_from(const std::string& name, const std::string& bytes) {
  expect(bytes.compare(0, kMagic.size(), kMagic) == 0, name + " is no array");
  const std::uint64_t version = get(bytes, 6, 1);
  expect(version >= 1 && version <= 3,
         name + " is of version " + std::to_string(version) + " of NumPy's format, must be 1, 2 or 3");
  const bool first = version == 1;
  const std::size_t start = first ? 10 : 12, length = get(bytes, 8, first ? 2 : 4);
  const std::string header = part(bytes, start, length);
  expect(value_of(header, "fortran_order", ",}") == "False", name + " is in Fortran's order; save a.copy(order='C')");
  NpzArray array{name, value_of(header, "descr", "'").substr(1), shape_of(value_of(header, "shape", ")")), {}};
  std::size_t size = entry_bytes(array.type);
  for (const std::size_t along : array.shape) {
    expect(along == 0 || size <= kLargest_bytes / along, name + " is beyond 4 GB");
    size *= along;
  }
  array.bytes = part(bytes, start + length, size);
  expect(start + length + size == bytes.size(), name + " holds more numbers than its shape says");
  return array;
}

template <class Number>
std::vector<double> numbers_as(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(Number));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Number number;
    std::memcpy(&number, bytes.data() + i * sizeof number, sizeof number);
    numbers[i] = static_cast<double>(number);
  }
  return numbers;
}

}  // namespace

NpzArray numbers_array(std::string name, std::vector<std::size_t> shape, const std::vector<double>& numbers) {
  return {std::move(name), "<f8", std::move(shape),
          std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double))};
}

NpzArray flags_array(std::string name, const std::vector<bool>& flags) {
  return {std::move(name), "|b1", {flags.size()}, std::string(flags.begin(), flags.end())};
}

NpzArray words_array(std::string name, const std::vector<std::string>& words) {
  std::size_t longest = 1;
  for (const std::string& word : words) longest = std::max(longest, characters_of(word).size());
  NpzArray array{std::move(name), "<U" + std::to_string(longest), {words.size()}, {}};
  for (const std::string& word : words) {
    std::vector<std::uint32_t> characters = characters_of(word);
    characters.resize(longest, 0);
    for (const std::uint32_t character : characters) put(character, 4, array.bytes);
  }
  return array;
}

std::string npz(const std::vector<NpzArray>& arrays) {
  std::string all, directory;
  for (const NpzArray& array : arrays) {
    const std::string content = npy(array), name = array.name + ".npy", header = shared_header(name, content);
    expect(all.size() + content.size() + 0xffff < kLargest_bytes, "the arrays are beyond 4 GB; record fewer times");
    put(kRow, 4, directory);
    put(20, 2, directory);  // made by version 2.0
    directory += header;
    put(0, 4, directory);  // no comment, first disk
    put(0, 6, directory);  // no attributes
    put(all.size(), 4, directory);
    directory += name;
    put(kFile, 4, all);
    all += header + name + content;
  }
  const std::size_t start = all.size();
  all += directory;
  put(kEnd, 4, all);
  put(0, 4, all);  // of one disk
  put(arrays.size(), 2, all);
  put(arrays.size(), 2, all);
  put(directory.size(), 4, all);
  put(start, 4, all);
  put(0, 2, all);
  return all;
}

namespace {

// A row of the directory, and where the bytes of its file lie.
struct Row {
  std::string name;
  std::size_t start, content, size, next;  // of the file's header, of its content; of the next row
  std::uint32_t checksum;
};

Row row_at(const std::string& bytes, std::size_t at) {
  expect(get(bytes, at, 4) == kRow, "its directory is broken");
  const std::size_t name_size = get(bytes, at + 28, 2), start = get(bytes, at + 42, 4);
  Row row{part(bytes, at + kRowHeader, name_size), start, 0, get(bytes, at + 24, 4), 0, 0};
  row.checksum = static_cast<std::uint32_t>(get(bytes, at + 16, 4));
  row.next = at + kRowHeader + name_size + get(bytes, at + 30, 2) + get(bytes, at + 32, 2);
  expect(get(bytes, at + 8, 1) % 2 == 0, row.name + " is encrypted");
  expect(get(bytes, at + 10, 2) == 0, row.name + " is compressed; write it by numpy.savez");
  expect(get(bytes, start, 4) == kFile, "its directory is broken");
  row.content = start + kFileHeader + get(bytes, start + 26, 2) + get(bytes, start + 28, 2);
  expect(part(bytes, start + kFileHeader, get(bytes, start + 26, 2)) == row.name,
         row.name + " has another name where its numbers stand");
  return row;
}

// Each byte belongs to one array, so that arrays hold no more than the file.
void require_apart(const std::vector<Row>& rows, std::size_t directory) {
  std::map<std::size_t, const Row*> by_start;
  for (const Row& row : rows)
    expect(by_start.emplace(row.start, &row).second, row.name + " stands where another array does");
  std::size_t end = 0;
  for (const auto& [start, row] : by_start) {
    expect(start >= end, row->name + " begins within another array");
    end = row->content + row->size;
    expect(row->size <= directory && end <= directory, row->name + " is cut off by the directory");
  }
}

std::string without_ending(std::string name) {
  if (name.size() > 4 && name.substr(name.size() - 4) == ".npy") name.resize(name.size() - 4);
  return name;
}

std::vector<Row> rows_of(const std::string& bytes) {
  const Directory directory = directory_of(bytes);
  std::vector<Row> rows;
  std::set<std::string> names;
  std::size_t at = directory.start;
  for (std::size_t i = 0; i < directory.rows; ++i) {
    rows.push_back(row_at(bytes, at));
    expect(names.insert(without_ending(rows.back().name)).second, rows.back().name + " stands twice in the directory");
    at = rows.back().next;
  }
  expect(get(bytes, at, 4) == kEnd, "its directory has another number of arrays than it says");
  require_apart(rows, directory.start);
  return rows;
}

}  // namespace

std::vector<NpzArray> read_npz(const std::string& bytes) {
  std::vector<NpzArray> arrays;
  for (const Row& row : rows_of(bytes)) {
    const std::string content = part(bytes, row.content, row.size);
    arrays.push_back(array_from(without_ending(row.name), content));
    expect(checksum(content) == row.checksum, arrays.back().name + " is damaged: its checksum is another");
  }
  return arrays;
}

std::vector<double> numbers_of(const NpzArray& array) {
  if (array.type == "<f8") return numbers_as<double>(array.bytes);
  if (array.type == "<f4") return numbers_as<float>(array.bytes);
  if (array.type == "<i8") return numbers_as<std::int64_t>(array.bytes);
  if (array.type == "<i4") return numbers_as<std::int32_t>(array.bytes);
  throw std::invalid_argument("npz: " + array.name + " is of type " + array.type + ", must be <f8, <f4, <i8 or <i4");
}

}  // namespace soft_robot_lab
