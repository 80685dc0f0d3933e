// SPDX-License-Identifier: BSD-3-Clause
#include "log_text.h"

#include <algorithm>

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

// `kept` characters of its beginning, and of its end, where the reason stands.
std::string cut_in_the_middle(const std::string& text, std::size_t kept) {
  if (text.size() <= 2 * kept + 40) return text;
  return text.substr(0, kept) + " ... (" + std::to_string(text.size() - 2 * kept) + " characters) ... " +
         text.substr(text.size() - kept);
}

}  // namespace

std::string log_text(const std::string& text) {
  std::string shown = cut_in_the_middle(text, 200);
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 127; };
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  return shown;
}

std::string answer_text(const std::exception& error) { return cut_in_the_middle(reason_of(error), 2000); }

}  // namespace soft_robot_lab
