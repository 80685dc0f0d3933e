// SPDX-License-Identifier: BSD-3-Clause
#include "grasp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kCloseS = 0.7, kLiftS = 0.8, kSettleS = 0.5, kRampS = 0.5;
constexpr double kLiftedS = kCloseS + kLiftS + kSettleS;  // then it is shaken
constexpr double kDroppedM = 0.01;                        // in the hand

// The palm's height: it waits while the fingers close, rises, and is shaken with a smooth start and end.
double height_m(const GraspTask& task, double shaken_s, double time_s) {
  if (time_s <= kCloseS) return 0.0;
  const double risen = std::min(1.0, (time_s - kCloseS) / kLiftS);
  const double lifted_m = task.lift_m * (risen - std::sin(2.0 * M_PI * risen) / (2.0 * M_PI));
  const double since_s = time_s - kLiftedS, left_s = shaken_s - since_s;
  if (since_s <= 0.0 || left_s <= 0.0) return lifted_m;
  const double ramp = std::min({1.0, since_s / kRampS, left_s / kRampS});
  return lifted_m +
         task.amplitude_m * ramp * ramp * (3.0 - 2.0 * ramp) * std::sin(2.0 * M_PI * task.frequency_hz * since_s);
}

Overrides overrides(const GraspTask& task, double friction, double shaken_s) {
  const auto count = std::lround((kLiftedS + shaken_s + kSettleS) / task.time_step_s);
  std::vector<OverrideValue> motion;
  for (long i = 0; i <= count; ++i) {
    const double time_s = static_cast<double>(i) * task.time_step_s;
    motion.emplace_back(Overrides()
                            .set({"time_s"}, time_s)
                            .set({"translation_m"}, Eigen::Vector3d(0.0, 0.0, height_m(task, shaken_s, time_s))));
  }
  return Overrides()
      .set({"body", "fixed", "palm", "motion"}, motion)
      .set({"contact", "obstacles", "ball", "friction"}, friction)
      .set({"solver", "time_step_s"}, task.time_step_s);
}

Scene load(const ExperimentContext& context, const GraspTask& task, double friction, double shaken_s) {
  Scene scene = load_scene(task.scene, context.scene_options(overrides(task, friction, shaken_s)));
  const std::vector<Obstacle>& obstacles = scene.simulation->body().obstacles();
  if (obstacles.empty() || obstacles[0].name != "ball" || !obstacles[0].is_free())
    throw std::invalid_argument(task.scene + ": contact.obstacles: the first must be `ball`, with mass_kg");
  return scene;
}

double squeeze_n(const Simulation& simulation) { return simulation.contacts()[0].normal_force_n; }

// The fingers carry the ball's weight and inertia; what they carry is the force that it puts on them.
void take_contact(const Simulation& simulation, ShakenBall& ball) {
  const ContactReading contact = simulation.contacts()[0];
  ball.least_squeeze_n = std::min(ball.least_squeeze_n, contact.normal_force_n);
  if (contact.normal_force_n > 0.0)
    ball.least_friction = std::max(ball.least_friction, -contact.force_n.z() / contact.normal_force_n);
}

// The ball's centre in the hand.
Eigen::Vector3d in_hand_m(const Simulation& simulation, const GraspTask& task, double shaken_s) {
  const SimulationState& state = simulation.state();
  return state.contact.free.centers_m.col(0) - Eigen::Vector3d(0, 0, height_m(task, shaken_s, state.time_s));
}

// Both are of one model: pressures and anchors of the skin's points at the ball come first.
void compare_anchors(const ContactState& before, const ContactState& after, Eigen::Index points, ShakenBall& ball) {
  double all_pa = 0.0, slipped = 0.0;
  for (Eigen::Index i = 0; i < points; ++i) {
    const double pressure_pa = before.pressures_pa[i];
    if (pressure_pa == 0.0 || after.pressures_pa[i] == 0.0) continue;
    all_pa += pressure_pa;
    slipped += pressure_pa * (after.anchors_m.col(i) - before.anchors_m.col(i)).norm();
  }
  if (all_pa > 0.0) ball.slip_m = slipped / all_pa;
}

// Over the times of one phase, once a period.
double drift_m(const ShakenBall& ball, const GraspTask& task) {
  const auto period = std::lround(1.0 / (task.frequency_hz * task.time_step_s));
  double lowest_m = INFINITY, highest_m = -INFINITY;
  for (std::size_t i = 0; i < ball.time_s.size(); ++i) {
    const double since_s = ball.time_s[i] - kLiftedS;
    if (since_s < 2.0 * kRampS || since_s > ball.shaken_s - kRampS || (static_cast<long>(i) + 1) % period != 0)
      continue;
    lowest_m = std::min(lowest_m, ball.way_m[i]);
    highest_m = std::max(highest_m, ball.way_m[i]);
  }
  return std::max(0.0, highest_m - lowest_m);
}

}  // namespace

double GraspTask::acceleration_m_s2() const { return amplitude_m * std::pow(2.0 * M_PI * frequency_hz, 2); }

double LiftedBall::least_friction(double acceleration_m_s2) const {
  return mass_kg * (gravity_m_s2 + acceleration_m_s2) / squeeze_n;
}

LiftedBall lift_ball(const ExperimentContext& context, const GraspTask& task, double friction) {
  const Scene scene = load(context, task, friction, 0.0);
  Simulation& simulation = *scene.simulation;
  for (const auto& actuator : simulation.actuators()) simulation.set_command(actuator->name(), task.contraction);
  LiftedBall lifted;
  lifted.mass_kg = simulation.body().obstacles()[0].mass_kg;
  lifted.gravity_m_s2 = simulation.body().gravity_m_s2().norm();
  while (lifted.converged && simulation.state().time_s < kLiftedS - 0.5 * task.time_step_s)
    lifted.converged = simulation.step().converged;
  lifted.state = simulation.state();
  lifted.squeeze_n = squeeze_n(simulation);
  return lifted;
}

ShakenBall shake_ball(const ExperimentContext& context, const GraspTask& task, const LiftedBall& lifted,
                      double friction, double shaken_s) {
  const Scene scene = load(context, task, friction, shaken_s);
  Simulation& simulation = *scene.simulation;
  SimulationState start = lifted.state;
  start.rest_residual.reset();  // it wakes up: the friction is another
  start.linearisation.reset();
  simulation.set_state(start);
  const Eigen::Vector3d before_m = in_hand_m(simulation, task, shaken_s);
  ShakenBall ball;
  ball.friction = friction;
  ball.shaken_s = shaken_s;
  ball.least_squeeze_n = lifted.squeeze_n;
  ball.held = true;
  const double end_s = kLiftedS + shaken_s + kSettleS - 0.5 * task.time_step_s;
  while (ball.converged && ball.held && simulation.state().time_s < end_s) {
    ball.converged = simulation.step().converged;
    const double way_m = in_hand_m(simulation, task, shaken_s).z() - before_m.z();
    ball.time_s.push_back(simulation.state().time_s);
    ball.way_m.push_back(way_m);
    take_contact(simulation, ball);
    ball.held = way_m > -kDroppedM;
  }
  ball.moved_m = (in_hand_m(simulation, task, shaken_s) - before_m).norm();
  ball.drift_m = drift_m(ball, task);
  const Eigen::Index points =
      start.contact.pressures_pa.size() / static_cast<Eigen::Index>(simulation.body().obstacles().size());
  compare_anchors(start.contact, simulation.state().contact, points, ball);
  return ball;
}

}  // namespace soft_robot_lab
