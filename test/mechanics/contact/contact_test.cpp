// SPDX-License-Identifier: BSD-3-Clause
// Bodies that press against rigid obstacles: references, closed forms, and balance of forces.
#include <cmath>

#include <gtest/gtest.h>

#include "compare_with_reference.h"
#include "contact_bodies.h"
#include "mechanics/round_mesh.h"
#include "reference_table.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

ReferenceRow reference_at(const std::string& table, const std::string& column, double value) {
  for (const ReferenceRow& row : read_reference(table))
    if (row.text("law") == "design" && row.number("nu") == 0.49 && std::abs(row.number(column) - value) < 1e-9)
      return row;
  throw std::runtime_error("no such row");
}

// A block between six plates, of which one moves in: every face has one pressure at all of its points, also where mesh
// and plates are turned. With eps the strain: lambda eps at the sides, (lambda + 2 mu) eps under the plate.
TEST(Contact, PressesEvenlyOnFlatFaces) {
  for (const double angle_rad : {0.0, M_PI / 6}) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle_rad, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    TetMesh mesh = box_mesh(Vector3d::Constant(-0.01), Vector3d::Constant(0.01), {3, 2, 3});
    mesh.nodes_m = turn * mesh.nodes_m;
    Body body(mesh, {264200.0, 0.3, 1070.0});
    std::vector<Obstacle> plates;
    for (int side = 0; side < 6; ++side) {
      const Vector3d out = (side % 2 ? -1.0 : 1.0) * turn.col(side / 2);
      plates.push_back({"plate " + std::to_string(side), Plane{0.01 * out, -out}, {}, 0.0});
    }
    plates[0].motion = {{0.0, kZero, kZero}, {1.0, -2e-5 * turn.col(0), kZero}};
    body.set_obstacles(plates);
    SolverOptions options;
    options.tolerance = 1e-10;
    Simulation simulation(std::move(body), {}, {}, options);
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const Eigen::VectorXd& all = simulation.state().contact.pressures_pa;
    const Material& material = simulation.body().material();
    for (int side = 0; side < 6; ++side) {
      const Eigen::VectorXd pressures = all.segment(side * all.size() / 6, all.size() / 6);
      const double most = pressures.maxCoeff(), least = (pressures.array() > 0.0).select(pressures, 1e9).minCoeff();
      EXPECT_LT(most / least - 1.0, 1e-8) << side;
      const double modulus_pa = material.lame_lambda_pa() + (side < 2 ? 2.0 * material.lame_mu_pa() : 0.0);
      EXPECT_NEAR(most, 1e-3 * modulus_pa, 0.02 * 1e-3 * modulus_pa) << side;
      const ContactReading reading = simulation.contacts()[static_cast<std::size_t>(side)];
      EXPECT_NEAR(reading.area_m2, 4e-4, 2e-3 * 4e-4);
      EXPECT_NEAR(reading.force_n.norm(), most * 4e-4, 1e-5 * most * 4e-4);
    }
    Vector3d sum_n = Vector3d::Zero();
    for (const ContactReading& reading : simulation.contacts()) sum_n += reading.force_n;
    EXPECT_LT(sum_n.norm(), 1e-6 * simulation.contacts()[0].force_n.norm());
  }
}

Simulation pressed_by_cylinder(const Eigen::Vector3i& cells, double depth_m) {
  Body body(box_mesh({-0.03, 0, 0}, {0.03, 0.03, 0.01}, cells), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, 1e-9, 1}, {true, true, true});
  hold_slab(body);
  body.set_obstacles({{"roll",
                       Cylinder{{0, 0.045, -1}, {0, 0.045, 1}, 0.015, 0.001},
                       {{0.0, kZero, kZero}, {1.0, {0, -depth_m, 0}, kZero}},
                       0.0}});
  return Simulation(std::move(body), {}, {}, SolverOptions{});
}

// R7. On 5 mm the foot of contact at 1 mm depth is two elements wide.
TEST(Contact, ACylinderIsPressedInByTheForceOfTheReference) {
  struct Case {
    Eigen::Vector3i cells;
    double depth_m, tolerance;
  };
  for (const Case& one :
       {Case{{12, 6, 2}, 0.001, 0.03}, Case{{12, 6, 2}, 0.006, 0.015}, Case{{24, 12, 2}, 0.004, 0.01}}) {
    const double force_n = reference_at("r7_cylinder_on_block_planestrain", "depth_m", one.depth_m).number("force_N");
    Simulation simulation = pressed_by_cylinder(one.cells, one.depth_m);
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const ContactReading contact = simulation.contacts()[0];
    expect_near_reference("R7, cylinder, " + rounded(1e3 * one.depth_m) + " mm deep | " +
                              rounded(60.0 / one.cells.x()) + " mm | force [N]",
                          -contact.force_n.y(), force_n, one.tolerance * force_n);
    EXPECT_LT(contact.largest_penetration_m, 2e-5);
    EXPECT_LT(std::abs(contact.force_n.x()), 2e-3 * force_n);
  }
}

// Of a round body by its planes of symmetry.
void hold_quarter(Body& body) {
  body.fix_nodes({-1, -1, -1}, {1e-9, 1, 1}, {true, false, false});
  body.fix_nodes({-1, -1, -1}, {1, 1, 1e-9}, {false, false, true});
}

// A quarter of the disc; the force of the whole.
double ball_in_disc_n(const Eigen::Vector2i& elements, double depth_m) {
  Body body(quarter_disc(0.03, 0.03, elements), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, 1e-9, 1}, {true, true, true});
  hold_quarter(body);
  body.set_obstacles(
      {{"ball", Sphere{{0, 0.045, 0}, 0.015}, {{0.0, kZero, kZero}, {1.0, {0, -depth_m, 0}, kZero}}, 0.0}});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  return -4.0 * simulation.contacts()[0].force_n.y();
}

void expect_ball_in_disc(const Eigen::Vector2i& elements, const std::vector<double>& depths_m, double tolerance) {
  for (const double depth_m : depths_m) {
    const double force_n = reference_at("r7_sphere_on_disc", "depth_m", depth_m).number("force_N");
    expect_near_reference("R7, ball in a disc, " + rounded(1e3 * depth_m) + " mm deep | " +
                              rounded(30.0 / elements.x()) + " mm | force [N]",
                          ball_in_disc_n(elements, depth_m), force_n, tolerance * force_n);
  }
}

// R7, elements of 5 mm and of half that.
TEST(Contact, ABallIsPressedIntoADiscByTheForceOfTheReference) { expect_ball_in_disc({6, 6}, {0.001, 0.004}, 0.02); }
TEST(Contact, OnAFineMeshABallIsPressedIntoADiscByTheForceOfTheReference) {
  expect_ball_in_disc({12, 12}, {0.002, 0.004}, 0.01);
  expect_ball_in_disc({12, 12}, {0.001}, 0.02);  // 1 % is asked; its foot is two elements wide
}

// R12, from the touch on, of a quarter of the ball. Its rebound comes out within the reference's spread, as all else.
TEST(Contact, ADroppedBallBouncesAsInTheReference) {
  const ReferenceRow drop = read_reference("r12_drop")[0];
  Body body(quarter_ball(0.015, 6), kSilicone);
  hold_quarter(body);
  body.set_gravity({0, -9.81, 0});
  body.set_obstacles({{"floor", Plane{{0, -0.015, 0}, {0, 1, 0}}, {}, 0.0}});
  SolverOptions options;
  options.time_step_s = 5e-5;
  options.integrator = Integrator::tr_bdf2;
  Simulation simulation(std::move(body), {}, {}, options);
  SimulationState start = simulation.state();
  start.velocities_m_s.row(1).array() = -drop.number("impact_speed_m_s");
  simulation.set_state(start);
  simulation.keep_energy_ledger();
  const EnergyLedger& ledger = *simulation.energy_ledger();
  const auto energy_j = [&] { return 4.0 * (ledger.kinetic_j + ledger.elastic_j + ledger.gravity_j); };
  const double start_j = energy_j();
  double lowest_m = 1.0, lowest_s = 0.0, top_m = 1.0, left_s = 0.0, peak_n = 0.0, most_j = 0.0;
  while (simulation.state().time_s < 0.01 - 1e-9) {
    ASSERT_TRUE(simulation.step().converged);
    const double time_s = simulation.state().time_s, middle = middle_m(simulation).y() + 0.015;
    const double floor_n = 4.0 * simulation.contacts()[0].force_n.y();
    if (middle < lowest_m) lowest_s = time_s;
    lowest_m = std::min(lowest_m, middle);
    top_m = std::min(top_m, simulation.state().positions_m.row(1).maxCoeff() + 0.015);
    if (floor_n > 0.0) left_s = time_s;
    peak_n = std::max(peak_n, floor_n);
    most_j = std::max(most_j, energy_j());
  }
  const auto expect = [&](double found, const std::string& column, const std::string& spread) {
    expect_near_reference("R12, dropped ball | 2.5 mm | " + column, found, drop.number(column), drop.number(spread));
  };
  expect(left_s, "contact_time_s", "unc_contact_time_s");
  expect(lowest_m, "cm_lowest_y_m", "unc_cm_lowest_m");
  expect(lowest_s, "t_cm_lowest_s", "unc_t_cm_lowest_s");
  expect(top_m, "top_lowest_y_m", "unc_top_lowest_m");
  expect(peak_n, "peak_force_N", "unc_peak_force_N");
  const Eigen::VectorXd& masses_kg = simulation.body().node_masses_kg();
  const double away_m_s = simulation.state().velocities_m_s.row(1).dot(masses_kg.transpose()) / masses_kg.sum();
  expect(away_m_s + 9.81 * (0.01 - drop.number("contact_time_s")), "rebound_cm_speed_m_s", "unc_rebound_m_s");
  EXPECT_LE(most_j, start_j * (1.0 + 1e-9));
  EXPECT_NEAR(ledger.closure_error_j, 0.0, 1e-3 * ledger.turned_over_j);
}

TEST(Contact, AnEquilibriumThatIsAskedForAgainStaysToTheLastBit) {
  Simulation simulation = pressed_by_cylinder({8, 4, 1}, 0.004);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const SimulationState before = simulation.state();
  const SolveReport again = simulation.solve_equilibrium();
  EXPECT_EQ(again.iterations, 0);
  EXPECT_TRUE(simulation.state().positions_m == before.positions_m);
}

// What an obstacle under a bar that is held at x = 0 does: its force, and how the middle of the other end moves.
struct Bent {
  double tip_uy_m;
  Vector3d force_n;
};

Bent bent(Body body, double length_m) {
  body.fix_nodes({-1, -1, -1}, {1e-9, 1, 1}, {true, true, true});
  hold_slab(body);
  std::vector<Marker> markers;
  markers.emplace_back("tip", Vector3d(length_m, 0, 0.005), body.mesh(), MeshLocator(body.mesh()));
  Simulation simulation(std::move(body), {}, std::move(markers), SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  return {simulation.marker_position(0).y(), simulation.contacts()[0].force_n};
}

void expect_bar_on_post(const Eigen::Vector3i& cells, const std::vector<double>& gravities, double tolerance) {
  for (const double gravity : gravities) {
    const ReferenceRow row = reference_at("r8_beam_on_post_planestrain", "g_m_s2", gravity);
    Body body(box_mesh({0, -0.01, 0}, {0.1, 0.01, 0.01}, cells), kSilicone);
    body.set_gravity({0, -gravity, 0});
    body.set_obstacles({{"post", Cylinder{{0.06, -0.025, -1}, {0.06, -0.025, 1}, 0.01, 0.001}, {}, 0.0}});
    const Bent bar = bent(std::move(body), 0.1);
    const std::string what =
        "R8, bar on a post, " + rounded(gravity / 9.81) + " g | " + rounded(100.0 / cells.x()) + " mm | ";
    expect_near_reference(what + "tip [m]", bar.tip_uy_m, row.number("tip_uy_m"), 0.006 * 0.0105);
    const double force_n = row.number("contact_Fy_N");
    expect_near_reference(what + "force [N]", bar.force_n.y(), force_n, tolerance * force_n);
  }
}

// R8, elements of 5 mm and of half that.
TEST(Contact, ABarSagsOntoAPostAsInTheReference) { expect_bar_on_post({20, 4, 2}, {9.81, 19.62}, 0.02); }
TEST(Contact, OnAFineMeshABarSagsOntoAPostAsInTheReference) {
  expect_bar_on_post({40, 8, 4}, {19.62}, 0.01);
  expect_bar_on_post({40, 8, 4}, {9.81}, 0.012);  // 1 % is asked; it touches along half a millimetre
}

void expect_finger_on_roll(const Eigen::Vector3i& cells, const std::vector<double>& pressures_pa, double tolerance) {
  for (const double pressure_pa : pressures_pa) {
    const ReferenceRow row = reference_at("r11_finger_on_cylinder_planestrain", "pressure_Pa", pressure_pa);
    Body body(box_mesh({0, -0.005, 0}, {0.08, 0.005, 0.01}, cells), kSilicone);
    body.add_traction({-1, 0.005 - 1e-9, -1}, {1, 1, 1}, {0, -pressure_pa, 0});
    body.set_obstacles({{"roll", Cylinder{{0.04, -0.027, -1}, {0.04, -0.027, 1}, 0.02, 0.001}, {}, 0.0}});
    const Bent finger = bent(std::move(body), 0.08);
    const double force_n = row.number("contact_Fy_N");
    const std::string what =
        "R11, finger on a cylinder, " + rounded(pressure_pa) + " Pa | " + rounded(80.0 / cells.x()) + " mm | ";
    const double tip_m = row.number("tip_uy_m");
    expect_near_reference(what + "tip [m]", finger.tip_uy_m, tip_m, -tolerance * tip_m);
    expect_near_reference(what + "force [N]", finger.force_n.y(), force_n, tolerance * force_n);
    EXPECT_NEAR(finger.force_n.x(), row.number("contact_Fx_N"), tolerance * force_n) << pressure_pa;
  }
}

// R11, elements of 2.5 mm and of half that.
TEST(Contact, AFingerIsBentOverACylinderAsInTheReference) { expect_finger_on_roll({32, 4, 2}, {300.0, 1200.0}, 0.02); }
TEST(Contact, OnAFineMeshAFingerIsBentOverACylinderAsInTheReference) {
  expect_finger_on_roll({64, 8, 2}, {150.0, 300.0, 600.0, 1200.0}, 0.01);
}

// Hertz's force 4/3 E / (1 - nu^2) sqrt(R) d^1.5 for a ball on a half space, and what a layer of height h adds that is
// bonded to its bed (Dimitriadis et al. 2002, to second order).
double hertz_n(double radius_m, double depth_m, double height_m) {
  const double nu = 0.3, thin = std::sqrt(radius_m * depth_m) / height_m;
  const double alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1.0 - nu);
  return 4.0 / 3.0 * 264200.0 / (1.0 - nu * nu) * std::sqrt(radius_m) * std::pow(depth_m, 1.5) *
         (1.0 - 2.0 * alpha / M_PI * thin + 4.0 * alpha * alpha / (M_PI * M_PI) * thin * thin);
}

// A quarter of a block, with elements that are finer towards the ball.
void expect_hertz(const Eigen::Vector3i& cells, double tolerance) {
  constexpr double kSide = 0.06, kRadius = 0.02;
  for (const double depth_m : {0.0005, 0.001}) {
    TetMesh mesh = box_mesh({0, -kSide, 0}, {kSide, 0, kSide}, cells, false);
    mesh.nodes_m = kSide * (mesh.nodes_m / kSide).cwiseAbs2();
    mesh.nodes_m.row(1) *= -1.0;
    Body body(make_quadratic(mesh), {264200.0, 0.3, 1070.0});
    body.fix_nodes({-1, -1, -1}, {1, -kSide + 1e-9, 1}, {true, true, true});
    body.fix_nodes({-1, -1, -1}, {1e-9, 1, 1}, {true, false, false});
    body.fix_nodes({-1, -1, -1}, {1, 1, 1e-9}, {false, false, true});
    body.set_obstacles(
        {{"ball", Sphere{{0, kRadius, 0}, kRadius}, {{0.0, kZero, kZero}, {1.0, {0, -depth_m, 0}, kZero}}, 0.0}});
    Simulation simulation(std::move(body), {}, {}, SolverOptions{});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const double expected_n = hertz_n(kRadius, depth_m, kSide);
    expect_near_reference("Hertz, ball on a layer, " + rounded(1e3 * depth_m) + " mm deep | " + rounded(cells.x()) +
                              " graded cells | force [N]",
                          -4.0 * simulation.contacts()[0].force_n.y(), expected_n, tolerance * expected_n);
  }
}

TEST(Contact, ABallIsPressedInAsHertzSays) { expect_hertz({8, 6, 8}, 0.03); }
TEST(Contact, OnAFineMeshABallIsPressedInAsHertzSays) { expect_hertz({12, 8, 12}, 0.01); }

TEST(Contact, AFallingBlockComesToLieWithItsWeightOnTheFloor) {
  for (const double time_step_s : {0.001, 0.016, 0.1}) {
    SolverOptions options;
    options.time_step_s = time_step_s;
    Body body = loose_block();
    body.set_obstacles({{"floor", Plane{{0, -0.005, 0}, {0, 1, 0}}, {}, 0.3}});
    const double weight_n = 9.81 * body.node_masses_kg().sum();
    body.set_gravity({0, -9.81, 0});
    Simulation simulation(std::move(body), {}, {}, options);
    for (double t = 0.0; t < 0.5; t += time_step_s) {
      ASSERT_TRUE(simulation.step().converged);
    }
    EXPECT_NEAR(simulation.contacts()[0].force_n.y(), weight_n, 1e-3 * weight_n) << time_step_s;
    // Sunk by rho g H^2 / (3 E) at its middle, where its foot may spread.
    EXPECT_NEAR(middle_m(simulation).y(), -0.005 + 0.01 - 0.0054e-3, 2e-6) << time_step_s;
  }
}

// A coarse bar that sags onto a post, which then rises and draws it along.
TEST(Contact, WithXpbdABarRestsOnAPostAsWithTheGlobalSolver) {
  for (const double friction : {0.0, 0.5}) {
    const auto rest = [&](const SolverOptions& options) {
      Body body(box_mesh({0, -0.01, 0}, {0.1, 0.01, 0.01}, {8, 2, 1}), kSilicone);
      body.fix_nodes({-1, -1, -1}, {1e-9, 1, 1}, {true, true, true});
      body.set_gravity({0, -9.81, 0});
      const std::vector<ObstaclePose> motion = {{0.0, kZero, kZero}, {1.0, {-0.002, 0.006, 0}, kZero}};
      body.set_obstacles({{"post", Cylinder{{0.06, -0.022, -1}, {0.06, -0.022, 1}, 0.01, 0.001}, motion, friction}});
      Simulation simulation(std::move(body), {}, {}, options);
      const SolveReport report = simulation.solve_equilibrium();
      EXPECT_TRUE(report.converged) << report.message;
      return simulation;
    };
    const Simulation newton = rest({}), local = rest(xpbd(30));
    const Eigen::Matrix3Xd &expected_m = newton.state().positions_m, &found_m = local.state().positions_m;
    const double way_m = (expected_m - newton.body().mesh().nodes_m).colwise().norm().maxCoeff();
    EXPECT_GT(way_m, 1e-3);
    EXPECT_LT((found_m - expected_m).colwise().norm().maxCoeff(), 0.01 * way_m) << friction;
    const Vector3d expected_n = newton.contacts()[0].force_n;
    EXPECT_LT((local.contacts()[0].force_n - expected_n).norm(), 0.01 * expected_n.norm()) << friction;
  }
}

TEST(Contact, WithXpbdAFallingBlockComesToLieWithItsWeightOnTheFloor) {
  Body body = loose_block({3, 2, 3});
  body.set_obstacles({{"floor", Plane{{0, -0.005, 0}, {0, 1, 0}}, {}, 0.3}});
  body.set_viscosity({10.0, 0.002, 0.0, 1.0});
  const double weight_n = 9.81 * body.node_masses_kg().sum();
  body.set_gravity({0, -9.81, 0});
  Simulation simulation(std::move(body), {}, {}, xpbd(200, 0.01));
  for (int i = 0; i < 60; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message;
  }
  EXPECT_NEAR(simulation.contacts()[0].force_n.y(), weight_n, 0.01 * weight_n);
  EXPECT_NEAR(middle_m(simulation).y(), -0.005 + 0.01 - 0.0054e-3, 2e-6);
}

TEST(Contact, WithXpbdARestoredStateGoesOnAsIfItHadNeverStopped) {
  const auto falling = [] {
    Body body = loose_block({2, 1, 2});
    body.set_obstacles({{"floor", Plane{{0, -0.003, 0}, {0.1, 1, 0}}, {}, 0.1}});
    body.set_gravity({0, -9.81, 0});
    return Simulation(std::move(body), {}, {}, xpbd(60, 0.01));
  };
  Simulation one = falling(), other = falling();
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(one.step().converged);
  other.set_state(one.state());
  for (int i = 0; i < 4; ++i) {
    one.step();
    other.step();
  }
  EXPECT_GT(one.contacts()[0].normal_force_n, 0.0);
  EXPECT_TRUE(one.state() == other.state());
}

// Faces that touch may have held nodes: what presses there is held too.
TEST(Contact, HoldsCarryWhatGravityAndObstaclesLeave) {
  Body body(box_mesh({-0.02, 0, -0.01}, {0.02, 0.02, 0.01}, {4, 2, 2}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {-0.0199, 1, 1}, {true, true, true});
  body.set_gravity({1, -9.81, 0.5});
  body.set_obstacles(
      {{"plate", Plane{{0, 0, 0}, {0, 1, 0}}, {{0.0, kZero, kZero}, {1.0, {0, 0.0005, 0}, kZero}}, 0.3}});
  const Vector3d loads_n = body.external_forces_n().rowwise().sum();
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  const Vector3d pressed_n = simulation.contacts()[0].force_n, held_n = simulation.reaction_forces_n().rowwise().sum();
  EXPECT_GT(pressed_n.y(), 10 * loads_n.norm());
  EXPECT_LT((held_n + loads_n + pressed_n).norm(), 1e-5 * pressed_n.norm());
}

// Half a metre a second into a block: it is pushed aside and not passed through.
TEST(Contact, AMovingObstaclePushesTheBody) {
  SolverOptions options;
  options.time_step_s = 0.005;
  Body body(box_mesh({-0.01, -0.1, -0.01}, {0.01, 0, 0.01}, {2, 8, 2}), kSilicone);
  body.fix_nodes({-1, -1e-9, -1}, {1, 1, 1}, {true, true, true});
  body.set_obstacles(
      {{"ball", Sphere{{0.03, -0.09, 0}, 0.015}, {{0.0, kZero, kZero}, {0.1, {-0.05, 0, 0}, kZero}}, 0.0}});
  Simulation simulation(std::move(body), {}, {}, options);
  double deepest_m = 0.0;
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(simulation.step().converged);
    deepest_m = std::max(deepest_m, simulation.contacts()[0].largest_penetration_m);
  }
  EXPECT_LT(deepest_m, 1e-4);
  EXPECT_GT(simulation.contacts()[0].area_m2, 0.0);
  EXPECT_LT(simulation.state().positions_m.row(0).minCoeff(), -0.04);
}

// Three metres a second: after one step of 1/60 s it would stand behind the post.
TEST(Contact, AFastObstacleDoesNotPassThroughTheBody) {
  for (const bool free : {false, true}) {
    Body body(box_mesh({-0.01, -0.1, -0.01}, {0.01, 0, 0.01}, {2, 8, 2}), kSilicone);
    body.fix_nodes({-1, -1e-9, -1}, {1, 1, 1}, {true, true, true});
    Obstacle ball{"ball", Sphere{{0.06, -0.08, 0}, 0.012}, {}, 0.0};
    if (free) {
      ball.mass_kg = 0.02;
      ball.velocity_m_s = {-3, 0, 0};
    } else {
      ball.motion = {{0.0, kZero, kZero}, {0.025, {-0.075, 0, 0}, kZero}};
    }
    body.set_obstacles({ball});
    Simulation simulation(std::move(body), {}, {}, SolverOptions{});
    for (int i = 0; i < 3; ++i) {
      const SolveReport report = simulation.step();
      ASSERT_TRUE(report.converged) << report.message;
      EXPECT_EQ(report.inverted_elements, 0);
      EXPECT_LT(simulation.contacts()[0].largest_penetration_m, 1e-4);
      const double ball_m = 0.06 + simulation.obstacle_poses()[0].translation().x();
      EXPECT_LT(simulation.state().positions_m.row(0).minCoeff(), ball_m - 0.012) << free << " " << i;
    }
  }
}

TEST(Contact, AnObstacleInsideTheBodyIsRefusedWithDepthAndPlace) {
  const auto message = [](const Obstacle& obstacle) -> std::string {
    Body body = loose_block();
    try {
      body.set_obstacles({obstacle});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({"floor", Plane{{0, 0, 0}, {0, 1, 0}}, {}, 0.0}), "");
  const std::string deep = message({"floor", Plane{{0, 0.003, 0}, {0, 1, 0}}, {}, 0.0});
  EXPECT_NE(deep.find("obstacle 'floor' is 0.003 m inside the body at the start, at ("), std::string::npos) << deep;
  EXPECT_NE(message({"pea", Sphere{{0.001, 0.011, 0.002}, 0.0005}, {}, 0.0}).find("'pea': its middle"),
            std::string::npos);
  // It may start elsewhere.
  EXPECT_EQ(
      message({"floor", Plane{{0, 0.003, 0}, {0, 1, 0}}, {{0.0, {0, -0.01, 0}, kZero}, {1.0, kZero, kZero}}, 0.0}), "");
}

// Presses 1 mm of a ball into a block of 20 MPa, beside which another body may stand that touches nothing.
double ball_on_stiff_block_n(bool beside_soft) {
  TetMesh mesh = box_mesh({-0.02, 0, -0.02}, {0.02, 0.02, 0.02}, {4, 2, 4});
  std::vector<Material> materials{{20e6, 0.45, 1070.0}};
  if (beside_soft) {
    add_body("soft", box_mesh({0.1, 0, -0.02}, {0.14, 0.02, 0.02}, {2, 1, 2}), mesh);
    materials.push_back({10e3, 0.45, 1070.0});
  }
  Body body(std::move(mesh), materials);
  body.fix_nodes({-1, -1, -1}, {1, 1e-9, 1}, {true, true, true});
  body.set_obstacles({{"ball", Sphere{{0, 0.05, 0}, 0.03}, {{0.0, kZero, kZero}, {1.0, {0, -0.001, 0}, kZero}}, 0.0}});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  return simulation.contacts()[0].normal_force_n;
}

TEST(Contact, IsAsStiffAsTheSkinThatTouchesWhateverStandsElsewhere) {
  const double alone_n = ball_on_stiff_block_n(false);
  EXPECT_NEAR(ball_on_stiff_block_n(true), alone_n, 1e-4 * alone_n);
}

// An equilibrium is that of the motion's end, and there the obstacle stays.
TEST(Contact, AnObstacleDoesNotJumpBackAfterAnEquilibrium) {
  Body body(box_mesh({-0.02, -0.02, -0.01}, {0.02, 0, 0.01}, {4, 2, 2}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, -0.02 + 1e-9, 1}, {true, true, true});
  body.set_obstacles(
      {{"plate", Plane{{0, 0, 0}, {0, -1, 0}}, {{0.0, kZero, kZero}, {1.0, {0, -0.001, 0}, kZero}}, 0.0}});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const double pressed_n = simulation.contacts()[0].normal_force_n;
  ASSERT_GT(pressed_n, 1.0);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(simulation.step().converged);
    EXPECT_NEAR(simulation.contacts()[0].normal_force_n, pressed_n, 1e-3 * pressed_n);
  }
  EXPECT_NEAR(simulation.obstacle_poses()[0].translation().y(), -0.001, 1e-12);
}

TEST(Contact, ASceneWithFarObstaclesMovesAsOneWithoutAny) {
  const auto run = [](bool with) {
    Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5, 1, 1}), kSilicone);
    body.fix_nodes({-1, -1, -1}, {1e-9, 1, 1}, {true, true, true});
    body.set_gravity({0, -9.81, 0});
    if (with) body.set_obstacles({{"far", Sphere{{0, 1, 0}, 0.1}, {}, 0.0}});
    Simulation simulation(std::move(body), {}, {}, SolverOptions{});
    for (int i = 0; i < 5; ++i) simulation.step();
    return simulation.state().positions_m;
  };
  EXPECT_LT((run(true) - run(false)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Contact, ARestoredStateGoesOnAsIfItHadNeverStopped) {
  SolverOptions options;
  options.time_step_s = 0.01;
  const auto made = [&] {
    Body body = loose_block();
    body.set_gravity({3, -9.81, 0});
    body.set_obstacles({{"floor", Plane{{0, -0.001, 0}, {0, 1, 0}}, {}, 0.2}});
    return Simulation(std::move(body), {}, {}, options);
  };
  Simulation one = made();
  for (int i = 0; i < 7; ++i) one.step();
  Simulation other = made();
  other.set_state(one.state());
  for (int i = 0; i < 5; ++i) {
    one.step();
    other.step();
  }
  EXPECT_TRUE(one.state() == other.state());
  SimulationState wrong = one.state();
  wrong.contact.pressures_pa.resize(3);
  EXPECT_THROW(other.set_state(wrong), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
