#include <fstream>
#include <iterator>
#include <sstream>

#include "soft_robot_lab/experiment/report.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>soft_robot_lab: experiments</title>
<style>
body { font-family: "DejaVu Sans", Arial, sans-serif; max-width: 64em; margin: 2em auto; padding: 0 1em; line-height: 1.45; color: #222; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: 0.25em 0.8em; border-bottom: 1px solid #ddd; text-align: left; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
img { max-width: 100%; border: 1px solid #eee; }
.failed { color: #a00; font-weight: bold; }
</style></head><body>
<h1>Experiments</h1>
)";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return result;
}

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

void write_table(const Table& table, std::ostream& out) {
  out << "<table><tr>";
  for (const TableColumn& column : table.columns) out << "<th>" << escaped(column.name) << "</th>";
  out << "</tr>\n";
  for (const auto& row : table.rows) {
    out << "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      out.precision(table.columns[i].digits);
      if (const auto* text = std::get_if<std::string>(&row[i])) {
        out << "<td>" << escaped(*text) << "</td>";
      } else {
        out << "<td class=\"number\">" << std::get<double>(row[i]) << "</td>";
      }
    }
    out << "</tr>\n";
  }
  out << "</table>\n";
}

void write_picture(const std::string& path, std::ostream& out) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  out << "<p><img alt=\"" << escaped(path) << "\" src=\"data:image/svg+xml;base64," << base64(bytes) << "\"></p>\n";
}

void write_report(const ExperimentReport& report, std::ostream& out) {
  const ExperimentResult& result = report.result;
  out << "<h2 id=\"" << escaped(report.name) << "\">" << escaped(report.name + ": " + result.title) << "</h2>\n";
  if (!result.converged) out << "<p class=\"failed\">Did not converge: " << escaped(result.message) << "</p>\n";
  write_table(result.table, out);
  if (!result.source_reports.empty())
    out << "<p><b>The source reports:</b> " << escaped(result.source_reports) << "</p>\n";
  if (!result.we_find.empty()) out << "<p><b>We find:</b> " << escaped(result.we_find) << "</p>\n";
  for (const PlotFiles& files : report.pictures) write_picture(files.svg, out);
}

}  // namespace

std::string experiments_html(const std::vector<ExperimentReport>& reports) {
  std::ostringstream out;
  out << kHead << "<ul>\n";
  for (const ExperimentReport& report : reports) {
    out << "<li><a href=\"#" << escaped(report.name) << "\">" << escaped(report.name + ": " + report.result.title)
        << "</a></li>\n";
  }
  out << "</ul>\n";
  for (const ExperimentReport& report : reports) write_report(report, out);
  out << "</body></html>\n";
  return out.str();
}

}  // namespace soft_robot_lab
