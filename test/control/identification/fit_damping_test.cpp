// SPDX-License-Identifier: BSD-3-Clause
// Fitting the damping to swings, on a coarse bar with two cables whose truth is known.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "fitted_bar.h"
#include "control/identification/swing_model.h"
#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {
namespace {

// Released from a pull, as cameras behind the drives would see it.
MeasuredSwing swing_of(const std::string& overrides, double pulled, double noise_m, unsigned seed) {
  const Scene scene = load_scene(kScene, options_with(overrides));
  Simulation& simulation = *scene.simulation;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise_m);
  MeasuredSwing swing{{{"left", pulled}}, {{10.0, {{"left", 1.1}, {"right", 1.1}}}}, {}};
  simulation.set_command("left", pulled);
  EXPECT_TRUE(simulation.solve_equilibrium().converged);
  simulation.set_command("left", 1.1);
  simulation.set_command("right", 1.1);
  constexpr double delay_s = 0.27;  // such as a message sent by rostopic has
  for (int step = 1; step <= 90; ++step) {
    simulation.step();
    if (step % 2 != 0) continue;
    MarkersAt at{10.0 + delay_s + step * simulation.options().time_step_s, {}};
    for (int m = 0; m < 2; ++m)
      at.markers.push_back(
          {simulation.markers()[static_cast<std::size_t>(m)].name(),
           simulation.marker_position(m) + Eigen::Vector3d::NullaryExpr([&](int) { return normal(random); }),
           std::pow(std::max(1e-5, noise_m), 2) * Eigen::Matrix3d::Identity()});
    swing.seen.push_back(std::move(at));
  }
  return swing;
}

const std::string kFineSteps = "solver: {time_step_s: 0.008, integrator: implicit_euler}\n";

TEST(FitModel, FindsTheDampingOfSwings) {
  const std::string damped = "body: {damping: {rayleigh_stiffness_s: 0.004}}\n";
  FitRequest request;
  request.parameters = {{"damping", {}, {}, {}}};
  const MeasuredSwing swing = swing_of(kFineSteps + damped, 0.85, 1e-4, 1);
  const FitResult result = fit_model(kScene, options_with(kFineSteps), {}, request, {swing});
  EXPECT_TRUE(result.converged) << result.message;
  expect_within(result, "damping.rayleigh_stiffness_s", 0.004);
  EXPECT_LT(value_of(result, "damping.rayleigh_stiffness_s").deviation, 0.06 * 0.004);
  EXPECT_EQ(result.swings, 1);
  EXPECT_LT(result.swing_rms_m, 2.5e-4) << summary(result);
  EXPECT_TRUE(result.overrides.has({"body", "damping", "rayleigh_stiffness_s"})) << result.overrides.text();
}

// Of a robot on a finer mesh with another stiffness, let go of more than once.
TEST(FitModel, FindsTheDampingBesideWhatRestTells) {
  const std::string truth = kFineSteps + kLying +
                            "body: {element_size_m: 0.015, material: {youngs_modulus_pa: 290620}, "
                            "damping: {rayleigh_stiffness_s: 0.004}}\n";
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}, {"damping", 0.01, {}, {}}};
  const std::vector<MeasuredPose> poses = measure(truth, kWay, Eigen::Isometry3d::Identity(), 5e-5, 1);
  const FitResult result = fit_model(kScene, options_with(kFineSteps + kLying), poses, request,
                                     {swing_of(truth, 0.9, 1e-4, 1), swing_of(truth, 0.85, 1e-4, 2)});
  EXPECT_TRUE(result.converged) << result.message;
  EXPECT_EQ(result.swings, 2);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 290620, 0.1 * 290620) << "of such meshes no better";
  // The integrator damps as 8 ms would, and that grows with the stiffness too.
  EXPECT_NEAR(value_of(result, "damping.rayleigh_stiffness_s").value, 0.004, 0.1 * 0.004) << summary(result);
  EXPECT_EQ(result.correlations.rows(), 2);

  const std::string file =
      std::filesystem::temp_directory_path().string() + "/soft_robot_lab_damped_" + std::to_string(getpid()) + ".yaml";
  write_fitted_scene(result, kScene, file);
  EXPECT_NEAR(load_scene(file, options_with("")).simulation->body().viscosity().rayleigh_stiffness_s,
              value_of(result, "damping.rayleigh_stiffness_s").value, 1e-12);
  std::filesystem::remove(file);
}

TEST(SwingModel, IsFreeOnceItsCablesAreSlackThoughDrivesGoOn) {
  const std::string slow = "compliance_m_n: 1.0e-5, pull_speed_m_s: 0.05";
  const std::string overrides =
      kFineSteps + "cables: [" + cable("left", -0.007, slow) + ", " + cable("right", 0.007, slow) + "]\n";
  const MeasuredSwing swing{{{"left", 0.9}}, {{10.0, {{"left", 1.2}}}}, {}};
  const SimulatedSwing simulated =
      simulate_swings(*load_scene(kScene, options_with(overrides)).simulation, {swing}, 0.5).front();
  EXPECT_GT(simulated.free_s(), 10.1);
  EXPECT_LT(simulated.free_s(), 10.4) << "the drive arrives at 10.6 s";
  const Eigen::Vector3d before = simulated.deflection_m(0, 10.0), after = simulated.deflection_m(0, simulated.free_s());
  EXPECT_GT(before.norm(), 0.01);
  EXPECT_LT(after.norm(), 0.5 * before.norm());
  constexpr double h = 1e-4;
  const double at_s = simulated.free_s() + 0.05;
  EXPECT_LT((simulated.velocity_m_s(0, at_s) -
             (simulated.deflection_m(0, at_s + h) - simulated.deflection_m(0, at_s - h)) / (2.0 * h))
                .norm(),
            1e-3 * simulated.velocity_m_s(0, at_s).norm());
}

// Held by taut cables nothing swings; what creeps does not either.
TEST(FitModel, TakesNoDampingFromWhatDoesNotSwing) {
  MeasuredSwing creep = swing_of(kFineSteps, 0.9, 1e-4, 1);
  for (MarkersAt& at : creep.seen)
    for (MeasuredMarker& marker : at.markers)
      marker.position_m = {2e-3 * std::exp(-(at.time_s - 10.0) / 3.0), 0.0, -0.1};
  MeasuredSwing held = creep;
  held.commands = {{10.0, {{"left", 0.9}, {"right", 0.9}}}};
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}, {"damping", {}, {}, {}}};
  const std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 5e-5, 1);
  const FitResult result = fit_model(kScene, options_with(kLying), poses, request, {creep, held});
  EXPECT_TRUE(warns(result, "damping: the data cannot identify it")) << summary(result);
  EXPECT_EQ(result.values.size(), 1u);
  EXPECT_FALSE(result.overrides.has({"body", "damping"})) << result.overrides.text();
}

}  // namespace
}  // namespace soft_robot_lab
