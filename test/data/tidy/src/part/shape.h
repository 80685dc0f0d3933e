// SPDX-License-Identifier: BSD-3-Clause
// Faults for check_tidy.py to find: a missing `override`, and a name that a public header has too.
#pragma once

namespace soft_robot_lab {

class Shape {
 public:
  virtual ~Shape() = default;
  virtual double volume_m3() const { return 0.0; }
};

class Box : public Shape {
 public:
  double volume_m3() const { return 1.0; }
};

class Ball {};

}  // namespace soft_robot_lab
