// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"
#include "hidden_markers.h"
#include "marker_motion.h"
#include "marker_detection.h"
#include "detection_fusion.h"

namespace soft_robot_lab {

// Where all markers are believed to be, through time.
class MarkerEstimator {
 public:
  // `colours`: of each marker, or -1 for any.
  MarkerEstimator(const MotionSettings& settings, const std::vector<Eigen::Vector3d>& rest_positions_m,
                  const std::vector<int>& colours);

  // Simulated positions from now on, in place of the rest shape.
  void set_reference(const std::vector<Eigen::Vector3d>& positions_m) {
    reference_m_ = positions_m;
    simulated_ = true;
  }
  const std::vector<Eigen::Vector3d>& reference_m() const { return reference_m_; }
  // As if no marker had ever been seen.
  void restart();
  // All that is believed. Whoever sets it goes on as whoever had it, to the last digit. Throws std::invalid_argument
  // for what no beliefs about as many markers would hold.
  std::vector<double> state() const;
  void set_state(const std::vector<double>& state);

  // Time goes on, never back. Where all markers are lost, starts again.
  void advance(double to_s);
  double time_s() const { return *time_s_; }
  bool started() const { return time_s_.has_value(); }

  // Of where markers are to be looked for: by their motion and, where there is one, the simulation. After a long gap
  // between frames the motion says next to nothing.
  std::vector<MarkerPrediction> predictions() const;
  const std::vector<std::vector<int>>& neighbours() const { return neighbours_; }

  // What all cameras saw of each marker. Sights that contradict each other, the prediction or what silicone can
  // stretch are left out; markers without any are estimated from their past and their neighbours.
  void correct(const std::vector<std::vector<MarkerDetection>>& sights);

  const MarkerMotion& motion(std::size_t marker) const { return beliefs_[marker].motion; }
  int cameras(std::size_t marker) const { return beliefs_[marker].cameras; }  // that saw it at the last correction
  bool lost(std::size_t marker) const;

 private:
  struct Belief {
    MarkerMotion motion;
    int cameras = 0;
    double last_seen_s = -std::numeric_limits<double>::infinity();
    MarkerShape shape_when_seen;  // of all markers
    MarkerMotion motion_when_seen;
  };

  template <typename Visit>
  void visit_numbers(const Visit& visit);
  void expect_hidden();
  Belief expected_hidden(std::size_t marker, const MarkerShape& now) const;
  void forget_stretched(const std::vector<Belief>& before, const std::vector<double>& surprises);
  MarkerShape shape() const;

  MotionSettings settings_;
  std::vector<Eigen::Vector3d> rest_m_;
  std::vector<int> colours_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<Eigen::Vector3d> reference_m_;  // rest shape or simulation
  bool simulated_ = false;
  std::vector<Belief> beliefs_;
  std::optional<double> time_s_;
};

}  // namespace soft_robot_lab
