// SPDX-License-Identifier: BSD-3-Clause
#include "shell_words.h"

#include <sstream>

#include "settings/find_program.h"

namespace soft_robot_lab {

std::vector<std::string> words_of(const std::string& command) {
  std::istringstream stream(command);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string study_program() { return find_program("study"); }

}  // namespace soft_robot_lab
