// SPDX-License-Identifier: BSD-3-Clause
// The closed loop on a plant that is another simulation: softer by 15 %, and with cables that are longer than
// specified.
#include "soft_robot_lab/control/closed_loop.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "cabled_bar.h"
#include "mechanics/reduced/choose_modes.h"

namespace soft_robot_lab {
namespace {

constexpr double kRealModulus_pa = 0.85 * 264200.0;
const Eigen::Vector3d kCameraOffset_m{0.001, -0.002, 0.001};

// What the robot makes of commands.
class Plant {
 public:
  explicit Plant(const Eigen::Vector3d& gravity_m_s2 = Eigen::Vector3d::Zero())
      : simulation_(bar({}, kRealModulus_pa, gravity_m_s2)) {}

  MeasuredMarkers markers_at(const Eigen::VectorXd& commands) {
    const Eigen::Vector2d slack(0.012, 0.008);
    ForwardModel(simulation_, {}, {"left", "right"}).predict(commands + slack, false);
    MeasuredMarkers seen;
    for (const std::string name : {"tip", "middle"})
      seen[name] = simulation_.marker_position(simulation_.marker_index(name)) + kCameraOffset_m;
    return seen;
  }

 private:
  Simulation simulation_;
};

PolicyTask reach(const Eigen::Vector3d& target_m) { return {{{{{"tip", target_m, 1.0}}, 2.0, {}}}, {}, 0.0}; }

const Eigen::Vector3d kTarget{0.09, -0.035, 0.004};  // some millimetres off what can be reached

// The nearest that plant itself can come, by trying: each command a step up or down, and half the step where neither
// helps.
double nearest_m() {
  Plant plant;
  const Simulation limited = bar();
  const CommandLimits& limits = limited.actuators()[0]->limits();
  const auto distance_m = [&](const Eigen::Vector2d& c) {
    if (c.minCoeff() < limits.min || c.maxCoeff() > limits.max) return std::numeric_limits<double>::infinity();
    return (plant.markers_at(c).at("tip") - kTarget).norm();
  };
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& start :
       {Eigen::Vector2d(0.8, 0.95), Eigen::Vector2d(0.9, 1.0), Eigen::Vector2d(0.95, 0.8)}) {
    Eigen::Vector2d commands = start;
    double best = distance_m(commands);
    for (double step = 0.08; step > 1e-5; step *= 0.5)
      for (bool moved = true; moved;) {
        moved = false;
        for (const Eigen::Vector2d& way : {Eigen::Vector2d(step, 0), Eigen::Vector2d(-step, 0),
                                           Eigen::Vector2d(0, step), Eigen::Vector2d(0, -step)}) {
          const double tried = distance_m(commands + way);
          if (tried >= best) continue;
          best = tried;
          commands += way;
          moved = true;
        }
      }
    nearest = std::min(nearest, best);
  }
  return nearest;
}

LoopStep run(ClosedLoop& loop, Plant& plant, const std::string& hidden = "") {
  LoopStep step = loop.correct(0.0, plant.markers_at(Eigen::Vector2d(1.0, 1.0)), "");
  for (double time_s = 0.5; step.end == LoopEnd::none; time_s += 0.5) {
    MeasuredMarkers seen = plant.markers_at(step.commands);
    if (time_s > 1.0 && time_s < 3.0) seen.erase(hidden);
    step = loop.correct(time_s, seen, "");
  }
  return step;
}

TEST(ClosedLoop, ComesAsNearAsPlantCanThoughItsModelIsWrong) {
  Simulation model = bar();
  Plant plant;
  PolicyTask task = reach(kTarget);
  const PolicyAnswer planned = find_policy(model, task, {});
  const std::vector<double>& values = planned.policy.steps.back().values;
  const Eigen::Vector3d replayed_m = plant.markers_at(Eigen::Vector2d(values[0], values[1])).at("tip");
  model.reset();
  ClosedLoop loop(model, task, {});
  const LoopStep end = run(loop, plant);
  const double nearest = nearest_m();
  EXPECT_EQ(end.end, LoopEnd::settled) << end.reason;
  ASSERT_TRUE(end.distance_m.has_value());
  EXPECT_LT(*end.distance_m, nearest + 2.0e-4);
  EXPECT_GT((replayed_m - kTarget).norm(), nearest + 4.0e-4);  // so there was something to correct
}

// The offsets take up what the reduced model has wrong: 0.3 mm are allowed to it.
TEST(ClosedLoop, ComesAsNearByAReducedModel) {
  const Eigen::Vector3d gravity_m_s2(0, -9.81, 0);  // so that it does not buckle
  ReducedRequest request;
  request.box = {{0.9, 0.985}, {1.0, 1.0}};
  request.tolerance_m = 3.0e-4;
  const ReducedChoice reduced = choose_modes(bar({}, 264200.0, gravity_m_s2).model(), request, {});
  Plant plant(gravity_m_s2);
  const Eigen::Vector3d target_m = plant.markers_at(Eigen::Vector2d(0.94, 0.99)).at("tip");
  std::vector<double> ends_m;
  for (const ReducedChoice* predicts : {&reduced, static_cast<const ReducedChoice*>(nullptr)}) {
    Simulation model = bar({}, 264200.0, gravity_m_s2);
    model.solve_equilibrium();
    ClosedLoop loop(model, reach(target_m), {}, predicts);
    const LoopStep end = run(loop, plant);
    EXPECT_EQ(loop.on_reduced(), predicts != nullptr);
    EXPECT_EQ(end.end, LoopEnd::settled) << end.reason;
    ends_m.push_back(end.distance_m.value_or(1.0));
  }
  EXPECT_LT(ends_m[1], 4.0e-4);
  EXPECT_NEAR(ends_m[0], ends_m[1], 2.0e-5);
}

TEST(ClosedLoop, LeavesAReducedModelThatHoldsItBack) {
  ReducedRequest request;
  request.box = {{0.97, 0.97}, {1.0, 1.0}};
  request.tolerance_m = 3.0e-4;
  const ReducedChoice reduced = choose_modes(bar().model(), request, {});
  Simulation model = bar();
  Plant plant;
  ClosedLoop loop(model, reach(kTarget), {}, &reduced);
  EXPECT_TRUE(loop.on_reduced());
  const LoopStep end = run(loop, plant);
  EXPECT_FALSE(loop.on_reduced());
  EXPECT_EQ(end.end, LoopEnd::settled) << end.reason;
  EXPECT_LT(end.distance_m.value_or(1.0), nearest_m() + 2.0e-4);
}

TEST(ClosedLoop, WorksWhileAMarkerIsMissing) {
  for (const std::string hidden : {"tip", "middle"}) {
    Simulation model = bar();
    Plant plant;
    ClosedLoop loop(model, reach(kTarget), {});
    const LoopStep end = run(loop, plant, hidden);
    EXPECT_EQ(end.end, LoopEnd::settled) << hidden << ": " << end.reason;
    EXPECT_LT(end.distance_m.value_or(1.0), nearest_m() + 3.0e-4) << hidden;
  }
}

TEST(ClosedLoop, StopsWhenTrackingIsLost) {
  Simulation model = bar();
  Plant plant;
  ClosedLoop loop(model, reach(kTarget), {});
  const LoopStep first = loop.correct(0.0, plant.markers_at(Eigen::Vector2d(1.0, 1.0)), "");
  const LoopStep waiting = loop.correct(0.5, {}, "");
  EXPECT_EQ(waiting.end, LoopEnd::none);
  EXPECT_EQ(waiting.commands, first.commands);
  const LoopStep lost = loop.correct(1.1, {}, "");
  EXPECT_EQ(lost.end, LoopEnd::tracking_lost);
  EXPECT_EQ(lost.reason, "tracking lost");
  EXPECT_EQ(lost.commands, first.commands);
  EXPECT_FALSE(lost.safe());
}

TEST(ClosedLoop, StopsAtAFaultAndHolds) {
  Simulation model = bar();
  Plant plant;
  ClosedLoop loop(model, reach(kTarget), {});
  const LoopStep first = loop.correct(0.0, plant.markers_at(Eigen::Vector2d(1.0, 1.0)), "");
  const LoopStep end = loop.correct(0.5, plant.markers_at(first.commands), "left stalled");
  EXPECT_EQ(end.end, LoopEnd::fault);
  EXPECT_EQ(end.reason, "fault: left stalled");
  EXPECT_EQ(end.commands, first.commands);
}

TEST(ClosedLoop, StopsWhenTheErrorGrows) {
  Simulation model = bar();
  Plant plant;
  ClosedLoop loop(model, reach(kTarget), {});
  MeasuredMarkers seen = plant.markers_at(Eigen::Vector2d(1.0, 1.0));
  loop.correct(0.0, seen, "");
  seen.at("tip") += 0.5 * (seen.at("tip") - kTarget).normalized();
  const LoopStep end = loop.correct(0.5, seen, "");
  EXPECT_EQ(end.end, LoopEnd::error_grows);
  EXPECT_NE(end.reason.find("the error grows"), std::string::npos);
}

TEST(ClosedLoop, RefusesOptionsOutOfRange) {
  Simulation model = bar();
  const std::vector<void (*)(ClosedLoopOptions&)> spoilt = {
      [](ClosedLoopOptions& o) { o.gain = 0.0; },           [](ClosedLoopOptions& o) { o.gain = 1.1; },
      [](ClosedLoopOptions& o) { o.largest_change = 0.0; }, [](ClosedLoopOptions& o) { o.settled_m = 0.0; },
      [](ClosedLoopOptions& o) { o.lost_after_s = -1.0; },  [](ClosedLoopOptions& o) { o.error_growth_m = NAN; },
      [](ClosedLoopOptions& o) { o.max_corrections = 0; },
  };
  for (const auto& spoil : spoilt) {
    ClosedLoopOptions options;
    spoil(options);
    EXPECT_THROW(ClosedLoop(model, reach(kTarget), options), std::invalid_argument);
  }
  PolicyTask path = reach(kTarget);
  path.poses.push_back(path.poses.front());
  EXPECT_THROW(ClosedLoop(model, path, {}), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
