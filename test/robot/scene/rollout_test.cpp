// SPDX-License-Identifier: BSD-3-Clause
// Several threads roll out one model, each with a workspace and a state of its own.
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/overrides_from.h"

namespace soft_robot_lab {
namespace {

constexpr int kRollouts = 4;
constexpr int kSteps = 5;

std::shared_ptr<const Model> model_of(const std::string& robot, const std::string& overrides) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from(overrides);
  return load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/" + robot + "/robot.yaml", options).simulation->model();
}

// Another way each, by steps in time and to rest, with a question about derivatives between; also on from a state that
// another simulation has reached.
std::vector<SimulationState> roll_out(const std::shared_ptr<const Model>& model, int rollout, bool to_rest) {
  Simulation simulation(model), second(model);
  std::vector<SimulationState> states;
  for (std::size_t i = 0; i < model->actuators().size(); ++i) {
    const CommandLimits& limits = model->actuators()[i]->limits();
    const bool pulled = i % 2 == 0 && model->actuators().size() > 1;  // a chamber alone is filled
    const double end = pulled ? limits.min : limits.max;
    simulation.set_command(model->actuators()[i]->name(), limits.rest + 0.05 * (1 + rollout) * (end - limits.rest));
  }
  for (int step = 0; step < kSteps; ++step) {
    simulation.step();
    states.push_back(simulation.state());
  }
  second.set_state(states[1]);
  second.step();
  states.push_back(second.state());
  if (!to_rest) return states;
  EXPECT_TRUE(simulation.solve_equilibrium().converged);
  simulation.marker_sensitivities();
  states.push_back(simulation.state());
  return states;
}

void expect_equal(const std::vector<SimulationState>& one, const std::vector<SimulationState>& other) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(one[i] == other[i]) << i;
}

void expect_the_numbers_of_one_thread(const std::string& robot, const std::string& overrides, bool to_rest = true) {
  SCOPED_TRACE(robot + ": " + overrides);
  const std::shared_ptr<const Model> model = model_of(robot, overrides);
  std::vector<std::vector<SimulationState>> alone(kRollouts), together(kRollouts);
  std::vector<std::thread> threads;
  for (int i = 0; i < kRollouts; ++i)
    threads.emplace_back([&, i] { together[static_cast<std::size_t>(i)] = roll_out(model, i, to_rest); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < kRollouts; ++i) {
    SCOPED_TRACE(i);
    alone[i] = roll_out(model, static_cast<int>(i), to_rest);
    expect_equal(alone[i], together[i]);
    EXPECT_TRUE(alone[i][1] == alone[i][1]);
    EXPECT_FALSE(alone[i][1] == alone[i][2]);
    EXPECT_EQ(alone[i][2].positions_m, alone[i][kSteps].positions_m) << "a restored state goes on another way";
  }
  EXPECT_FALSE(alone[0].back() == alone[1].back());
}

TEST(RolloutsOfOneModel, GiveTheNumbersOfOneThreadWithCables) {
  expect_the_numbers_of_one_thread("spinebot", "solver: {integrator: bdf2}");
}

TEST(RolloutsOfOneModel, GiveTheNumbersOfOneThreadWithFriction) {
  expect_the_numbers_of_one_thread("hammerbot",
                                   "cables: {left: {model: friction, friction_coefficient: 0.3}, "
                                   "right: {model: friction, friction_coefficient: 0.3}}");
}

TEST(RolloutsOfOneModel, GiveTheNumbersOfOneThreadWithChambers) {
  expect_the_numbers_of_one_thread("hollow_cuboid", "body: {element_size_m: 0.02}");
  expect_the_numbers_of_one_thread("hollow_cuboid",
                                   "{body: {element_size_m: 0.02}, chambers: {main: {model: explicit}}}", false);
}

TEST(RolloutsOfOneModel, GiveTheNumbersOfOneThreadElementByElement) {
  expect_the_numbers_of_one_thread("hollow_cuboid",
                                   "{body: {element_size_m: 0.02}, solver: {method: xpbd, substeps: 2}}", false);
}

}  // namespace
}  // namespace soft_robot_lab
