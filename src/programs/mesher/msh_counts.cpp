// SPDX-License-Identifier: BSD-3-Clause
// https://gmsh.info/doc/texinfo/gmsh.html, "File formats", versions 1, 2, 4.0 and 4.1.
#include "msh_counts.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "settings/read_file.h"

namespace soft_robot_lab {
namespace {

struct Format {
  double version = 1.0;
  bool binary = false;
};

Format format_of(const std::string& content) {
  Format format;
  if (content.rfind("$MeshFormat", 0) != 0) return format;
  std::istringstream words(content.substr(0, 200));
  std::string section;
  words >> section >> format.version >> format.binary;
  return format;
}

bool counts(const std::string& section) {
  return section == "$Nodes" || section == "$Elements" || section == "$NOD" || section == "$ELM";
}

// Lines that a section of text has after the one that announces them.
std::optional<std::size_t> expected_lines(const std::string& announced, bool nodes, double version) {
  std::istringstream words(announced);
  std::size_t first = 0, second = 0;
  if (!(words >> first)) return std::nullopt;
  if (version < 4.0) return first;
  if (!(words >> second)) return std::nullopt;
  return first + second * (nodes && version > 4.05 ? 2 : 1);  // 4.1: tags and places of nodes have lines of their own
}

// $EndNodes; in version 1 $ENDNOD.
bool ends(const std::string& line) { return line.rfind("$End", 0) == 0 || line.rfind("$END", 0) == 0; }

// Each section that counts stands once, and ends before another begins.
void check_order(const std::string& where, const std::string& line, const std::string& section,
                 std::set<std::string>& seen) {
  if (counts(section) && !ends(line))
    throw std::invalid_argument(where + ": " + line + " begins before " + section + " has ended");
  if (counts(line) && !seen.insert(line).second)
    throw std::invalid_argument(where + ": " + line + " stands in the file twice");
}

void check_text(const std::string& file, const std::string& content, const Format& format) {
  std::istringstream lines(content);
  std::string section, announced;
  std::set<std::string> seen;
  std::size_t number = 0, begin = 0, found = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (line.empty()) continue;
    if (line[0] != '$') {
      if (begin == 0) {
        announced = line;
        begin = number;
      } else {
        ++found;
      }
      continue;
    }
    const std::optional<std::size_t> expected =
        counts(section) ? expected_lines(announced, section[1] == 'N', format.version) : std::nullopt;
    if (expected && *expected != found)
      throw std::invalid_argument(file + ":" + std::to_string(begin) + ": " + section + " announces " +
                                  std::to_string(*expected) + " lines, and has " + std::to_string(found));
    check_order(file + ":" + std::to_string(number), line, section, seen);
    section = line;
    announced.clear();
    begin = found = 0;
  }
  if (counts(section))
    throw std::invalid_argument(file + ":" + std::to_string(number) + ": the file ends before " + section + " does");
}

// Numbers as the file's own machine wrote them.
class Cursor {
 public:
  Cursor(const std::string& content, std::size_t at) : content_(content), at_(at) {}

  template <typename Number>
  Number take() {
    Number value{};
    if (content_.size() - at_ < sizeof value) return skip(sizeof value), value;
    std::memcpy(&value, &content_[at_], sizeof value);
    at_ += sizeof value;
    return value;
  }
  void skip(std::uint64_t bytes) { at_ = bytes > content_.size() - at_ ? content_.size() : at_ + bytes; }
  void skip_all() { at_ = content_.size(); }
  bool ended() const { return at_ >= content_.size(); }
  bool is_at_end_of(const std::string& section) const {
    const std::size_t from = at_ < content_.size() && content_[at_] == '\n' ? at_ + 1 : at_;
    return content_.compare(from, section.size() + 3, "$End" + section.substr(1)) == 0;
  }

 private:
  const std::string& content_;
  std::size_t at_;
};

std::optional<std::uint64_t> nodes_of_type(int type) {
  static const std::map<int, std::uint64_t> nodes = {{1, 2}, {2, 3}, {3, 4},  {4, 4},   {5, 8},   {6, 6}, {7, 5},
                                                     {8, 3}, {9, 6}, {10, 9}, {11, 10}, {12, 27}, {15, 1}};
  const auto found = nodes.find(type);
  return found == nodes.end() ? std::nullopt : std::optional<std::uint64_t>(found->second);
}

// Moves to the end of what a section of version 2 announces, and to that of the file where it holds another number;
// false where it has elements of other types.
bool skip_section_2(Cursor& cursor, const std::string& section, std::uint64_t count) {
  if (section == "$Nodes") return cursor.skip(count * (sizeof(int) + 3 * sizeof(double))), true;
  std::uint64_t done = 0;
  while (done < count && !cursor.ended() && !cursor.is_at_end_of(section)) {
    const int type = cursor.take<int>(), here = cursor.take<int>(), tags = cursor.take<int>();
    const std::optional<std::uint64_t> each = nodes_of_type(type);
    if (!each || here <= 0 || tags < 0) return false;
    cursor.skip(static_cast<std::uint64_t>(here) * sizeof(int) * (1 + static_cast<std::uint64_t>(tags) + *each));
    done += static_cast<std::uint64_t>(here);
  }
  if (done != count) cursor.skip_all();
  return true;
}

// The same of version 4.1.
bool skip_section_4(Cursor& cursor, const std::string& section) {
  const auto blocks = cursor.take<std::uint64_t>(), count = cursor.take<std::uint64_t>();
  cursor.skip(2 * sizeof(std::uint64_t));
  std::uint64_t done = 0;
  for (std::uint64_t block = 0; block < blocks && !cursor.ended() && !cursor.is_at_end_of(section); ++block) {
    const int dimension = cursor.take<int>();
    cursor.skip(sizeof(int));
    const int kind = cursor.take<int>();  // whether nodes have parameters, or the type of elements
    const auto here = cursor.take<std::uint64_t>();
    const std::optional<std::uint64_t> each =
        section == "$Nodes" ? std::optional<std::uint64_t>(3 + static_cast<std::uint64_t>(kind != 0 ? dimension : 0))
                            : nodes_of_type(kind);
    if (!each || here > (std::uint64_t{1} << 40)) return false;
    cursor.skip(here * sizeof(std::uint64_t) * (1 + *each));
    done += here;
  }
  if (done != count) cursor.skip_all();
  return true;
}

void check_binary(const std::string& content, const Format& format) {
  for (const std::string section : {"$Nodes", "$Elements"}) {
    const std::size_t begin = content.find("\n" + section + "\n");
    if (begin == std::string::npos) continue;
    std::size_t at = begin + section.size() + 2;
    std::uint64_t count = 0;
    if (format.version < 4.0) {
      count = std::strtoull(content.c_str() + at, nullptr, 10);
      at = std::min(content.find('\n', at), content.size() - 1) + 1;
    }
    Cursor cursor(content, at);
    const bool known = format.version < 4.0 ? skip_section_2(cursor, section, count) : skip_section_4(cursor, section);
    if (known && !cursor.is_at_end_of(section))
      throw std::invalid_argument(section + " announces another number than follows");
  }
}

}  // namespace

void check_msh_counts(const std::string& file) {
  const std::string content = read_regular_file(file, kLargestMesh_bytes);
  const Format format = format_of(content);
  if (!format.binary) return check_text(file, content, format);
  if (format.version < 4.0 || format.version > 4.05) check_binary(content, format);
}

}  // namespace soft_robot_lab
