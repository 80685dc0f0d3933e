// SPDX-License-Identifier: BSD-3-Clause
// A plant that runs beside the clock, and may be late: where its steps cost more than the time they cover, it makes
// up for that later, and is pulled the way the shafts went all the same. Without that, a shaft that turns while a step
// is computed would jump, and the jolt would shake off the friction of its cable.
#pragma once

#include <deque>

#include "plant.h"

namespace soft_robot_lab {

class RealTimePlant {
 public:
  RealTimePlant(Plant& plant, double now_s) : plant_(plant), reached_s_(now_s) {}

  // Where the shafts are since `time_s`. What is older than the one before counts as now.
  void add(double time_s, std::vector<std::string> names, std::vector<double> values);

  // Lets plant come nearer to now, by at most `longest_s`; what is later than `latest_s` then is lost, which it
  // reports. A clock that went back by more than that is followed, and stamps that far ahead of it count as now.
  // Throws std::invalid_argument for shafts where they cannot be: those stay where they were, time goes on.
  void advance(double now_s, double longest_s, double latest_s);

  double late_s(double now_s) const { return now_s - reached_s_; }
  double lost_s() const { return lost_s_; }  // since the start

 private:
  struct Shafts {
    double time_s;
    std::vector<std::string> names;
    std::vector<double> values;
  };

  void pass_until(double time_s);
  void follow_clock(double now_s, double latest_s);

  Plant& plant_;
  std::deque<Shafts> ahead_;
  double reached_s_, lost_s_ = 0.0;
};

}  // namespace soft_robot_lab
