// SPDX-License-Identifier: BSD-3-Clause
#include "read_name.h"

#include <cstdint>

#include "limits.h"

namespace soft_robot_lab {

std::size_t utf8_length(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return at + i < text.size() ? static_cast<std::uint8_t>(text[at + i]) : 0; };
  const std::uint8_t first = byte(0);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xc2 ? 0
                             : first < 0xe0 ? 2
                             : first < 0xf0 ? 3
                             : first < 0xf5 ? 4
                                            : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const bool too_long = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xf0 && byte(1) < 0x90);
  const bool beyond = (first == 0xed && byte(1) > 0x9f) || (first == 0xf4 && byte(1) > 0x8f);
  return too_long || beyond ? 0 : length;
}

std::string read_name(const YamlNode& owner, const std::string& key) {
  const YamlNode node = owner.child(key);
  const std::string name = node.as_text();
  if (name.empty()) node.fail("must not be empty");
  std::size_t characters = 0;
  for (std::size_t at = 0; at < name.size(); ++characters) {
    const std::size_t length = utf8_length(name, at);
    if (length == 0) node.fail("byte " + std::to_string(at + 1) + " of the name is not UTF-8");
    const auto c = static_cast<unsigned char>(name[at]);
    if (c < ' ' || c == 127 || c == '\'' || c == '"' || c == '\\' || c == '`')
      node.fail("character " + std::to_string(characters + 1) +
                " of the name is a quote, a backslash or a control character");
    at += length;
  }
  if (characters > limits::kName_characters)
    node.fail("the name has " + std::to_string(characters) + " characters, must have [1, " +
              std::to_string(limits::kName_characters) + "]");
  return name;
}

}  // namespace soft_robot_lab
