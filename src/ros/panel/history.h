// SPDX-License-Identifier: BSD-3-Clause
// What the panel's plot shows: the last seconds of a session. Knows no window.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <soft_robot_lab/ActuatorState.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/RealityGap.h>

namespace soft_robot_lab {

class History {
 public:
  using Points = std::deque<std::pair<double, double>>;  // session's time [s], value
  using Curves = std::map<std::string, Points>;          // by name

  // Of the marker, how far it moved along each axis since the first that was heard of it [mm].
  void add(const MarkerObservations& markers, const std::string& marker);
  void add(const ActuatorState& actuators);  // tensions [N], gauge pressures [kPa]
  void add(const RealityGap& gap);           // rms [mm]

  // From the least to the greatest value, and wide enough that noise looks like noise: a millimetre, 0.1 N, 0.1 kPa.
  std::pair<double, double> range(const std::string& title) const;

  // What there is something to show of: "tip [mm]", "tension [N]", ...
  std::vector<std::string> titles() const;
  const Curves& curves(const std::string& title) const;  // none for an unknown title
  double now_s() const { return now_s_; }

  static constexpr double kept_s = 20.0, period_s = 0.05;

 private:
  // A clock that went back begins anew.
  void put(const std::string& title, const std::string& name, double time_s, double value);

  std::map<std::string, Curves> curves_;
  std::string marker_;
  std::vector<double> start_m_;
  double now_s_ = 0.0;
};

}  // namespace soft_robot_lab
