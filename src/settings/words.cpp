// SPDX-License-Identifier: BSD-3-Clause
#include "words.h"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <locale>
#include <sstream>
#include <utility>

namespace soft_robot_lab {
namespace {

// Levenshtein distance.
size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({change, row[j] + 1, row[j - 1] + 1}));
    }
  }
  return row[b.size()];
}

bool is_typo(const std::string& key, const std::string& of) {
  return edit_distance(key, of) <= std::max<size_t>(1, key.size() / 3);
}

}  // namespace

std::string join(const std::vector<std::string>& words) {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : ", ") + word;
  return joined;
}

std::string format_number(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

std::string format_fixed(double value, int decimals) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed << std::setprecision(decimals) << value;
  const std::string shown = text.str();
  const bool is_zero = shown.find_first_not_of("-0.") == std::string::npos;
  return is_zero && shown[0] == '-' ? shown.substr(1) : shown;
}

std::string printable(std::string text) {
  const auto steers = [](unsigned char c) { return (c < ' ' && c != '\n' && c != '\t') || c == 127; };
  std::replace_if(text.begin(), text.end(), steers, '?');
  return text;
}

std::string reason_of(const std::exception& error) {
  if (const auto* of_file = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return printable(of_file->path1().string()) + ": " + of_file->code().message();
  // The reader of JSON names itself and its number for the error first.
  const std::string what = error.what(), library = "[json.exception.";
  const std::size_t start = what.find(library), end = what.find("] ", start);
  if (start == std::string::npos || end == std::string::npos) return printable(what);
  const bool text = what.find("type_error.316", start) == start + library.size();
  return printable(what.substr(0, start) + (text ? "a text is not UTF-8: " : "not the JSON that is expected: ") +
                   what.substr(end + 2));
}

std::string html_escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

std::string unknown_key_message(const std::string& key, std::vector<std::string> known) {
  if (std::find(known.begin(), known.end(), key) != known.end()) return "key '" + key + "' has no use here";
  std::string message = "unknown key '" + key + "'";
  if (known.empty()) return message + "; no keys are known here";
  std::sort(known.begin(), known.end());
  const auto closest = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
    return edit_distance(key, a) < edit_distance(key, b);
  });
  if (is_typo(key, *closest)) message += " (did you mean '" + *closest + "'?)";
  return message + "; known here: " + join(known);
}

std::string missing_key_message(const std::string& key, const std::vector<std::string>& unread) {
  const auto typo = std::find_if(unread.begin(), unread.end(), [&](const auto& other) { return is_typo(other, key); });
  return "key '" + key + "' is missing" + (typo == unread.end() ? "" : " (did you mean it by '" + *typo + "'?)");
}

std::string quote(const std::string& text) {
  static const char* digits = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

}  // namespace soft_robot_lab
