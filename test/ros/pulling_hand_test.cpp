// SPDX-License-Identifier: BSD-3-Clause
// The law of the spring from the skin to the hand.
#include "ros/simulator/pulling_hand.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "mechanics/box_mesh.h"
#include "ros/messages/conversions.h"

namespace soft_robot_lab {
namespace {

constexpr double largest_n = 10.0;

// Along x from 0 to 100 mm, 10 x 10 mm, held at x = 0, without gravity.
Simulation bar() {
  Body body(box_mesh({0, -0.005, -0.005}, {0.1, 0.005, 0.005}, {10, 1, 1}), {264200.0, 0.4, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, Eigen::Matrix<bool, 3, 1>::Constant(true));
  return Simulation(std::move(body), {}, {}, {});
}

const Eigen::Vector3d tip_m(0.1, 0.0, 0.0);

SkinPull spring(double stiffness_n_m, const Eigen::Vector3d& way_m) {
  SkinPull pull;
  pull.point = to_message(tip_m);
  pull.hand = to_message(Eigen::Vector3d(tip_m + way_m));
  pull.stiffness_n_m = stiffness_n_m;
  return pull;
}

Eigen::Vector3d tip_of(const Simulation& simulation) {
  static const EmbeddedPoint tip = MeshLocator(simulation.body().mesh()).embed(tip_m);
  return tip.at(simulation.state().positions_m);
}

void hold(PullingHand& hand, const SkinPull& pull, double time_s, Simulation& simulation) {
  hand.take(pull, 0.0, simulation);
  for (int i = 0; i < static_cast<int>(time_s / simulation.options().time_step_s); ++i) hand.step(simulation);
}

// What holds the bar: at rest it is what the hand pulls by.
Eigen::Vector3d held_by_n(const Simulation& simulation) { return -simulation.reaction_forces_n().rowwise().sum(); }

TEST(PullingHand, PullsByItsStiffnessTimesTheWayThatIsLeft) {
  const Eigen::Vector3d way_m(0.0, 0.01, -0.005);
  double last_m = 0.0;
  for (const double stiffness_n_m : {0.5, 2.0, 20.0, 200.0}) {
    Simulation simulation = bar();
    PullingHand hand(largest_n);
    hold(hand, spring(stiffness_n_m, way_m), 2.0, simulation);
    const Eigen::Vector3d left_m = tip_m + way_m - tip_of(simulation);
    const Eigen::Vector3d force_n = held_by_n(simulation);
    const double disc_m = 1e-4;  // from the tip to the mean of the disc that is held
    EXPECT_LT((force_n - stiffness_n_m * left_m).norm(), 0.05 * force_n.norm() + stiffness_n_m * disc_m)
        << stiffness_n_m << " N/m";
    const double moved_m = (tip_of(simulation) - tip_m).norm();
    EXPECT_GT(moved_m, last_m) << "a stiffer spring brings it nearer";
    last_m = moved_m;
  }
  EXPECT_GT(last_m, 0.9 * way_m.norm());
}

TEST(PullingHand, ShakesNoBodyByAStiffSpring) {
  Simulation simulation = bar();
  PullingHand hand(largest_n);
  hold(hand, spring(1000.0, {0.0, 0.01, 0.0}), 2.0, simulation);
  const Eigen::Vector3d then_m = tip_of(simulation);
  hold(hand, spring(1000.0, {0.0, 0.01, 0.0}), 0.1, simulation);
  EXPECT_LT((tip_of(simulation) - then_m).norm(), 1e-4);
  EXPECT_NEAR(then_m.y(), 0.01, 1e-3);
}

TEST(PullingHand, PullsNoHarderThanItMay) {
  Simulation simulation = bar();
  PullingHand hand(0.01);
  hold(hand, spring(200.0, {0.0, 0.05, 0.0}), 2.0, simulation);
  EXPECT_NEAR(held_by_n(simulation).norm(), 0.01, 3e-4);
}

TEST(PullingHand, AddsAForceToItsSpringAndLetsGoOfBoth) {
  Simulation simulation = bar();
  PullingHand hand(largest_n);
  SkinPull pull = spring(1.0, Eigen::Vector3d::Zero());
  pull.force.y = 0.01;
  hold(hand, pull, 2.0, simulation);
  const double off_m = (tip_of(simulation) - tip_m).y();
  EXPECT_NEAR(held_by_n(simulation).y(), 0.01 - 1.0 * off_m, 3e-4);
  hold(hand, SkinPull(), 2.0, simulation);
  EXPECT_LT((tip_of(simulation) - tip_m).norm(), 2e-4);
}

TEST(PullingHand, RefusesAStiffnessThatIsNone) {
  Simulation simulation = bar();
  PullingHand hand(largest_n);
  for (const double stiffness_n_m : {-1.0, 1001.0, std::nan("")}) {
    try {
      hand.take(spring(stiffness_n_m, {0.0, 0.01, 0.0}), 0.0, simulation);
      FAIL() << stiffness_n_m;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("stiffness_n_m"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
