// SPDX-License-Identifier: BSD-3-Clause
// Follows a robot by its drives and tracked markers, and says what acts on it from outside whenever it rests. The first
// rest is taken for an untouched one; so is each later one that shows no load, and what the model misses there is taken
// up as offsets of the markers.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "measured_rest.h"
#include "control/estimation/load_estimator.h"

namespace soft_robot_lab {

class LiveTwin {
 public:
  // Keeps a reference to the model, which it moves. Throws as LoadEstimator.
  LiveTwin(Simulation& model, const LoadEstimationOptions& options, const RestCriterion& criterion = {});

  // What drives were asked for and have reached, in the commands' units. Throws std::invalid_argument for names that
  // the model does not have, other counts, and values that the model does not take; nothing changes then.
  void add_drives(double time_s, const std::vector<std::string>& names, const std::vector<double>& commands,
                  const std::vector<double>& reached);

  // A frame of those markers that cameras see, in order of time. An estimate where a window of rest has ended. Throws
  // std::invalid_argument as LoadEstimator::estimate.
  std::optional<LoadEstimate> add_markers(double time_s, const std::vector<MeasuredMarker>& seen);

  // The next window of rest is taken for an untouched one, whatever it shows.
  void expect_untouched() { expect_untouched_ = true; }

  const SimulationState& estimated_state() const { return estimator_.estimated_state(); }

 private:
  struct Frame {
    double time_s;
    std::vector<MeasuredMarker> seen;
  };
  std::vector<MeasuredMarker> means() const;
  std::string follow_drives();  // why the model does not rest there; empty where it does

  Simulation& model_;
  LoadEstimator estimator_;
  RestCriterion criterion_;
  MeasuredRest rest_;
  std::deque<Frame> window_;
  std::vector<double> reached_;            // of the model's actuators
  std::optional<std::vector<double>> at_;  // where the model rests
  bool arrived_ = false, expect_untouched_ = true;
  double judged_s_ = 0.0;  // when the last window ended
};

}  // namespace soft_robot_lab
