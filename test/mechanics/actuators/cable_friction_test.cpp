// SPDX-License-Identifier: BSD-3-Clause
// A cable with friction: capstan law, stick and slip, and what it remembers.
#include <cmath>
#include <iomanip>

#include <gtest/gtest.h>

#include "compare_with_reference.h"
#include "reference_table.h"
#include "test_bar.h"

namespace soft_robot_lab {
namespace {

// A quarter of a ring, radius 50 mm, in the x-y plane, held all over; the cable runs along its middle, straight for a
// step before and after.
Simulation ring(double friction_coefficient, int points, const SolverOptions& options = {}) {
  TetMesh mesh = box_mesh({0, -0.005, -0.005}, {0.1, 0.005, 0.005}, {12, 2, 2});
  const auto bend =
      [](const Eigen::Vector3d& p) -> Eigen::Vector3d {  // the middle three fifths of the bar turn by 90 degrees
    const double angle = std::clamp((p.x() - 0.02) / 0.06, 0.0, 1.0) * M_PI / 2, radius = 0.06 / (M_PI / 2);
    const Eigen::Vector3d tangent(std::cos(angle), std::sin(angle), 0), normal(-std::sin(angle), std::cos(angle), 0);
    const double straight = p.x() < 0.02 ? p.x() - 0.02 : std::max(0.0, p.x() - 0.08);
    return Eigen::Vector3d(radius * std::sin(angle), radius * (1 - std::cos(angle)), p.z()) + straight * tangent +
           p.y() * normal;
  };
  for (Eigen::Index i = 0; i < mesh.nodes_m.cols(); ++i) mesh.nodes_m.col(i) = bend(mesh.nodes_m.col(i));
  Body body(std::move(mesh), Material{});
  body.fix_nodes({-1, -1, -1}, {1, 1, 1}, {true, true, true});
  const MeshLocator locator(body.mesh());
  std::ostringstream settings;
  settings << "{name: cable, model: friction, friction_coefficient: " << friction_coefficient
           << ", compliance_m_n: 1.0e-4, sheath_radius_m: 0.002, points_m: [";
  for (int i = 0; i <= points; ++i) {
    const Eigen::Vector3d p = bend({0.1 * i / points, 0, 0});
    settings << (i > 0 ? ", [" : "[") << p.x() << ", " << p.y() << ", " << p.z() << "]";
  }
  settings << "]}";
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators.back()->initialise(YamlNode::parse(settings.str(), "ring"), body, locator);
  return Simulation(std::move(body), std::move(actuators), {}, options);
}

// The drive's tension of the ring's cable, by hand. Held silicone lets it only stretch, by compliance times its mean
// tension, which falls along the arc only: T0 over the first fifth, T0 exp(-mu angle) over the middle three, and what
// is left over the last.
double drive_tension_n(double mu, double stretch_m) {
  const double turn = mu * M_PI / 2, compliance_m_n = 1.0e-4;
  const double over_the_arc = turn > 0.0 ? (1.0 - std::exp(-turn)) / turn : 1.0;
  return stretch_m / compliance_m_n / (0.2 + 0.6 * over_the_arc + 0.2 * std::exp(-turn));
}

TEST(CableFriction, FollowsTheCapstanFormulaAroundABentBody) {
  for (const double mu : {0.0, 0.1, 0.5}) {
    Simulation simulation = ring(mu, 20);
    simulation.set_command("cable", 0.99);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    const ActuatorReading pulled = simulation.actuator_state(0);
    EXPECT_NEAR(pulled.span_tensions_n.front() / pulled.span_tensions_n.back(), std::exp(mu * M_PI / 2),
                0.01 * std::exp(mu * M_PI / 2));
    const double drive_n = drive_tension_n(mu, 0.01 * *pulled.rest_length_m);
    EXPECT_NEAR(*pulled.tension_n, drive_n, 0.01 * drive_n);

    simulation.set_command("cable", 0.9902);  // a little back: the drive's end slips first, the far end sticks
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    const ActuatorReading eased = simulation.actuator_state(0);
    EXPECT_LT(*eased.tension_n, *pulled.tension_n);
    if (mu > 0.0) {
      EXPECT_NEAR(eased.span_tensions_n.back(), pulled.span_tensions_n.back(), 1e-6);
    }
    simulation.set_command("cable", 0.9985);  // far back: all has slipped the other way
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    const ActuatorReading back = simulation.actuator_state(0);
    EXPECT_NEAR(back.span_tensions_n.back() / back.span_tensions_n.front(), std::exp(mu * M_PI / 2),
                0.01 * std::exp(mu * M_PI / 2));
  }
}

Simulation held_cube(const Eigen::Vector3d& middle_m, const std::string& cable, std::vector<Obstacle> obstacles = {}) {
  Body body(
      box_mesh(middle_m - Eigen::Vector3d::Constant(0.005), middle_m + Eigen::Vector3d::Constant(0.005), {1, 1, 1}),
      Material{});
  body.fix_nodes({-1, -1, -1}, {1, 1, 1}, {true, true, true});
  body.set_obstacles(std::move(obstacles));
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators.back()->initialise(YamlNode::parse(cable, "post"), body, locator);
  return Simulation(std::move(body), std::move(actuators), {}, SolverOptions{});
}

// R13. The cable finds its way around the post itself.
TEST(CableFriction, FindsItsWayAroundAPostAsInTheReference) {
  for (const ReferenceRow& row : read_reference("r13_capstan")) {
    const auto at = [&](const std::string& name) {
      return Eigen::Vector3d(row.number(name + "x"), row.number(name + "y"), row.number(name + "z"));
    };
    const Eigen::Vector3d anchor_m = at("A"), drive_m = at("B");
    const double radius_m = row.number("R_m"), pull_n = row.number("T_B_N");
    std::ostringstream settings;
    settings << std::setprecision(15) << "{name: cable, model: friction, friction_coefficient: " << row.number("mu")
             << ", command: tension_n, drive_points_m: [[" << drive_m.x() << ", " << drive_m.y() << ", " << drive_m.z()
             << "]], points_m: [[" << anchor_m.x() << ", " << anchor_m.y() << ", " << anchor_m.z()
             << "]], around: [{obstacle: post, by_m: [0.01, 0.03, 0.01]}]}";
    Simulation simulation =
        held_cube(anchor_m, settings.str(), {{"post", Cylinder{{0, 0, -1}, {0, 0, 1}, radius_m, 0.001}, {}, 0.0}});
    simulation.set_command("cable", pull_n);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    const ActuatorReading cable = simulation.actuator_state(0);
    const double far_n = row.number("T_A_N"), length_m = row.number("length_m");
    const std::string what = "R13, cable around a post by " + rounded(row.number("turning_rad") * 180.0 / M_PI) +
                             " degrees | its own joints | ";
    expect_near_reference(what + "length [m]", *cable.length_m, length_m, 2e-4 * length_m);
    EXPECT_NEAR(cable.span_tensions_n.front(), pull_n, 1e-9);
    expect_near_reference(what + "far tension [N]", cable.span_tensions_n.back(), far_n, 1e-3 * far_n);
    const std::vector<Eigen::Vector3d>& path_m = cable.path_m;
    const std::size_t last = path_m.size() - 1;
    const Eigen::Vector3d drawn_n = pull_n * (path_m[0] - path_m[1]).normalized(),
                          held_n = cable.span_tensions_n.back() * (path_m[last] - path_m[last - 1]).normalized();
    const Eigen::Vector3d force_n(row.number("Fx_N"), row.number("Fy_N"), row.number("Fz_N"));
    EXPECT_LT((drawn_n + held_n - force_n).norm(), 2e-3 * force_n.norm());
    EXPECT_NEAR(Eigen::Vector3d(path_m[0].cross(drawn_n) + path_m[last].cross(held_n)).z(), row.number("torque_z_Nm"),
                -5e-3 * row.number("torque_z_Nm"));
  }
}

// R13. The post is a row of pulleys.
TEST(CableFriction, LeadsAroundAPostOfPulleysAsInTheReference) {
  constexpr int kPulleys = 24;
  for (const ReferenceRow& row : read_reference("r13_capstan")) {
    const auto at = [&](const std::string& name) {
      return Eigen::Vector3d(row.number(name + "x"), row.number(name + "y"), row.number(name + "z"));
    };
    const Eigen::Vector3d anchor_m = at("A"), drive_m = at("B"), from_m = at("tangentB_"), to_m = at("tangentA_");
    const double first = std::atan2(from_m.y(), from_m.x()), last = std::atan2(to_m.y(), to_m.x());
    std::ostringstream settings;
    settings << std::setprecision(15) << "{name: cable, model: friction, friction_coefficient: " << row.number("mu")
             << ", command: tension_n, drive_points_m: [[" << drive_m.x() << ", " << drive_m.y() << ", " << drive_m.z()
             << "]";
    for (int i = 0; i < kPulleys; ++i) {
      const double share = i / (kPulleys - 1.0), angle = first + share * (last - first), r = row.number("R_m");
      settings << ", [" << r * std::cos(angle) << ", " << r * std::sin(angle) << ", "
               << from_m.z() + share * (to_m.z() - from_m.z()) << "]";
    }
    settings << "], points_m: [[" << anchor_m.x() << ", " << anchor_m.y() << ", " << anchor_m.z() << "]]}";
    Simulation simulation = held_cube(anchor_m, settings.str());
    const double pull_n = row.number("T_B_N");
    simulation.set_command("cable", pull_n);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    const ActuatorReading cable = simulation.actuator_state(0);
    EXPECT_NEAR(*cable.length_m, row.number("length_m"), 1e-3 * row.number("length_m"));
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero(), torque_nm = Eigen::Vector3d::Zero();
    for (std::size_t i = 1; i <= kPulleys; ++i)
      for (const std::size_t other : {i - 1, i + 1}) {
        const Eigen::Vector3d pulls_n =
            cable.span_tensions_n[std::min(i, other)] * (cable.path_m[other] - cable.path_m[i]).normalized();
        force_n += pulls_n;
        torque_nm += cable.path_m[i].cross(pulls_n);
      }
    EXPECT_NEAR(cable.span_tensions_n.back(), row.number("T_A_N"), 0.01 * row.number("T_A_N"));
    EXPECT_LT((force_n - Eigen::Vector3d(row.number("Fx_N"), row.number("Fy_N"), row.number("Fz_N"))).norm(),
              0.01 * force_n.norm());
    EXPECT_NEAR(torque_nm.z(), row.number("torque_z_Nm"), -0.01 * row.number("torque_z_Nm"));
  }
}

// The work that one pull and release takes from the drive.
double loop_area_j(double friction_coefficient) {
  Simulation simulation = hanging_bar("model: friction, friction_coefficient: " + std::to_string(friction_coefficient));
  double area = 0.0, last_length = 0.0, last_tension = 0.0;
  for (int i = 0; i <= 24; ++i) {
    const double pull = i < 8 ? i / 8.0 : i < 16 ? 1.0 - (i - 8) / 8.0 : (i - 16) / 8.0;
    simulation.set_command("cable", 1.0 - 0.1 * pull);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    const ActuatorReading at = simulation.actuator_state(0);
    const double length = at.actuated_command * *at.rest_length_m;
    if (i > 8) area += 0.5 * (last_tension + *at.tension_n) * (last_length - length);
    last_length = length;
    last_tension = *at.tension_n;
  }
  return area;
}

TEST(CableFriction, LoopOfPullingAndReleasingClosesWithoutFriction) {
  const double none = loop_area_j(0.0), little = loop_area_j(0.02), more = loop_area_j(0.2);
  EXPECT_NEAR(none, 0.0, 1e-3 * little);
  EXPECT_GT(little, 1e-5);
  EXPECT_NEAR(more / little, 10.0, 2.0);
}

TEST(CableFriction, WithoutACoefficientIsTheSlidingCable) {
  Simulation sliding = hanging_bar("compliance_m_n: 1.0e-4"),
             friction = hanging_bar("compliance_m_n: 1.0e-4, model: friction, friction_coefficient: 0");
  for (Simulation* simulation : {&sliding, &friction}) {
    simulation->set_command("cable", 0.85);
    ASSERT_TRUE(simulation->solve_equilibrium().converged);
  }
  EXPECT_LT((sliding.marker_position(0) - friction.marker_position(0)).norm(), 1e-7);
  EXPECT_NEAR(*sliding.actuator_state(0).tension_n, *friction.actuator_state(0).tension_n, 1e-5);
}

TEST(CableFriction, RemembersWhereItComesFrom) {
  Simulation simulation = hanging_bar("model: friction, friction_coefficient: 0.4");
  const auto tip_at = [&](double command) {
    simulation.set_command("cable", command);
    EXPECT_TRUE(simulation.solve_equilibrium().converged);
    return simulation.marker_position(0).x();
  };
  const double pulled = tip_at(0.95);
  tip_at(0.85);
  EXPECT_GT(std::abs(tip_at(0.95) - pulled), 1e-4);
}

// A tangle is laid out from the rest shape; there a cable that slipped before would hold lengths of another shape.
TEST(CableFriction, StartsFromTheRestShapeWithItsLengths) {
  const std::string cable = "model: friction, friction_coefficient: 0.4";
  Simulation fresh = hanging_bar(cable), tangled = hanging_bar(cable);
  for (const double command : {0.8, 0.95}) {
    tangled.set_command("cable", command);
    ASSERT_TRUE(tangled.solve_equilibrium().converged);
  }
  SimulationState state = tangled.state();
  for (int node = 0; node < static_cast<int>(state.positions_m.cols()); ++node)
    if (!tangled.body().fixed().col(node).any()) state.positions_m.col(node) = Eigen::Vector3d(0, -0.05, 0);
  tangled.set_state(state);
  fresh.set_command("cable", 0.95);
  ASSERT_TRUE(fresh.solve_equilibrium().converged);
  ASSERT_TRUE(tangled.solve_equilibrium().converged);
  EXPECT_LT((tangled.marker_position(0) - fresh.marker_position(0)).norm(), 1e-8);
}

TEST(CableFriction, RestoredStateGoesOnToTheLastBit) {
  Simulation simulation = hanging_bar(
      "model: friction, friction_coefficient: 0.4, pull_speed_m_s: 0.02, "
      "pull_delay_s: 0.0199");
  const auto steps = [&](double command, int count) {
    simulation.set_command("cable", command);
    for (int i = 0; i < count; ++i) EXPECT_TRUE(simulation.step().converged);
  };
  steps(0.93, 20);
  simulation.set_command("cable", 0.97);
  const SimulationState saved = simulation.state();
  steps(0.97, 10);
  const Eigen::Matrix3Xd first = simulation.state().positions_m;
  simulation.reset();
  steps(0.9, 3);
  simulation.set_state(saved);
  steps(0.97, 10);
  EXPECT_EQ(simulation.state().positions_m, first);
}

TEST(CableFriction, StepsInTimeEndWhereTheDrivePutIt) {
  Simulation simulation = hanging_bar("model: friction, friction_coefficient: 0.3, compliance_m_n: 0");
  simulation.set_command("cable", 0.9);
  for (int i = 0; i < 90; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message;
  }
  const ActuatorReading at = simulation.actuator_state(0);
  EXPECT_NEAR(*at.length_m, 0.9 * *at.rest_length_m, 1e-5);
}

SolverOptions xpbd(int substep_count) {
  SolverOptions options;
  options.method = SolverOptions::Method::xpbd;
  options.substep_count = substep_count;
  options.tolerance = 1e-4;
  return options;
}

// Pulled, and then let go by half: the way to the second rest state has slipped there and back.
TEST(CableFriction, RestsAlikeWithXpbd) {
  const std::string cable = "compliance_m_n: 1.0e-4, model: friction, friction_coefficient: 0.3";
  Simulation newton = hanging_bar(cable), local = hanging_bar(cable, xpbd(50));
  const Eigen::Vector3d start_m = newton.marker_position(0);
  for (const double command : {0.9, 0.95}) {
    for (Simulation* simulation : {&newton, &local}) {
      simulation->set_command("cable", command);
      const SolveReport report = simulation->solve_equilibrium();
      EXPECT_TRUE(report.converged) << report.message;
    }
    const Eigen::Vector3d way_m = newton.marker_position(0) - start_m;
    EXPECT_LT((local.marker_position(0) - newton.marker_position(0)).norm(), 0.01 * way_m.norm()) << command;
    EXPECT_NEAR(*local.actuator_state(0).tension_n, *newton.actuator_state(0).tension_n,
                0.01 * *newton.actuator_state(0).tension_n);
  }
}

// A ring of held silicone: what is left of the tension at the far end is the capstan's.
TEST(CableFriction, OfXpbdFollowsTheCapstanFormula) {
  Simulation simulation = ring(0.5, 20, xpbd(2));
  for (const double command : {0.99, 0.9985}) {
    simulation.set_command("cable", command);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step().converged);
    const ActuatorReading at = simulation.actuator_state(0);
    const double ratio = at.span_tensions_n.front() / at.span_tensions_n.back(), expected = std::exp(0.5 * M_PI / 2);
    EXPECT_NEAR(command < 0.995 ? ratio : 1.0 / ratio, expected, 0.01 * expected);
  }
}

TEST(CableFriction, RatioFollowsItsAngle) {
  const Simulation simulation = hanging_bar("model: friction, friction_coefficient: 0.7");
  Eigen::Matrix3Xd bent = simulation.body().mesh().nodes_m;
  for (Eigen::Index i = 0; i < bent.cols(); ++i) bent(0, i) += 20.0 * std::pow(bent(1, i), 2) + 0.3 * bent(2, i);
  for (const FrictionContact* contact : simulation.actuators()[0]->friction_contacts()) {
    EXPECT_GT(contact->ratio(bent), 1.01);
    Eigen::Matrix3Xd exact = Eigen::Matrix3Xd::Zero(3, bent.cols());
    contact->add_log_ratio_gradient(bent, 1.0, exact);
    for (Eigen::Index i = 0; i < bent.size(); ++i) {
      Eigen::Matrix3Xd plus = bent, minus = bent;
      plus.data()[i] += 1e-7;
      minus.data()[i] -= 1e-7;
      EXPECT_NEAR(exact.data()[i], std::log(contact->ratio(plus) / contact->ratio(minus)) / 2e-7, 1e-6 * exact.norm());
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
