// SPDX-License-Identifier: BSD-3-Clause
// A gripper that closes on a ball, lifts it, and is shaken up and down: whether friction holds the ball.
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/simulation_state.h"
#include "study/experiment.h"

namespace soft_robot_lab {

struct GraspTask {
  std::string scene;          // its first obstacle is a free one named `ball`, its held region is named `palm`
  double contraction = 1.0;   // of all cables
  double lift_m = 0.0;        // along z, before it is shaken
  double amplitude_m = 0.0;   // of shaking, along z
  double frequency_hz = 1.0;  // likewise
  double time_step_s = 0.01;

  double acceleration_m_s2() const;  // of shaking, the largest
};

// The ball in the hand, at rest above the floor.
struct LiftedBall {
  SimulationState state;
  bool converged = true;
  double mass_kg = 0.0;
  double squeeze_n = 0.0;  // the normal forces of all fingers, summed up: 2 N of two
  double gravity_m_s2 = 0.0;

  // The least friction that carries it: 2 mu N = m (g + a), with N at rest.
  double least_friction(double acceleration_m_s2) const;
};

struct ShakenBall {
  double friction = 0.0, shaken_s = 0.0;
  bool converged = true;
  bool held = false;             // it is still in the hand at the end
  double least_squeeze_n = 0.0;  // while it is shaken
  double least_friction = 0.0;   // that carries it, likewise: m (g + a) / 2 N, each at the same time, at most
  double moved_m = 0.0;          // the ball in the hand, at rest after against at rest before
  double slip_m = 0.0;   // of the skin along the ball, likewise: mean by pressure over points that press at both times
  double drift_m = 0.0;  // the ball in the hand, between two whole periods of full shaking, at most
  std::vector<double> time_s, way_m;  // of the ball in the hand along z since it was at rest, one of each step
};

// Throws as load_scene.
LiftedBall lift_ball(const ExperimentContext& context, const GraspTask& task, double friction);
ShakenBall shake_ball(const ExperimentContext& context, const GraspTask& task, const LiftedBall& lifted,
                      double friction, double shaken_s);

}  // namespace soft_robot_lab
