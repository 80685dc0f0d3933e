// SPDX-License-Identifier: BSD-3-Clause
// The door for parameters of nodes, as launch files, rosparam and the command line set them.
#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <ros/ros.h>

#include "settings/require_in_range.h"
#include "settings/unit_limits.h"

namespace soft_robot_lab {

inline const char* kind_of(const std::string&) { return "a text (type=\"str\" in a launch file)"; }
inline const char* kind_of(bool) { return "true or false"; }
inline const char* kind_of(int) { return "a whole number"; }
inline const char* kind_of(double) { return "a number"; }
inline const char* kind_of(const std::vector<double>&) { return "a list of numbers"; }
inline const char* kind_of(const std::vector<std::string>&) { return "a list of texts"; }

inline void require_parameter_in_limits(const std::string&, const std::string&) {}
inline void require_parameter_in_limits(const std::string&, const std::vector<std::string>&) {}
inline void require_parameter_in_limits(const std::string&, bool) {}
inline void require_parameter_in_limits(const std::string&, int) {}  // whose range is the node's own
inline void require_parameter_in_limits(const std::string& name, double value) {
  const AllowedRange range = range_of_unit(name);
  if (std::isfinite(range.max)) require_in_range(name, value, range);
}
inline void require_parameter_in_limits(const std::string& name, const std::vector<double>& values) {
  for (const double value : values) require_parameter_in_limits(name, value);
}

// Whether there is such a parameter; `value` stays as it is where there is none. Numbers are within limits.h, by the
// unit that the name ends with; a node's own range is narrower. Throws std::invalid_argument naming the parameter, also
// where it is of another kind.
template <class Value>
bool read_parameter(const ros::NodeHandle& node, const std::string& name, Value& value) {
  if constexpr (std::is_same_v<Value, int>) {  // ROS would round a number, and wrap one that is too large
    double number = 0.0;
    const bool is_number = node.getParam(name, number);
    if (is_number && !(number == std::floor(number) && std::abs(number) <= std::numeric_limits<int>::max()))
      throw std::invalid_argument(name + ": must be " + kind_of(value));
  }
  if (!node.getParam(name, value)) {
    if (!node.hasParam(name)) return false;
    throw std::invalid_argument(name + ": must be " + kind_of(value));
  }
  require_parameter_in_limits(name, value);
  return true;
}

// Empty where there is none.
inline std::string text_parameter(const ros::NodeHandle& node, const std::string& name,
                                  const std::string& otherwise = "") {
  std::string text = otherwise;
  read_parameter(node, name, text);
  return text;
}

// Throws std::invalid_argument where there is none, or an empty one; `meaning` is what to give.
inline std::string required_text(const ros::NodeHandle& node, const std::string& name, const std::string& meaning) {
  std::string text = text_parameter(node, name);
  if (text.empty()) throw std::invalid_argument(name + ": missing; give " + meaning);
  return text;
}

}  // namespace soft_robot_lab
