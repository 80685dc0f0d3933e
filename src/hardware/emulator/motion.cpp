// SPDX-License-Identifier: BSD-3-Clause
#include "motion.h"

#include <cmath>

namespace soft_robot_lab {

Motion Motion::between(double start_s, double from, double to, double speed, double acceleration, double deceleration) {
  const double distance = std::abs(to - from);
  const double sign = to < from ? -1.0 : 1.0;
  if (distance == 0.0) return Motion({{start_s, to, 0.0, 0.0}});
  // Short ways turn from speeding up to slowing down before they are fast: v^2/(2a) + v^2/(2d) = distance.
  const double reachable = std::sqrt(2.0 * distance * acceleration * deceleration / (acceleration + deceleration));
  const double top = std::min(speed, reachable);
  const double speeding_up_s = top / acceleration;
  const double slowing_down_s = top / deceleration;
  const double cruising_s = std::max(0.0, distance / top - 0.5 * (speeding_up_s + slowing_down_s));
  const double cruise_at = 0.5 * top * speeding_up_s;
  const double brake_at = cruise_at + top * cruising_s;
  return Motion({{start_s, from, 0.0, sign * acceleration},
                 {start_s + speeding_up_s, from + sign * cruise_at, sign * top, 0.0},
                 {start_s + speeding_up_s + cruising_s, from + sign * brake_at, sign * top, -sign * deceleration},
                 {start_s + speeding_up_s + cruising_s + slowing_down_s, to, 0.0, 0.0}});
}

Motion Motion::braked(double now_s, double deceleration) const {
  if (done(now_s)) return *this;
  const double from = position(now_s);
  const double now_speed = speed(now_s);
  const double sign = now_speed < 0.0 ? -1.0 : 1.0;
  const double braking_s = std::abs(now_speed) / deceleration;
  // A chip comes to rest on a microstep.
  const double rest = std::round(from + 0.5 * now_speed * braking_s);
  return Motion({{now_s, from, now_speed, -sign * deceleration}, {now_s + braking_s, rest, 0.0, 0.0}});
}

const Motion::Piece& Motion::piece_at(double time_s) const {
  std::size_t i = pieces_.size() - 1;
  while (i > 0 && pieces_[i].start_s > time_s) --i;
  return pieces_[i];
}

double Motion::position(double time_s) const {
  const Piece& piece = piece_at(time_s);
  const double t = std::max(0.0, time_s - piece.start_s);
  return piece.position + piece.speed * t + 0.5 * piece.acceleration * t * t;
}

double Motion::speed(double time_s) const {
  const Piece& piece = piece_at(time_s);
  return piece.speed + piece.acceleration * std::max(0.0, time_s - piece.start_s);
}

}  // namespace soft_robot_lab
