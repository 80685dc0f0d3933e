// SPDX-License-Identifier: BSD-3-Clause
#include "html_page.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kStyle = R"(<style>
body { font-family: "DejaVu Sans", Arial, sans-serif; max-width: 64em; margin: 2em auto; padding: 0 1em; line-height: 1.45; color: #222; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: 0.25em 0.8em; border-bottom: 1px solid #ddd; text-align: left; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
img { max-width: 100%; border: 1px solid #eee; }
pre { background: #f6f6f6; padding: 1em; overflow-x: auto; font-size: 85%; }
.failed { color: #a00; font-weight: bold; }
</style>)";

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63u];
  }
  return text;
}

std::string media_type(const std::string& file) {
  const std::string ending = file.substr(std::min(file.size(), file.rfind('.') + 1));
  if (ending == "mp4") return "video/mp4";
  return ending == "svg" ? "image/svg+xml" : ending == "jpg" ? "image/jpeg" : "image/" + ending;
}

// The file itself, as an address.
std::string data_address(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  if (!file || bytes.empty()) throw std::runtime_error(path + ": cannot be read, or is empty");
  return "data:" + media_type(path) + ";base64," + base64(bytes);
}

}  // namespace

HtmlPage::HtmlPage(const std::string& title) {
  body_ << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>soft_robot_lab: "
        << html_escaped(title) << "</title>\n"
        << kStyle << "</head><body>\n<h1>" << html_escaped(title) << "</h1>\n";
}

void HtmlPage::heading(const std::string& text, const std::string& anchor) {
  body_ << "<h2" << (anchor.empty() ? "" : " id=\"" + html_escaped(anchor) + "\"") << ">" << html_escaped(text)
        << "</h2>\n";
}

void HtmlPage::link(const std::string& text, const std::string& anchor) {
  body_ << "<p><a href=\"#" << html_escaped(anchor) << "\">" << html_escaped(text) << "</a></p>\n";
}

void HtmlPage::paragraph(const std::string& text, const std::string& lead) {
  body_ << "<p>" << (lead.empty() ? "" : "<b>" + html_escaped(lead) + "</b> ") << html_escaped(text) << "</p>\n";
}

void HtmlPage::failure(const std::string& text) { body_ << "<p class=\"failed\">" << html_escaped(text) << "</p>\n"; }

void HtmlPage::table(const Table& table) {
  body_ << "<table><tr>";
  for (const TableColumn& column : table.columns) body_ << "<th>" << html_escaped(column.name) << "</th>";
  body_ << "</tr>\n";
  for (const auto& row : table.rows) {
    body_ << "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      body_.precision(table.columns[i].digits);
      if (const auto* text = std::get_if<std::string>(&row[i])) {
        body_ << "<td>" << html_escaped(*text) << "</td>";
      } else {
        body_ << "<td class=\"number\">" << std::get<double>(row[i]) << "</td>";
      }
    }
    body_ << "</tr>\n";
  }
  body_ << "</table>\n";
}

void HtmlPage::pictures(const std::vector<std::string>& files) {
  const std::string width = files.size() > 1 ? " width=\"" + std::to_string(98 / files.size()) + "%\"" : "";
  body_ << "<p>";
  for (const std::string& path : files)
    body_ << "<img" << width << " alt=\"" << html_escaped(path.substr(path.rfind('/') + 1)) << "\" src=\""
          << data_address(path) << "\">\n";
  body_ << "</p>\n";
}

void HtmlPage::film(const std::string& file, const std::string& still) {
  body_ << "<p><video controls loop muted width=\"640\" poster=\"" << data_address(still) << "\" src=\""
        << data_address(file) << "\"></video></p>\n";
}

void HtmlPage::text(const std::string& lines) { body_ << "<pre>" << html_escaped(lines) << "</pre>\n"; }

std::string HtmlPage::html() const { return body_.str() + "</body></html>\n"; }

}  // namespace soft_robot_lab
