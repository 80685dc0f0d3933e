// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// A name goes into messages, results and pictures: 1 to 100 characters in UTF-8, no quotes, backslashes or control
// characters. Throws SettingsError.
std::string read_name(const YamlNode& owner, const std::string& key = "name");

// How many bytes the character takes that begins here; 0: none does. RFC 3629: the shortest form only, no surrogates.
std::size_t utf8_length(const std::string& text, std::size_t at);

}  // namespace soft_robot_lab
