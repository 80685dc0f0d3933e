// SPDX-License-Identifier: BSD-3-Clause
// Notices that a camera was displaced out of its place while a session runs.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/perception/tracking/camera_observation.h"

namespace soft_robot_lab {

struct ExtrinsicsMonitorSettings {
  double window_s = 4;          // > 0; over which sights are taken together
  double check_period_s = 0.2;  // >= 0; between two looks at the window
  double threshold_m = 0.0025;  // > 0; root mean square by which two cameras' markers may differ
  double confirm_s = 0.5;       // >= 0; for how long they differ before it is reported
  int min_sights = 40;          // >= 6; of markers in a window, by both cameras: six markers at 1.7 Hz

  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

struct CameraWarning {
  std::vector<std::string> cameras;  // one; or two, where nothing shows which of them moved
  double displacement_m = 0;         // of what they see
  std::string difference;            // in words
  std::string message;               // the same of cameras that were calibrated
};

// A small rigid motion of what a camera sees: by turn x (p - about) + shift at p.
struct SmallMotion {
  Eigen::Vector3d about_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  // [rad]
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();

  Eigen::Vector3d at(const Eigen::Vector3d& point_m) const { return turn.cross(point_m - about_m) + shift_m; }
};

// Two cameras differ when one has moved, and never because the robot does something that nobody expected. Which one it
// was is shown by a third camera, or by whose markers went away from where they used to be against what is expected.
class ExtrinsicsMonitor {
 public:
  explicit ExtrinsicsMonitor(const ExtrinsicsMonitorSettings& settings);

  // Sights of one moment by all cameras, in order of time; a clock that goes back makes it start anew. Sights that are
  // not finite are left out.
  void add(double stamp_s, const std::vector<CameraObservation>& sights);
  const std::vector<CameraWarning>& warnings() const { return warnings_; }
  // Of the last look: cameras that saw enough markers together with another one. Nothing is known of the others.
  const std::set<std::string>& watched() const { return watched_; }
  void reset();  // after a calibration

 private:
  struct Difference {
    Eigen::Vector3d position_m, value_m;
    Eigen::Matrix3d weight;
  };
  struct Calm {
    double stamp_s;
    SmallMotion motion;
  };
  using Pair = std::pair<std::string, std::string>;
  struct Dispute {
    double since_s = 0;
    double displacement_m = 0;
  };

  static SmallMotion fit(const std::vector<Difference>& differences);
  static double size_m(const SmallMotion& motion, const std::vector<Difference>& differences);
  std::vector<Difference> between(const Pair& cameras) const;
  std::vector<Difference> against_expected(const std::string& camera) const;
  std::vector<std::string> cameras() const;
  void check();
  bool is_reported(const Pair& cameras) const;
  void remember_calm(const std::string& camera);
  double change_m(const std::string& camera) const;
  std::vector<std::string> culprits(const Pair& cameras) const;
  void warn();

  ExtrinsicsMonitorSettings settings_;
  struct Moment {
    double stamp_s;
    std::vector<CameraObservation> sights;
  };
  std::deque<Moment> window_;
  double checked_s_ = 0;
  std::map<Pair, Dispute> disputes_;
  std::map<std::string, std::deque<Calm>> calm_;  // of cameras that agreed with all others, oldest first
  std::vector<CameraWarning> warnings_;
  std::set<std::string> watched_;
};

}  // namespace soft_robot_lab
