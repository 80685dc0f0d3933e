// SPDX-License-Identifier: BSD-3-Clause
// The door for messages, requests and goals: each of their numbers is finite and within limits.h.
#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <ros/duration.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <ros/time.h>

#include "settings/limits.h"
#include "settings/unit_limits.h"

namespace soft_robot_lab {

// Of the first message in a definition, in its order; constants are none.
inline std::vector<std::string> field_names(const std::string& definition) {
  std::vector<std::string> names;
  std::istringstream lines(definition.substr(0, definition.find("\n====")));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string type, name;
    if (words >> type >> name && line.substr(0, line.find('#')).find('=') == std::string::npos) names.push_back(name);
  }
  return names;
}

template <class Field>
void require_field_in_limits(const Field& field, const std::string& path);

// What ROS hands each field of a message to, in order.
class FieldLimits {
 public:
  FieldLimits(const std::vector<std::string>& names, std::string path) : names_(names), path_(std::move(path)) {}
  template <class Field>
  void next(const Field& field) {
    require_field_in_limits(field, path_ + names_.at(index_++));
  }

 private:
  const std::vector<std::string>& names_;
  std::string path_;
  std::size_t index_ = 0;
};

template <class Field>
void require_field_in_limits(const Field& field, const std::string& path) {
  if constexpr (std::is_floating_point_v<Field>) {
    if (!(std::abs(field) <= limits::kPlace_m)) require_in_unit(path, static_cast<double>(field));  // the least of them
  } else if constexpr (ros::message_traits::IsMessage<Field>::value) {
    static const std::vector<std::string> names = field_names(ros::message_traits::Definition<Field>::value());
    FieldLimits fields(names, path.empty() ? path : path + ".");
    ros::serialization::Serializer<Field>::template allInOne<FieldLimits, const Field&>(fields, field);
  } else if constexpr (std::is_same_v<Field, std::string>) {
    if (field.find('\0') != std::string::npos)  // what a message of an error repeats would end there
      throw std::invalid_argument(path + ": holds a byte of value 0, as no text does");
  } else if constexpr (!std::is_arithmetic_v<Field> && !std::is_same_v<Field, ros::Time> &&
                       !std::is_same_v<Field, ros::Duration>) {
    for (const auto& item : field) require_field_in_limits(item, path);
  }
}

// Throws std::invalid_argument: "poses.duration_s: 1e+300 is not in [-1000000, 1000000]". By the unit that a field's
// name ends with.
template <class Message>
void require_in_limits(const Message& message) {
  require_field_in_limits(message, "");
}

// A file that a request names: the nodes run in a folder of their own, where nobody looks for it. Throws as above.
inline void require_whole_path(const std::string& field, const std::string& path) {
  if (path.empty() || path.front() != '/')
    throw std::invalid_argument(field + ": '" + path + "' is no whole path; it must begin with /");
}

template <class Message>
bool is_in_limits(const Message& message) {
  try {
    require_in_limits(message);
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

}  // namespace soft_robot_lab
