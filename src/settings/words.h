// SPDX-License-Identifier: BSD-3-Clause
// Words and numbers of settings, and of what is said about wrong ones.
#pragma once

#include <charconv>
#include <exception>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace soft_robot_lab {

std::string join(const std::vector<std::string>& words);  // with commas
std::string format_number(double value);
std::string format_fixed(double value, int decimals);  // never as -0.0; a decimal point in every locale
std::string quote(const std::string& text);            // as YAML
// For messages that repeat what stands in a file: `?` for what would steer a terminal, or end a text of C.
std::string printable(std::string text);
// What an exception says, printable, and in our words where a library threw it.
std::string reason_of(const std::exception& error);
std::string html_escaped(const std::string& text);  // for the text and attributes of a page
std::string unknown_key_message(const std::string& key, std::vector<std::string> known);
std::string missing_key_message(const std::string& key, const std::vector<std::string>& unread);

// A decimal number and nothing else, whatever the locale.
template <typename Number>
std::optional<Number> parse_number(const std::string& text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + (plus ? 1 : 0), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace soft_robot_lab
