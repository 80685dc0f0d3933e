// SPDX-License-Identifier: BSD-3-Clause
#include "report.h"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <locale>
#include <ostream>
#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

void check(const Table& table) {
  for (const auto& row : table.rows) {
    if (row.size() == table.columns.size()) continue;
    throw std::invalid_argument("table: a row has " + std::to_string(row.size()) + " cells for " +
                                std::to_string(table.columns.size()) + " columns");
  }
}

std::string text_of(const TableCell& cell, int digits) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(digits) << std::get<double>(cell);
  return text.str();
}

// On the terminal, where a column's width counts characters, not the bytes of UTF-8.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

std::string padded(const std::string& text, std::size_t width, bool to_the_right) {
  const std::string spaces(width - std::min(width, width_of(text)), ' ');
  return to_the_right ? spaces + text : text + spaces;
}

Json table_json(const Table& table) {
  check(table);
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json json = Json::object();
    for (std::size_t i = 0; i < row.size(); ++i) {
      std::visit([&](const auto& value) { json[table.columns[i].name] = value; }, row[i]);
    }
    rows.push_back(std::move(json));
  }
  return rows;
}

Json report_json(const ExperimentReport& report) {
  const ExperimentResult& result = report.result;
  Json json = {{"title", result.title},
               {"converged", result.converged},
               {"message", result.message},
               {"source_reports", source_column(result)},
               {"we_differ", result.we_differ},
               {"we_find", result.we_find},
               {"table", table_json(result.table)}};
  if (!result.numbers.is_null()) json.update(result.numbers);
  json["pictures"] = Json::array();
  for (const PlotFiles& files : report.pictures) json["pictures"].push_back(files.svg);
  return json;
}

}  // namespace

std::string source_column(const ExperimentResult& result) {
  return result.source_reports.empty() ? "The source has no such experiment." : result.source_reports;
}

void print_table(const Table& table, std::ostream& out) {
  check(table);
  std::vector<std::size_t> widths;
  for (const TableColumn& column : table.columns) widths.push_back(width_of(column.name));
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      widths[i] = std::max(widths[i], width_of(text_of(row[i], table.columns[i].digits)));
  }
  // A column of numbers stands on the right, and its name with it.
  const auto numeric = [&](std::size_t i) {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [&](const auto& row) { return std::holds_alternative<double>(row[i]); });
  };
  const auto print = [&](std::size_t i, const std::string& text) {
    out << (i ? "  " : "") << padded(text, widths[i], numeric(i)) << (i + 1 == widths.size() ? "\n" : "");
  };
  for (std::size_t i = 0; i < widths.size(); ++i) print(i, table.columns[i].name);
  for (std::size_t i = 0; i < widths.size(); ++i) print(i, std::string(widths[i], '-'));
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) print(i, text_of(row[i], table.columns[i].digits));
  }
}

void print_report(const ExperimentReport& report, std::ostream& out) {
  const ExperimentResult& result = report.result;
  out << report.name << ": " << result.title << "\n\n";
  print_table(result.table, out);
  out << "\nThe source reports: " << source_column(result) << "\n";
  if (!result.we_differ.empty()) out << "\nOur set-up differs: " << result.we_differ << "\n";
  if (!result.we_find.empty()) out << "\nWe find: " << result.we_find << "\n";
  out << "\n";
  for (const PlotFiles& files : report.pictures) {
    out << files.svg << " (.png, .csv)\n";
  }
  if (!result.converged) out << "did not converge: " << result.message << "\n";
}

std::string experiments_json(const std::vector<ExperimentReport>& reports) {
  Json json;
  if (reports.size() == 1) {
    json = report_json(reports[0]);
  } else {
    for (const ExperimentReport& report : reports) json[report.name] = report_json(report);
  }
  return json.dump(2) + "\n";
}

}  // namespace soft_robot_lab
