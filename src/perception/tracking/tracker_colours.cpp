// SPDX-License-Identifier: BSD-3-Clause
// Other colours in the text of a tracker's settings, with everything around them left as a person wrote it.
#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "colour_tuning.h"

namespace soft_robot_lab {
namespace {

std::size_t indent_of(const std::string& line) { return std::min(line.find_first_not_of(' '), line.size()); }

bool says_nothing(const std::string& line) {
  const std::size_t at = indent_of(line);
  return at == line.size() || line[at] == '#';
}

bool has_key(const std::string& line, const std::string& key) {
  return line.compare(indent_of(line), key.size() + 1, key + ":") == 0;
}

// Whether the key's value begins on the next line.
bool opens_block(const std::string& line, const std::string& key) {
  const std::string rest = line.substr(indent_of(line) + key.size() + 1);
  return says_nothing(rest);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The first line after `start` that belongs to what is around it: indented no more, and not only a comment.
std::size_t end_of_block(const std::vector<std::string>& lines, std::size_t start) {
  std::size_t end = start + 1;
  for (std::size_t i = start + 1; i < lines.size(); ++i) {
    if (says_nothing(lines[i])) continue;
    if (indent_of(lines[i]) <= indent_of(lines[start])) break;
    end = i + 1;
  }
  return end;
}

std::vector<std::string> written(const std::vector<MarkerColour>& colours, const std::string& indent) {
  std::vector<std::string> lines{indent + "colours:"};
  for (const MarkerColour& colour : colours) {
    lines.push_back(indent + "  " + colour.name + ":");
    for (const HsvRange& range : colour.ranges) {
      std::ostringstream line;
      line << indent << "    - {hue_deg: [" << range.hue_min_deg << ", " << range.hue_max_deg << "], saturation: ["
           << range.saturation_min << ", " << range.saturation_max << "], value: [" << range.value_min << ", "
           << range.value_max << "]}";
      lines.push_back(line.str());
    }
  }
  return lines;
}

}  // namespace

std::string with_colours(const std::string& settings, const std::vector<MarkerColour>& colours) {
  std::vector<std::string> lines = lines_of(settings);
  const auto detector =
      std::find_if(lines.begin(), lines.end(), [](const std::string& line) { return line.rfind("detector:", 0) == 0; });
  if (detector == lines.end() || !opens_block(*detector, "detector"))
    throw std::invalid_argument("detector: its keys must stand on lines of their own for colours to be replaced");
  const auto first = static_cast<std::size_t>(detector - lines.begin()) + 1;
  const std::size_t last = end_of_block(lines, first - 1);
  std::size_t at = first;
  while (at < last && says_nothing(lines[at])) ++at;
  const std::string indent(at < last ? indent_of(lines[at]) : 2, ' ');
  while (at < last && !(indent_of(lines[at]) == indent.size() && has_key(lines[at], "colours"))) ++at;
  if (at == last) at = first;
  const std::size_t end = has_key(lines[at], "colours") ? end_of_block(lines, at) : at;
  const std::vector<std::string> fresh = written(colours, indent);
  lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at), lines.begin() + static_cast<std::ptrdiff_t>(end));
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), fresh.begin(), fresh.end());
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  parse_tracker(text, "the tuned settings");
  return text;
}

}  // namespace soft_robot_lab
