// SPDX-License-Identifier: BSD-3-Clause
// Scenes drawn at random, in which a bar that hangs, stands or lies is bent, pushed, twisted and pulled. Robots are
// drawn by drawn_robots.h.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct DrawnScene {
  std::string name;  // with its seed, kind and friction
  // "post", "ball", "box", "rod", "load", "cable", "cables", "hold"; or several, joined by "+"; a robot's file first.
  std::string kind;
  std::string robot;             // a file below config/, over which the rest is laid; empty: none
  std::string body_and_contact;  // YAML: all but gravity and loads
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d end_force_n = Eigen::Vector3d::Zero();  // on the face at `end_z_m` and below
  double end_z_m = 0.0;
  double friction = 0.0;                                 // of what it touches
  std::vector<std::pair<std::string, double>> commands;  // where the motion ends

  // The scene in YAML with this share of gravity and loads.
  std::string text(double share_of_loads) const;
};

// The same seed draws the same scene on every machine. What moves does so evenly from 0 to `motion_s`.
DrawnScene draw_scene(std::uint64_t seed, double motion_s);

// The same of several things at once: up to two obstacles and cables, an end load or an end that is held and moved,
// and gravity along any direction.
DrawnScene draw_joined_scene(std::uint64_t seed, double motion_s);

}  // namespace soft_robot_lab
