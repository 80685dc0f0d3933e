// SPDX-License-Identifier: BSD-3-Clause
// A scene's body as Bullet's deformable solver sees it: the same linear tetrahedra, lumped masses, held nodes and
// loads.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// Bullet's own knobs. Stiffness comes from the scene: its parameters are set so that small strains follow Hooke's law
// with the scene's Young's modulus and Poisson's ratio.
struct BulletSettings {
  std::string model = "neo_hookean";  // neo_hookean, linear (corotated small strain), corotated (explicit only)
  bool implicit = true;
  bool line_search = false;
  double time_step_s = 1.0 / 60.0;  // > 0
  int newton_iterations = 5;
  double newton_tolerance = 1.0e-6;  // norm of the residual impulse [N s]
  int krylov_iterations = 100;
  double krylov_tolerance = 1.0e-10;  // largest change of a node's speed [m/s]; CG's: relative energy
  double damping_s = 0.0;             // viscosity over stiffness
  double drag = 0.0;                  // share of its speed that a node loses in a step
  double mass_scale = 1.0;            // of inertia, not of weight
};

class BulletBody {
 public:
  // The scene's simulation must have linear elements, and outlive this.
  BulletBody(const Simulation& scene, const BulletSettings& settings);
  ~BulletBody();
  BulletBody(const BulletBody&) = delete;
  BulletBody& operator=(const BulletBody&) = delete;

  void step();  // one of BulletSettings::time_step_s
  Eigen::Matrix3Xd positions_m() const;
  double largest_speed_m_s() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace soft_robot_lab
