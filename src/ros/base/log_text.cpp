// SPDX-License-Identifier: BSD-3-Clause
#include "log_text.h"

#include <algorithm>

namespace soft_robot_lab {

std::string log_text(const std::string& text) {
  constexpr std::size_t kept = 200;  // of its beginning, and of its end, where the reason stands
  std::string shown = text;
  if (text.size() > 2 * kept + 40)
    shown = text.substr(0, kept) + " ... (" + std::to_string(text.size() - 2 * kept) + " characters) ... " +
            text.substr(text.size() - kept);
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 127; };
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  return shown;
}

}  // namespace soft_robot_lab
