// SPDX-License-Identifier: BSD-3-Clause
// What holds the held nodes.
#include <gtest/gtest.h>

#include <cmath>

#include "test_bar.h"

namespace soft_robot_lab {
namespace {

constexpr double kWeight_n = 0.02 * 0.02 * 0.1 * 1070.0 * 9.81;  // of the hanging bar

// Of gravity, about the origin.
Eigen::Vector3d weight_moment_nm(const Simulation& simulation) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Eigen::Matrix3Xd loads_n = simulation.body().external_forces_n();
  for (Eigen::Index node = 0; node < loads_n.cols(); ++node)
    sum += Eigen::Vector3d(simulation.state().positions_m.col(node)).cross(Eigen::Vector3d(loads_n.col(node)));
  return sum;
}

Eigen::Vector3d moment_nm(const Simulation& simulation) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Eigen::Matrix3Xd forces_n = simulation.reaction_forces_n();
  for (Eigen::Index node = 0; node < forces_n.cols(); ++node)
    sum += Eigen::Vector3d(simulation.state().positions_m.col(node)).cross(Eigen::Vector3d(forces_n.col(node)));
  return sum;
}

TEST(Reaction, CarriesTheWeightHoweverTheCablePulls) {
  for (const char* model : {"model: sliding", "model: friction, friction_coefficient: 0.3"}) {
    Simulation simulation = hanging_bar(model);
    simulation.set_command("cable", 0.85);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    EXPECT_GT(*simulation.actuator_state(0).tension_n, 1.0);
    const Eigen::Vector3d force_n = simulation.reaction_forces_n().rowwise().sum();
    EXPECT_LT((force_n - Eigen::Vector3d(0, kWeight_n, 0)).norm(), 1e-4 * kWeight_n) << model;
    EXPECT_LT((moment_nm(simulation) + weight_moment_nm(simulation)).norm(), 1e-4 * 0.1 * kWeight_n) << model;
  }
}

TEST(Reaction, IsZeroWhereNothingIsHeld) {
  Simulation simulation = hanging_bar("model: sliding");
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const Eigen::Matrix3Xd forces_n = simulation.reaction_forces_n();
  EXPECT_TRUE((simulation.body().fixed().array() || forces_n.array() == 0.0).all());
  EXPECT_GT(forces_n.norm(), 0.0);
}

TEST(Reaction, LeavesTheStateAlone) {
  Simulation simulation = hanging_bar("model: springs, stiffness_n_m: 2000, damping_n_s_m: 2");
  simulation.set_command("cable", 0.95);
  simulation.step();
  const SimulationState before = simulation.state();
  simulation.reaction_forces_n();
  EXPECT_TRUE(simulation.state() == before);
}

}  // namespace
}  // namespace soft_robot_lab
