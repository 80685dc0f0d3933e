// SPDX-License-Identifier: BSD-3-Clause
// Until when the shape that commands lead to is worth showing: until the robot has it, or rests elsewhere.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

class Preview {
 public:
  // Of these commands; where its markers will be. False, and nothing is shown, where the robot is there already.
  bool show(const std::vector<double>& commands, const std::vector<Eigen::Vector3d>& markers_m);
  void hide() { shown_.reset(); }
  bool shown() const { return shown_.has_value(); }

  // Where the robot's markers are; as many, in the same order.
  void add_markers(const std::vector<Eigen::Vector3d>& markers_m);
  // What its drives are asked for and have reached; the session's time [s].
  void add_drives(double time_s, const std::vector<double>& commands, const std::vector<double>& reached);

  static constexpr double near_m = 5.0e-4;   // within which two skins look the same
  static constexpr double settling_s = 2.0;  // after the drives have arrived: the silicone takes less

 private:
  struct Shown {
    std::vector<double> commands;
    std::vector<Eigen::Vector3d> markers_m;
    std::optional<double> arrived_s;
  };
  std::optional<Shown> shown_;
  std::vector<Eigen::Vector3d> robot_m_;
};

}  // namespace soft_robot_lab
