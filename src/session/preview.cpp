// SPDX-License-Identifier: BSD-3-Clause
#include "preview.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

bool are_near(const std::vector<Eigen::Vector3d>& a_m, const std::vector<Eigen::Vector3d>& b_m) {
  return !a_m.empty() && std::equal(a_m.begin(), a_m.end(), b_m.begin(), b_m.end(),
                                    [](const auto& a, const auto& b) { return (a - b).norm() < Preview::near_m; });
}

}  // namespace

bool Preview::show(const std::vector<double>& commands, const std::vector<Eigen::Vector3d>& markers_m) {
  shown_.reset();
  if (!are_near(markers_m, robot_m_)) shown_ = Shown{commands, markers_m, {}};
  return shown();
}

void Preview::add_markers(const std::vector<Eigen::Vector3d>& markers_m) {
  robot_m_ = markers_m;
  if (shown_ && are_near(shown_->markers_m, markers_m)) shown_.reset();
}

void Preview::add_drives(double time_s, const std::vector<double>& commands, const std::vector<double>& reached) {
  if (!shown_) return;
  if (commands != shown_->commands || commands != reached) {
    shown_->arrived_s.reset();
  } else if (!shown_->arrived_s || time_s < *shown_->arrived_s) {
    shown_->arrived_s = time_s;
  } else if (time_s > *shown_->arrived_s + settling_s) {
    shown_.reset();
  }
}

}  // namespace soft_robot_lab
