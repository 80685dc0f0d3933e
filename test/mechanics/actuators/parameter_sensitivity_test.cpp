// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of equilibria by numbers of the scene, against central differences.
#include <cmath>
#include <functional>
#include <iomanip>

#include <gtest/gtest.h>

#include "test_bar.h"

namespace soft_robot_lab {
namespace {

struct Values {
  double youngs_modulus_pa = 264200.0, offset_m = 0.0, compliance_m_n = 2e-4, friction_coefficient = 0.3,
         density_kg_m3 = 1070.0;
};

Simulation two_cable_bar(const Values& v, const std::string& model) {
  Body body(box_mesh({-0.01, -0.1, -0.01}, {0.01, 0, 0.01}, {2, 6, 2}),
            Material{v.youngs_modulus_pa, 0.49, v.density_kg_m3});
  body.fix_nodes({-10, -1e-6, -10}, {10, 10, 10}, {true, true, true});
  body.set_gravity({4, -9, 0});
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  for (const double side : {-1.0, 1.0}) {
    std::ostringstream settings;
    settings << "{name: " << (side < 0 ? "left" : "right") << ", model: " << model
             << ", length_offset_m: " << std::setprecision(17) << v.offset_m << ", compliance_m_n: " << v.compliance_m_n
             << ", pretension_n: 0.05, ";
    if (model == "friction") settings << "friction_coefficient: " << v.friction_coefficient << ", ";
    settings << "sheath_radius_m: 0.002, plug_radius_m: 0.003, points_m: [";
    for (const double y : {0.0, 0.02, 0.04, 0.06, 0.08, 0.095})
      settings << (y > 0 ? ", " : "") << "[" << side * (y == 0.04 ? 0.003 : 0.006) << ", " << -y << ", 0]";
    settings << "]}";
    actuators.push_back(std::make_unique<Cable>());
    actuators.back()->initialise(YamlNode::parse(settings.str(), "bar"), body, locator);
  }
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0, -0.1, 0), body.mesh(), locator);
  markers.emplace_back("middle", Eigen::Vector3d(0.012, -0.05, 0), body.mesh(), locator);
  SolverOptions options;
  options.tolerance = 1e-10;
  return Simulation(std::move(body), std::move(actuators), std::move(markers), options);
}

constexpr double kExact = 2e-5;  // the solver's matrix softens the second derivative of cables by up to 1e-3

using Way = std::vector<std::pair<double, double>>;  // contractions of both cables, one equilibrium after the other

Eigen::VectorXd walk(Simulation& simulation, const Way& way, const std::vector<ModelParameter>& parameters,
                     Eigen::MatrixXd* jacobian) {
  Eigen::MatrixXd slipped_m;
  for (const auto& [left, right] : way) {
    simulation.set_command("left", left);
    simulation.set_command("right", right);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.steps, 1) << "a stage between, of which the derivative knows nothing";
    if (jacobian) *jacobian = simulation.parameter_sensitivities(parameters, slipped_m);
  }
  Eigen::VectorXd markers(6);
  markers << simulation.marker_position(0), simulation.marker_position(1);
  return markers;
}

void expect_exact(const std::string& model, const Way& way, const std::string& key, double Values::*value,
                  double step) {
  Simulation simulation = two_cable_bar({}, model);
  const std::vector<ModelParameter> parameters = {
      {key, key == "youngs_modulus_pa" || key == "density_kg_m3" ? std::vector<int>{} : std::vector<int>{0, 1}}};
  Eigen::MatrixXd exact;
  walk(simulation, way, parameters, &exact);
  Values more, less;
  more.*value += step;
  less.*value -= step;
  Simulation above = two_cable_bar(more, model), below = two_cable_bar(less, model);
  const Eigen::VectorXd difference = (walk(above, way, {}, nullptr) - walk(below, way, {}, nullptr)) / (2.0 * step);
  EXPECT_GT(difference.norm() * std::abs(step), 1e-9) << key << " does nothing";
  EXPECT_LT((exact - difference).norm(), kExact * difference.norm()) << key << ", " << model << "\n"
                                                                     << exact.transpose() << "\n"
                                                                     << difference.transpose();
}

const Way kPull = {{1.0, 1.0}, {0.95, 1.0}, {0.9, 0.97}};

TEST(ParameterSensitivity, MatchesDifferencesForSlidingCables) {
  expect_exact("sliding", kPull, "youngs_modulus_pa", &Values::youngs_modulus_pa, 200.0);
  expect_exact("sliding", kPull, "density_kg_m3", &Values::density_kg_m3, 1.0);
  expect_exact("sliding", kPull, "length_offset_m", &Values::offset_m, 1e-5);
  expect_exact("sliding", kPull, "compliance_m_n", &Values::compliance_m_n, 1e-6);
}

TEST(ParameterSensitivity, IsZeroForACableThatIsSlack) {
  Simulation simulation = two_cable_bar({}, "sliding");
  Eigen::MatrixXd exact;
  walk(simulation, {{1.05, 1.05}}, {{"length_offset_m", {0}}, {"youngs_modulus_pa", {}}}, &exact);
  EXPECT_EQ(exact.col(0).norm(), 0.0);
  EXPECT_GT(exact.col(1).norm(), 0.0);
}

TEST(ParameterSensitivity, FollowsFrictionThroughPullAndRelease) {
  const Way release = {{1.0, 1.0}, {0.95, 1.0}, {0.9, 0.99}, {0.93, 0.97}};
  for (const Way& way : {kPull, release}) {
    expect_exact("friction", way, "friction_coefficient", &Values::friction_coefficient, 1e-3);
    expect_exact("friction", way, "youngs_modulus_pa", &Values::youngs_modulus_pa, 200.0);
    expect_exact("friction", way, "length_offset_m", &Values::offset_m, 1e-5);
    expect_exact("friction", way, "compliance_m_n", &Values::compliance_m_n, 1e-6);
  }
}

TEST(ParameterSensitivity, RefusesWhatTheActuatorDoesNotKnow) {
  Simulation simulation = two_cable_bar({}, "sliding");
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  Eigen::MatrixXd slipped_m;
  EXPECT_THROW(simulation.parameter_sensitivities({{"friction_coefficient", {0}}}, slipped_m), std::invalid_argument);
}

TEST(ParameterSensitivity, IsRefusedAwayFromAnEquilibrium) {
  Simulation simulation = two_cable_bar({}, "sliding");
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  simulation.set_command("left", 0.9);
  simulation.step();
  Eigen::MatrixXd slipped_m;
  for (const auto& ask : {std::function<void()>([&] { simulation.marker_sensitivities(); }), std::function<void()>([&] {
                            simulation.parameter_sensitivities({{"density_kg_m3", {}}}, slipped_m);
                          })}) {
    try {
      ask();
      FAIL() << "was answered";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("no equilibrium: its residual"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
