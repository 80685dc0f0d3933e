// SPDX-License-Identifier: BSD-3-Clause
// Poses that a user stores in the panel: names for commands of all actuators. Knows no window.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include <soft_robot_lab/Policy.h>

#include "actuator_values.h"

namespace soft_robot_lab {

class Poses {
 public:
  // Of that scene's robot all below is about, and of poses that name none.
  void set_scene(const std::string& path);

  // What is shown now, under that name or, where that is empty, the next free "pose N"; returns the name.
  std::string store(const std::string& name, const std::vector<ActuatorRow>& rows);
  void remove(const std::string& name);
  std::vector<std::string> names() const;

  // To a pose of those actuators that the robot has, for that robot; throws std::invalid_argument where there is none.
  Policy policy(const std::string& name, const std::vector<ActuatorRow>& rows, double duration_s) const;

  // One line a pose, "name: @=robot actuator=value ...", of all robots, as kept in a file. What cannot be read is left
  // out.
  std::string text() const;
  void read(const std::string& text);

  // Whole files, of the user and not of the package. A file that is not there has none. Throw as read_regular_file and
  // write_file do.
  void read_file(const std::string& file);
  void write_file(const std::string& file) const;

 private:
  using Values = std::map<std::string, double>;
  const Values* find(const std::string& name) const;

  std::string robot_, robot_name_;                               // its file, and what people call it
  std::map<std::pair<std::string, std::string>, Values> poses_;  // by robot and name
};

}  // namespace soft_robot_lab
