// SPDX-License-Identifier: BSD-3-Clause
#include "results_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;
using Values = std::vector<std::pair<std::string, Json>>;

constexpr std::size_t kLongestList = 16;

bool is_time_taken(const std::string& key) { return key == "wall_s" || key == "cpu_s" || key == "from_cache"; }

bool all_of(const Json& list, bool (Json::*is)() const) {
  return std::all_of(list.begin(), list.end(), [&](const Json& item) { return (item.*is)(); });
}

void flatten_into(const std::string& name, const Json& node, Values& values);

void flatten_list(const std::string& name, const Json& list, Values& values) {
  static const char* axes[] = {".x", ".y", ".z"};
  const bool numbers = all_of(list, &Json::is_number);
  if ((!numbers && !all_of(list, &Json::is_object)) || list.size() > kLongestList || list.empty())
    return values.emplace_back(name + ".count", list.size()), void();
  for (std::size_t i = 0; i < list.size(); ++i)
    flatten_into(name + (numbers && list.size() == 3 ? axes[i] : "[" + std::to_string(i) + "]"), list[i], values);
}

void flatten_into(const std::string& name, const Json& node, Values& values) {
  if (node.is_array()) return flatten_list(name, node, values);
  if (!node.is_object()) return values.emplace_back(name, node), void();
  for (const auto& [key, value] : node.items())
    if (!is_time_taken(key)) flatten_into((name.empty() ? "" : name + ".") + key, value, values);
}

std::string csv_cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  std::string text = value.get<std::string>();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  for (std::size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2) text.insert(i, 1, '"');
  return '"' + text + '"';
}

bool has_seed(const ResultsTable& table) { return !table.tasks.empty() && table.tasks[0].seed > 0; }

std::string header(const ResultsTable& table) {
  std::string line = "task";
  for (const std::string& name : table.parameters) line += "," + csv_cell(name);
  line += has_seed(table) ? ",seed,state,reason" : ",state,reason";
  for (const std::string& name : table.results) line += "," + csv_cell(name);
  return line + "\n";
}

// A column's numbers, and its name.
std::vector<std::pair<std::string, std::vector<double>>> number_columns(const ResultsTable& table) {
  std::vector<std::pair<std::string, std::vector<double>>> columns;
  for (std::size_t p = 0; p < table.parameters.size(); ++p) {
    columns.emplace_back(table.parameters[p], std::vector<double>());
    for (const StudyTask& task : table.tasks) columns.back().second.push_back(task.values[p]);
  }
  for (std::size_t r = 0; r < table.results.size(); ++r) {
    std::vector<double> numbers = table.numbers(r);
    if (std::any_of(numbers.begin(), numbers.end(), [](double value) { return !std::isnan(value); }))
      columns.emplace_back(table.results[r], std::move(numbers));
  }
  return columns;
}

// As Python writes a text.
std::string python_text(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += (c == '\'' || c == '\\') ? std::string("\\") + c : std::string(1, c);
  return quoted + "'";
}

void append_little_endian(std::string& bytes, const void* value, std::size_t size) {
  bytes.append(static_cast<const char*>(value), size);  // of x86 and ARM
}

}  // namespace

Values flatten(const Json& result) {
  Values values;
  flatten_into("", result, values);
  return values;
}

bool ResultsTable::all_good() const {
  return std::all_of(states.begin(), states.end(), [](const std::string& state) { return state == "good"; });
}

std::vector<double> ResultsTable::numbers(std::size_t result) const {
  std::vector<double> values;
  for (const Json& cell : columns[result])
    values.push_back(cell.is_number()    ? cell.get<double>()
                     : cell.is_boolean() ? static_cast<double>(cell.get<bool>())
                                         : std::numeric_limits<double>::quiet_NaN());
  return values;
}

ResultsTable results_table(const StudySettings& study, const std::vector<StudyTask>& tasks, const Journal& journal) {
  ResultsTable table;
  for (const StudyParameter& parameter : study.parameters) table.parameters.push_back(parameter.name);
  table.tasks = tasks;
  std::map<std::string, std::size_t> places;
  for (std::size_t row = 0; row < tasks.size(); ++row) {
    const std::optional<TaskOutcome> outcome = journal.find(tasks[row].hash);
    table.states.push_back(outcome ? name_of(outcome->state) : "");
    table.reasons.push_back(outcome ? outcome->reason : "");
    if (!outcome || outcome->result.empty()) continue;
    for (auto& [name, value] : flatten(Json::parse(outcome->result))) {
      const auto [place, is_new] = places.emplace(name, table.results.size());
      if (is_new) {
        table.results.push_back(name);
        table.columns.emplace_back(tasks.size());
      }
      table.columns[place->second][row] = std::move(value);
    }
  }
  return table;
}

std::string results_csv(const ResultsTable& table) {
  std::string text = header(table);
  for (std::size_t row = 0; row < table.tasks.size(); ++row) {
    const StudyTask& task = table.tasks[row];
    text += task.hash;
    for (const double value : task.values) text += "," + Json(value).dump();
    if (has_seed(table)) text += "," + std::to_string(task.seed);
    text += "," + table.states[row] + "," + csv_cell(table.reasons[row]);
    for (const auto& column : table.columns) text += "," + csv_cell(column[row]);
    text += "\n";
  }
  return text;
}

// Format version 3.0, whose names are UTF-8 (numpy.lib.format): magic, length of the header, a dictionary, then the
// rows.
std::string results_npy(const ResultsTable& table) {
  const auto columns = number_columns(table);
  std::string head = "{'descr': [";
  for (const auto& column : columns) head += "(" + python_text(column.first) + ", '<f8'), ";
  head += "], 'fortran_order': False, 'shape': (" + std::to_string(table.tasks.size()) + ",), }";
  constexpr std::size_t kAlignment = 64, kBefore = 12;
  head.append(kAlignment - (kBefore + head.size() + 1) % kAlignment, ' ');
  head += "\n";
  std::string bytes("\x93NUMPY\x03\x00", 8);
  const auto length = static_cast<std::uint32_t>(head.size());
  append_little_endian(bytes, &length, sizeof(length));
  bytes += head;
  for (std::size_t row = 0; row < table.tasks.size(); ++row)
    for (const auto& column : columns) append_little_endian(bytes, &column.second[row], sizeof(double));
  return bytes;
}

void write_results(const ResultsTable& table, const std::string& folder) {
  write_file(folder + "/results.csv", results_csv(table));
  write_file(folder + "/results.npy", results_npy(table));
}

}  // namespace soft_robot_lab
