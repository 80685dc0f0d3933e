// SPDX-License-Identifier: BSD-3-Clause
#include "csv_cells.h"

#include <string_view>

namespace soft_robot_lab {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

std::string trimmed(const std::string& text) {
  const char* blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) + 1 - first);
}

}  // namespace

std::vector<std::string> csv_cells(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  std::size_t opened = 0;  // in the last cell
  const std::size_t start = line.rfind(kByteOrderMark, 0) == 0 ? kByteOrderMark.size() : 0;
  for (std::size_t i = start; i < line.size(); ++i) {
    const bool doubled = quoted && line.compare(i, 2, "\"\"") == 0;
    if (line[i] == '"' && !doubled) {
      quoted = !quoted;
      opened = cells.back().size();
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
      if (doubled) ++i;
    }
  }
  if (quoted) cells.back().insert(opened, "\"");  // it opens nothing
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

}  // namespace soft_robot_lab
