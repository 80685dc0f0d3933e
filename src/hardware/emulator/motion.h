// SPDX-License-Identifier: BSD-3-Clause
// A motion of constant accelerations, piece after piece: where it is at any time, without stepping through it.
#pragma once

#include <vector>

namespace soft_robot_lab {

// Positions in microsteps, times in seconds.
class Motion {
 public:
  explicit Motion(double position = 0.0) : pieces_{{0.0, position, 0.0, 0.0}} {}

  // From rest at one place to rest at another, no faster than speed.
  static Motion between(double start_s, double from, double to, double speed, double acceleration, double deceleration);
  Motion braked(double now_s, double deceleration) const;  // from now on it only slows down

  double position(double time_s) const;
  double speed(double time_s) const;  // with sign
  bool done(double time_s) const { return time_s >= pieces_.back().start_s; }

 private:
  struct Piece {
    double start_s;
    double position;
    double speed;
    double acceleration;
  };
  explicit Motion(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {}
  const Piece& piece_at(double time_s) const;

  std::vector<Piece> pieces_;  // the last is rest
};

}  // namespace soft_robot_lab
