// SPDX-License-Identifier: BSD-3-Clause
#include "tracker_parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

std::string name_of(const TrackerNumber& number) {
  return number.part.empty() ? number.key : number.part + "_" + number.key;
}

double cut(double value, const AllowedRange& range) {
  constexpr double end = std::numeric_limits<double>::infinity();
  return std::clamp(value, range.open_min ? std::nextafter(range.min, end) : range.min,
                    range.open_max ? std::nextafter(range.max, -end) : range.max);
}

void add(const TrackerNumber& number, double value, dynamic_reconfigure::Config& config) {
  dynamic_reconfigure::DoubleParameter parameter;
  parameter.name = name_of(number);
  parameter.value = value;
  config.doubles.push_back(parameter);
}

std::optional<double> value_of(const std::string& name, const dynamic_reconfigure::Config& config) {
  for (const dynamic_reconfigure::DoubleParameter& each : config.doubles)
    if (each.name == name) return each.value;
  return std::nullopt;
}

}  // namespace

dynamic_reconfigure::Config config_message(TrackerSettings settings) {
  dynamic_reconfigure::Config config;
  for (const TrackerNumber& number : numbers_of(settings)) add(number, *number.value, config);
  return config;
}

dynamic_reconfigure::ConfigDescription description_message(TrackerSettings settings) {
  dynamic_reconfigure::ConfigDescription description;
  dynamic_reconfigure::Group group;
  group.name = "Default";
  for (const TrackerNumber& number : numbers_of(settings)) {
    dynamic_reconfigure::ParamDescription parameter;
    parameter.name = name_of(number);
    parameter.type = "double";
    parameter.description = "as in the tracker's file";
    group.parameters.push_back(parameter);
    add(number, cut(number.range.min, number.range), description.min);
    add(number, cut(number.range.max, number.range), description.max);
  }
  description.groups = {group};
  description.dflt = config_message(settings);
  return description;
}

// One after the other, as a later range may depend on an earlier number.
TrackerSettings with_request(TrackerSettings settings, const dynamic_reconfigure::Config& request) {
  for (std::size_t i = 0; i < numbers_of(settings).size(); ++i) {
    const TrackerNumber number = numbers_of(settings)[i];
    const double value = value_of(name_of(number), request).value_or(*number.value);
    *number.value = std::isnan(value) ? *number.value : cut(value, number.range);
  }
  return settings;
}

dynamic_reconfigure::Config changed(const dynamic_reconfigure::Config& before,
                                    const dynamic_reconfigure::Config& after) {
  dynamic_reconfigure::Config changes;
  for (const dynamic_reconfigure::DoubleParameter& each : after.doubles)
    if (value_of(each.name, before) != each.value) changes.doubles.push_back(each);
  return changes;
}

std::string changes_text(const dynamic_reconfigure::Config& before, const dynamic_reconfigure::Config& changed) {
  std::string text;
  for (const dynamic_reconfigure::DoubleParameter& each : changed.doubles) {
    const std::optional<double> old = value_of(each.name, before);
    text += (text.empty() ? "" : ", ") + each.name + (old ? " " + format_number(*old) : "") + " -> " +
            format_number(each.value);
  }
  return text;
}

}  // namespace soft_robot_lab
