// Averages tracked markers over windows of time, and tells when those that are seen have come to rest.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "soft_robot_lab/control/closed_loop.h"
#include "soft_robot_lab/ros/messages.h"

namespace soft_robot_lab {

struct MeasuredRestCriterion {
  double window_s = 0.5;     // averaged over
  int observations = 3;      // at least
  double motion_m = 5.0e-4;  // between the means of two windows: what noise leaves of them is less
};

// Whether no marker of both moved; false where there is none.
bool same_place(const MeasuredMarkers& before, const MeasuredMarkers& now, double motion_m);

class MeasuredRest {
 public:
  explicit MeasuredRest(const MeasuredRestCriterion& criterion = {}) : criterion_(criterion) {}

  // Forgets what it heard; observations before that time do not count.
  void start(double time_s);
  // Those not seen by cameras do not count; false where none was.
  bool add(const MarkerObservations& markers);

  // Means of the last window, where they are those of the window before.
  const std::optional<MeasuredMarkers>& at_rest() const { return at_rest_; }

 private:
  void end_window();

  struct Sum {
    Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
    int count = 0;
  };

  MeasuredRestCriterion criterion_;
  double start_s_ = 0.0, window_start_s_ = 0.0;
  int observations_ = 0;
  std::map<std::string, Sum> sums_;
  MeasuredMarkers before_;  // means of the window before
  std::optional<MeasuredMarkers> at_rest_;
};

}  // namespace soft_robot_lab
