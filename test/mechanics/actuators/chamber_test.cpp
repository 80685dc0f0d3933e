// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuators/chamber.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "hollow_mesh.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/elements/elements.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kP0 = 101000.0;

// A hollow cube held at its lower face; `scale` 1 is an edge of 30 mm.
Body cube(double scale = 1.0, double density_kg_m3 = 1070.0) {
  Body body(hollow_cube(scale), {264200.0, 0.49, density_kg_m3});
  body.fix_nodes(Eigen::Vector3d::Constant(-1e3), {1e3, 1e3, -0.0149 * scale}, {true, true, true});
  return body;
}

std::unique_ptr<Chamber> chamber(const Body& body, const std::string& more) {
  auto made = std::make_unique<Chamber>();
  made->initialise(YamlNode::parse("{name: air, surface: cavity" + more + "}", "chamber.yaml"), body,
                   MeshLocator(body.mesh()));
  return made;
}

Simulation simulation(Body body, const std::string& more, const SolverOptions& options = {}) {
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(chamber(body, more));
  const double size = body.mesh().nodes_m.maxCoeff();
  std::vector<Marker> markers;
  const MeshLocator locator(body.mesh());
  markers.emplace_back("top", Eigen::Vector3d(0, 0, size), body.mesh(), locator);
  markers.emplace_back("side", Eigen::Vector3d(size, 0.3 * size, 0.2 * size), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), options);
}

ActuatorReading at_rest(Simulation& simulation, double command) {
  simulation.set_command("air", command);
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  EXPECT_EQ(report.inverted_elements, 0);
  return simulation.actuator_state(0);
}

TEST(Chamber, IsAtRestWithItsInitialGas) {
  Simulation simple = simulation(cube(), "");
  const ActuatorReading reading = at_rest(simple, 1.0);
  EXPECT_NEAR(*reading.initial_volume_m3, 1e-6, 1e-15);
  EXPECT_NEAR(*reading.volume_m3, 1e-6, 1e-15);
  EXPECT_NEAR(*reading.gauge_pressure_pa, 0.0, 1e-6);
}

TEST(Chamber, HasNoNegativeZeroOfPressure) {
  const ActuatorReading reading =
      simulation(cube(), ", command: gauge_pressure, max_gauge_pressure_pa: 1000").actuator_state(0);
  EXPECT_EQ(*reading.gauge_pressure_pa, 0.0);
  EXPECT_FALSE(std::signbit(*reading.gauge_pressure_pa));
}

TEST(Chamber, ClosesTheBalanceOfPressureAndVolume) {
  Simulation inflated = simulation(cube(), "");
  for (const double beta : {1.5, 4.0, 0.5}) {
    const ActuatorReading reading = at_rest(inflated, beta);
    EXPECT_NEAR((*reading.gauge_pressure_pa + kP0) * *reading.volume_m3 / (beta * kP0 * 1e-6), 1.0, 1e-6);
    EXPECT_LT(std::abs(*reading.gas_residual), 1e-6);
    EXPECT_EQ(*reading.gauge_pressure_pa > 0.0, beta > 1.0);
  }
}

// Three ways to ask for the same gas, and a regulator at the pressure that it has.
TEST(Chamber, CommandsAgree) {
  Simulation beta = simulation(cube(), ""), offset = simulation(cube(), ", command: volume_offset"),
             syringe = simulation(cube(), ", command: syringe, syringe_volume_ml: 3, tube_volume_ml: 0.5"),
             regulator = simulation(cube(), ", command: gauge_pressure, max_gauge_pressure_pa: 50000");
  const ActuatorReading by_beta = at_rest(beta, 1.4), by_offset = at_rest(offset, 0.4);
  const ActuatorReading by_pressure = at_rest(regulator, *by_beta.gauge_pressure_pa);
  EXPECT_NEAR(*by_offset.volume_m3, *by_beta.volume_m3, 1e-6 * *by_beta.volume_m3);
  EXPECT_NEAR(*by_pressure.volume_m3, *by_beta.volume_m3, 1e-5 * *by_beta.volume_m3);
  EXPECT_FALSE(by_pressure.gas_residual.has_value());
  // Boyle for the whole closed system; the chamber's part of the gas fills it as that much beta would.
  const ActuatorReading by_syringe = at_rest(syringe, 2.0);
  const double p = *by_syringe.gauge_pressure_pa;
  EXPECT_NEAR((p + kP0) * (*by_syringe.volume_m3 + 1.5e-6) / (kP0 * 4.5e-6), 1.0, 1e-6);
  const ActuatorReading as_much = at_rest(beta, (p + kP0) * *by_syringe.volume_m3 / (kP0 * 1e-6));
  EXPECT_NEAR(*as_much.gauge_pressure_pa, p, 1e-4 * p);
}

TEST(Chamber, EqualBodiesOfAnySizeSwellAlike) {
  Simulation middle = simulation(cube(), "");
  const ActuatorReading expected = at_rest(middle, 1.5);
  for (const double scale : {1.0 / 3.0, 100.0 / 3.0}) {  // an edge of 1 cm and of 1 m
    Simulation other = simulation(cube(scale), "");
    const ActuatorReading found = at_rest(other, 1.5);
    EXPECT_NEAR(*found.volume_m3 / *found.initial_volume_m3, *expected.volume_m3 / *expected.initial_volume_m3, 1e-6);
    EXPECT_NEAR(*found.gauge_pressure_pa, *expected.gauge_pressure_pa, 1e-4 * *expected.gauge_pressure_pa);
  }
}

TEST(Chamber, SensitivitiesAgreeWithCentralDifferences) {
  struct Case {
    const char* settings;
    double command, h;
  };
  for (const double scale : {1.0 / 3.0, 100.0 / 3.0}) {
    const double ml = std::pow(scale, 3);  // the hollow's volume
    const std::string volume = std::to_string(ml);
    const Case cases[] = {{"", 1.6, 1e-3},
                          {", command: volume_offset", 0.5 * ml, 1e-3 * ml},
                          {", command: gauge_pressure", 9000.0, 20.0}};
    for (const Case& c : cases) {
      SCOPED_TRACE(c.settings);
      SolverOptions options;
      options.tolerance = 1e-9;
      Simulation inflated = simulation(cube(scale), c.settings, options);
      at_rest(inflated, c.command);
      const Eigen::MatrixXd exact = inflated.marker_sensitivities();
      Eigen::VectorXd plus(6), minus(6);
      at_rest(inflated, c.command + c.h);
      for (int marker = 0; marker < 2; ++marker) plus.segment<3>(3 * marker) = inflated.marker_position(marker);
      at_rest(inflated, c.command - c.h);
      for (int marker = 0; marker < 2; ++marker) minus.segment<3>(3 * marker) = inflated.marker_position(marker);
      EXPECT_LT((exact.col(0) - (plus - minus) / (2.0 * c.h)).norm(), 1e-4 * exact.norm());
    }
  }
}

TEST(Chamber, SyringeSensitivityAgreesWithCentralDifferences) {
  SolverOptions options;
  options.tolerance = 1e-9;
  Simulation inflated = simulation(cube(), ", command: syringe, syringe_volume_ml: 2, tube_volume_ml: 1", options);
  at_rest(inflated, 1.0);
  const Eigen::MatrixXd exact = inflated.marker_sensitivities();
  at_rest(inflated, 1.001);
  const Eigen::Vector3d plus = inflated.marker_position(0);
  at_rest(inflated, 0.999);
  const Eigen::Vector3d slope = (plus - inflated.marker_position(0)) / 0.002;
  EXPECT_LT((exact.col(0).head<3>() - slope).norm(), 1e-4 * slope.norm());
}

TEST(Chamber, ResultDoesNotDependOnTheTimeStep) {
  Simulation rest = simulation(cube(), "");
  const ActuatorReading expected = at_rest(rest, 1.3);
  for (const double time_step_s : {1.0 / 240.0, 1.0 / 60.0, 1.0 / 10.0}) {
    SolverOptions options;
    options.time_step_s = time_step_s;
    options.dynamic_tolerance = 1e-7;
    Simulation moving = simulation(cube(), ", flow_ml_s: 3", options);
    moving.set_command("air", 1.3);
    for (double t = 0.0; t < 2.0; t += time_step_s) ASSERT_TRUE(moving.step().converged);
    const ActuatorReading found = moving.actuator_state(0);
    EXPECT_NEAR(*found.volume_m3, *expected.volume_m3, 1e-6 * *expected.volume_m3) << time_step_s;
    EXPECT_NEAR(*found.gauge_pressure_pa, *expected.gauge_pressure_pa, 1e-4 * *expected.gauge_pressure_pa);
  }
}

// Small steps of either solver, and substeps of any number, follow the same motion.
TEST(Chamber, XpbdSwellsAsTheGlobalSolver) {
  const auto volume_m3 = [](SolverOptions::Method method, int substeps) {
    SolverOptions options;
    options.method = method;
    options.time_step_s = method == SolverOptions::Method::newton ? 0.02 / substeps : 0.02;
    options.substep_count = substeps;
    Simulation swelling = simulation(cube(), ", flow_ml_s: 10", options);
    swelling.set_command("air", 1.4);
    for (int i = 0; i < (method == SolverOptions::Method::newton ? 2 * substeps : 2); ++i) {
      const SolveReport report = swelling.step();
      EXPECT_TRUE(report.converged) << report.message;
    }
    EXPECT_LT(std::abs(*swelling.actuator_state(0).gas_residual), 0.02);
    return *swelling.actuator_state(0).volume_m3;
  };
  const double expected = volume_m3(SolverOptions::Method::newton, 100);
  EXPECT_GT(expected, 1.15e-6);
  for (const int substeps : {100, 200})
    EXPECT_NEAR(volume_m3(SolverOptions::Method::xpbd, substeps), expected, 0.01 * expected) << substeps;
}

DriveState after(double time_s, double command, const Actuator& actuator) {
  DriveState drive = actuator.rest_state();
  actuator.set_command(command, drive);
  actuator.advance(time_s, drive);
  return drive;
}

TEST(Chamber, PumpsNoFasterThanItsFlow) {
  const Body body = cube();
  const auto pumped = chamber(body, ", flow_ml_s: 0.5");
  EXPECT_NEAR(after(0.1, 2.0, *pumped).actuated_command, 1.05, 1e-12);
  const auto pushed = chamber(body, ", command: syringe, syringe_volume_ml: 2, flow_ml_s: 0.5");
  EXPECT_NEAR(after(0.1, 2.0, *pushed).actuated_command, 0.05, 1e-12);
}

TEST(Chamber, RegulatorFillsAtItsPumpsFlowAndThenHoldsThePressure) {
  SolverOptions options;
  options.time_step_s = 0.02;
  options.dynamic_tolerance = 1e-7;
  Simulation regulated = simulation(cube(), ", command: gauge_pressure, flow_ml_s: 0.5", options);
  regulated.set_command("air", 8000.0);
  const auto gas_j = [&] {
    const ActuatorReading reading = regulated.actuator_state(0);
    return (*reading.gauge_pressure_pa + kP0) * *reading.volume_m3;
  };
  double before = gas_j();
  EXPECT_NEAR(before, kP0 * 1e-6, 1e-9);
  int limited = 0;
  for (int i = 0; i < 80; ++i) {
    const SolveReport report = regulated.step();
    ASSERT_TRUE(report.converged) << i << " " << report.message;
    const double now = gas_j(), most = kP0 * 0.5e-6 * options.time_step_s;
    EXPECT_LE(std::abs(now - before), most * (1.0 + 1e-4)) << i;
    limited += now - before > 0.99 * most ? 1 : 0;
    before = now;
  }
  EXPECT_GT(limited, 5);
  EXPECT_NEAR(*regulated.actuator_state(0).gauge_pressure_pa, 8000.0, 1e-6);
  // And out again.
  regulated.set_command("air", 0.0);
  for (int i = 0; i < 80; ++i) ASSERT_TRUE(regulated.step().converged);
  EXPECT_NEAR(*regulated.actuator_state(0).gauge_pressure_pa, 0.0, 1e-6);
}

// Energy of body and gas, the atmosphere's included.
double total_energy_j(const Simulation& simulation, double beta) {
  const Body& body = simulation.body();
  std::vector<std::vector<int>> cliques;
  for (Eigen::Index e = 0; e < body.mesh().tets.cols(); ++e)
    cliques.emplace_back(body.mesh().tets.col(e).data(), body.mesh().tets.col(e).data() + body.mesh().tets.rows());
  const BlockMatrix matrix(body.mesh().node_count(), cliques);
  const Elements elements(body, matrix);
  const SimulationState& state = simulation.state();
  Eigen::Matrix3Xd unused = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  const ElementSums sums = elements.add_gradient(state.positions_m, Eigen::VectorXd::Zero(elements.count()), unused);
  const double volumetric = 0.5 * elements.sum_of_squares(elements.lambda_pa(), sums.volumetric_strain);
  const double kinetic = 0.5 * state.velocities_m_s.colwise().squaredNorm().dot(body.node_masses_kg());
  const ActuatorReading air = simulation.actuator_state(0);
  const double gas = kP0 * (*air.volume_m3 - *air.initial_volume_m3) -
                     beta * kP0 * *air.initial_volume_m3 * std::log(*air.volume_m3 / *air.initial_volume_m3);
  return sums.elastic_energy + volumetric + kinetic + gas;
}

struct Ringing {
  double drift = 0.0;  // largest change of the energy, over the energy of the start
  double gas = 0.0;    // largest change of the volume, over the volume
};

// A cube that nothing holds but its symmetry, set off as by a source in its middle, which is free of divergence.
Ringing ring(double time_step_s) {
  SolverOptions options;
  options.integrator = Integrator::bdf2;
  options.time_step_s = time_step_s;
  options.dynamic_tolerance = 1e-9;
  Body body(hollow_cube(), {264200.0, 0.49, 1070.0});
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d plane = Eigen::Vector3d::Ones() - (1.0 - 1e-6) * Eigen::Vector3d::Unit(axis);
    body.fix_nodes(-plane, plane, Eigen::Matrix<bool, 3, 1>(axis == 0, axis == 1, axis == 2));
  }
  Simulation cube = simulation(std::move(body), "", options);
  SimulationState state = cube.state();
  for (Eigen::Index i = 0; i < state.positions_m.cols(); ++i)
    state.velocities_m_s.col(i) = 2.5e-5 * state.positions_m.col(i) / std::pow(state.positions_m.col(i).norm(), 3);
  cube.set_state(state);
  const double start = total_energy_j(cube, 1.0);
  Ringing found;
  for (int i = 0; i * time_step_s < 2.5e-3; ++i) {
    EXPECT_TRUE(cube.step().converged);
    found.drift = std::max(found.drift, std::abs(total_energy_j(cube, 1.0) / start - 1.0));
    found.gas = std::max(found.gas, std::abs(*cube.actuator_state(0).volume_m3 / 1e-6 - 1.0));
  }
  return found;
}

TEST(Chamber, GasAndBodyKeepTheirEnergy) {
  const Ringing coarse = ring(3e-5), fine = ring(1.5e-5);
  EXPECT_GT(fine.gas, 0.05);
  EXPECT_LT(fine.drift, 0.02);
  EXPECT_LT(fine.drift, 0.4 * coarse.drift) << "coarse " << coarse.drift << ", fine " << fine.drift;
}

TEST(Chamber, ExplicitPressureIsThatOfTheVolumeBefore) {
  SolverOptions options;
  options.time_step_s = 1e-3;
  Simulation lagging = simulation(cube(), ", model: explicit", options);
  lagging.set_command("air", 1.2);
  for (int i = 0; i < 5; ++i) {
    const double before_m3 = *lagging.actuator_state(0).volume_m3;
    ASSERT_TRUE(lagging.step().converged);
    EXPECT_NEAR(*lagging.actuator_state(0).gauge_pressure_pa, 1.2 * kP0 * 1e-6 / before_m3 - kP0, 1e-6);
  }
  // At rest nothing lags: explicit and implicit are one.
  Simulation implicit = simulation(cube(), "");
  EXPECT_NEAR(*at_rest(lagging, 1.2).volume_m3, *at_rest(implicit, 1.2).volume_m3, 1e-11);
}

TEST(Chamber, ImplicitGasStandsWhereExplicitGasSwings) {
  const auto ups_and_downs = [](const std::string& model) {
    Simulation pumped = simulation(cube(), ", flow_ml_s: 1, model: " + model);
    pumped.set_command("air", 1.3);
    int turns = 0;
    double last = 0.0, last_change = 0.0;
    for (int i = 0; i < 40; ++i) {
      pumped.step();
      const double now = *pumped.actuator_state(0).volume_m3;
      if ((now - last) * last_change < 0.0 && std::abs(now - last) > 1e-9) ++turns;
      last_change = now - last;
      last = now;
    }
    return turns;
  };
  EXPECT_LE(ups_and_downs("implicit"), 1);
  EXPECT_GT(ups_and_downs("explicit"), 10);
}

TEST(Chamber, RepeatsToTheLastBitFromASavedState) {
  const std::string settings = ", command: gauge_pressure, flow_ml_s: 0.5";
  Simulation first = simulation(cube(), settings), second = simulation(cube(), settings);
  first.set_command("air", 8000.0);
  for (int i = 0; i < 4; ++i) first.step();
  second.set_state(first.state());
  for (int i = 0; i < 4; ++i) {
    first.step();
    second.step();
  }
  EXPECT_EQ((first.state().positions_m - second.state().positions_m).norm(), 0.0);
}

TEST(Chamber, RefusesCommandsOutOfRange) {
  const Body body = cube();
  const auto refuse = [&](const std::string& settings, double command) {
    const auto air = chamber(body, settings);
    DriveState drive = air->rest_state();
    air->set_command(command, drive);
  };
  try {
    refuse("", -0.5);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "command of actuator 'air': -0.5 is out of range [0.05, 5]");
  }
  EXPECT_THROW(refuse(", command: syringe, syringe_volume_ml: 2", 2.1), std::invalid_argument);
  EXPECT_THROW(refuse(", command: volume_offset", -1.0), std::invalid_argument);
  EXPECT_THROW(refuse(", command: gauge_pressure", -1.0), std::invalid_argument);
}

TEST(Chamber, RefusesBadSettings) {
  const Body body = cube();
  const auto refusal = [](const Body& of, const std::string& settings) -> std::string {
    try {
      Chamber().initialise(YamlNode::parse(settings, "chamber.yaml"), of, MeshLocator(of.mesh()));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  struct Case {
    std::string settings, words;
  };
  const Case cases[] = {
      {"{name: a, surface: hole}", "the mesh has no surface 'hole'; known: cavity"},
      {"{name: a}", "surface"},
      {"{name: a, surface: cavity, initial_pressure_pa: 0}", "initial_pressure_pa"},
      {"{name: a, surface: cavity, initial_pressure_pa: -5}", "initial_pressure_pa"},
      {"{name: a, surface: cavity, min_beta: -0.1}", "min_beta"},
      {"{name: a, surface: cavity, min_beta: 0}", "min_beta"},
      {"{name: a, surface: cavity, max_beta: 0.5}", "max_beta"},
      {"{name: a, surface: cavity, command: contraction}", "command"},
      {"{name: a, surface: cavity, command: syringe}", "syringe_volume_ml"},
      {"{name: a, surface: cavity, command: syringe, syringe_volume_ml: 0}", "syringe_volume_ml"},
      {"{name: a, surface: cavity, command: syringe, syringe_volume_ml: 2, tube_volume_ml: -1}", "tube_volume_ml"},
      {"{name: a, surface: cavity, command: beta, syringe_volume_ml: 0}", "syringe_volume_ml"},
      {"{name: a, surface: cavity, flow_ml_s: -1}", "flow_ml_s"},
      {"{name: a, surface: cavity, model: lagging}", "model"},
      {"{name: a, surface: cavity, command: gauge_pressure, model: explicit}", "must be implicit"},
      {"{name: a, surface: cavity, command: gauge_pressure, min_gauge_pressure_pa: -200000}", "min_gauge_pressure_pa"},
  };
  for (const Case& wrong : cases) {
    const std::string found = refusal(body, wrong.settings);
    EXPECT_NE(found.find(wrong.words), std::string::npos) << wrong.settings << ": " << found;
  }
}

TEST(Chamber, RefusesASurfaceThatEnclosesNothing) {
  // One flat side of the hollow, and the skin of the body.
  for (const bool skin : {false, true}) {
    TetMesh mesh = hollow_cube();
    for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
      double lowest = 1.0;
      for (int corner = 0; corner < 3; ++corner) lowest = std::min(lowest, mesh.nodes_m(2, mesh.faces(corner, face)));
      int& surface = mesh.face_surface[static_cast<std::size_t>(face)];
      surface = skin ? (surface == 0 ? -1 : 0) : (surface == 0 && lowest > 0.0049 ? 0 : -1);
    }
    const Body body(mesh, Material{});
    try {
      chamber(body, "");
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("surface: encloses a volume of "), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
