// SPDX-License-Identifier: BSD-3-Clause
// A bar that its cable bends against a post, or pulls along between plates: how its tip follows the command, against
// differences.
#include <gtest/gtest.h>

#include "mechanics/contact/mesh_shapes.h"
#include "mechanics/newton/slip_rates.h"
#include "test_bar.h"

namespace soft_robot_lab {
namespace {

Simulation bar_at_post(double friction) {
  SolverOptions options;
  options.tolerance = 1e-10;
  const Obstacle post{"post", Cylinder{{0.017, -0.06, -1}, {0.017, -0.06, 1}, 0.005, 0.0005}, {}, friction};
  return hanging_bar("model: sliding", options, 1.0, {post});
}

Eigen::Vector3d tip_m(double friction, double command) {
  Simulation simulation = bar_at_post(friction);
  for (const double at : {0.98, command}) {
    simulation.set_command("cable", at);
    EXPECT_TRUE(simulation.solve_equilibrium().converged);
  }
  EXPECT_GT(simulation.contacts()[0].area_m2, 0.0);
  return simulation.marker_position(0);
}

TEST(ContactSensitivity, FollowsThePostAsDifferencesDo) {
  Simulation simulation = bar_at_post(0.0);
  for (const double command : {0.98, 0.95}) {
    simulation.set_command("cable", command);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
  }
  const Eigen::Vector3d exact = simulation.marker_sensitivities();
  const double change = 1e-6;
  const Eigen::Vector3d measured = (tip_m(0.0, 0.95 + change) - tip_m(0.0, 0.95 - change)) / (2.0 * change);
  EXPECT_LT((exact - measured).norm(), 1e-5 * measured.norm()) << exact.transpose() << " / " << measured.transpose();
}

// Of the tip, by the cable's command, from a state of rest on.
struct TipSlope {
  Simulation& simulation;
  double command;
  SimulationState start = simulation.state();
  Eigen::Vector3d here_m = simulation.marker_position(0), exact = simulation.marker_sensitivities();

  Eigen::Vector3d measured(double by) {
    start.linearisation = nullptr;
    simulation.set_state(start);
    simulation.set_command("cable", command + by);
    EXPECT_TRUE(simulation.solve_equilibrium().converged);
    return (simulation.marker_position(0) - here_m) / by;
  }
  void expect_as_differences(double change) {
    const Eigen::Vector3d slope_m = 2.0 * measured(change) - measured(2.0 * change);
    EXPECT_LT((exact - slope_m).norm(), 1e-5 * slope_m.norm()) << exact.transpose() << " / " << slope_m.transpose();
  }
};

// Where the command changes so. Returns how far off it is where that changes back.
Eigen::Vector3d expect_as_differences(Simulation& simulation, double command, double change) {
  TipSlope slope{simulation, command};
  slope.expect_as_differences(change);
  return slope.exact - slope.measured(-change);
}

// On both sides of the bar, and moved in.
std::vector<Obstacle> pair_of(const ObstacleShape& left, const ObstacleShape& right, double in_m, double friction) {
  return {{"left", left, {{0.0}, {1.0, {in_m, 0, 0}, Eigen::Vector3d::Zero()}}, friction},
          {"right", right, {{0.0}, {1.0, {-in_m, 0, 0}, Eigen::Vector3d::Zero()}}, friction}};
}

ObstacleShape mesh_of(const Triangles& surface, double rounding_m = 0.0) {
  return mesh_shape(surface.vertices_m, surface.triangles, rounding_m);
}

// With an edge towards the bar.
ObstacleShape edge_at(double x_m) {
  Triangles box = box_triangles(Eigen::Vector3d::Zero(), {0.014, 0.014, 0.04});
  box.vertices_m = Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()).toRotationMatrix() * box.vertices_m;
  box.vertices_m.colwise() += Eigen::Vector3d(x_m, -0.06, 0);
  return mesh_of(box, 0.002);
}

ObstacleShape roll_at(double x_m) { return Cylinder{{x_m, -0.06, -1}, {x_m, -0.06, 1}, 0.01, 0.001}; }

// What slipped goes on where the cable is pulled further. The way back has another derivative, as all sticks at first.
TEST(ContactSensitivity, FollowsWhatSticksAndWhatSlipsOnAsDifferencesDo) {
  struct Case {
    std::vector<Obstacle> obstacles;
    bool all_slips;
    double last_command = 0.95;
  };
  const Plane left{{-0.01, 0, 0}, {1, 0, 0}}, right{{0.01, 0, 0}, {-1, 0, 0}};
  for (const auto& [obstacles, all_slips, last_command] :
       {Case{{{"post", Cylinder{{0.017, -0.06, -1}, {0.017, -0.06, 1}, 0.005, 0.0005}, {}, 0.3}}, true},
        Case{{{"ball", Sphere{{0.018, -0.06, 0.003}, 0.006}, {}, 0.1}}, true},
        Case{{{"ball from a mesh", mesh_of(sphere_triangles({0.018, -0.06, 0.003}, 0.006, 4)), {}, 0.1}}, true},
        Case{{{"edge from a mesh", edge_at(0.0215), {}, 0.1}}, true},
        Case{pair_of(left, right, 0.0003, 0.3), false, 0.953},  // at 0.95 a point is 1e-6 of command from slipping
        Case{pair_of(roll_at(-0.02), roll_at(0.02), 0.001, 0.6), false}}) {
    SCOPED_TRACE(obstacles[0].name);
    SolverOptions options;
    options.tolerance = 1e-12;
    Simulation simulation = hanging_bar("model: sliding", options, 1.0, obstacles);
    for (const double command : {0.98, 0.965, last_command}) {
      simulation.set_command("cable", command);
      ASSERT_TRUE(simulation.solve_equilibrium().converged);
    }
    double sticking_m2 = 0.0, slipping_m2 = 0.0;
    for (const ContactReading& contact : simulation.contacts()) {
      sticking_m2 += contact.sticking_area_m2;
      slipping_m2 += contact.slipping_area_m2;
    }
    EXPECT_GT(slipping_m2, 0.0);
    EXPECT_EQ(sticking_m2 == 0.0, all_slips);
    const Eigen::Vector3d exact = simulation.marker_sensitivities();
    const Eigen::Vector3d off_way_back = expect_as_differences(simulation, last_command, -1e-7);
    EXPECT_GT(off_way_back.norm(), 0.05 * exact.norm());
  }
}

// A bar with a cable beside a soft pad, of which an edge dents it.
Simulation bar_at_pad(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m, double friction) {
  TetMesh mesh = box_mesh({-0.01, -0.1, -0.01}, {0.01, 0, 0.01}, {2, 6, 2});
  add_body("pad", box_mesh(low_m, high_m, {1, 2, 2}), mesh);
  Body body(std::move(mesh), {264200.0, 0.49, 1070.0});
  body.fix_nodes({-1, -1e-6, -1}, {1, 1, 1}, {true, true, true});
  body.fix_nodes({0.0199, -1, -1}, {1, 1, 1}, {true, true, true});
  body.let_skin_touch({{0, 1, friction}});
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators.back()->initialise(
      YamlNode::parse("{name: cable, points_m: [[0.006, 0, 0], [0.006, -0.05, 0], [0.006, -0.095, 0]]}", "bar"), body,
      locator);
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0, -0.1, 0), body.mesh(), locator);
  SolverOptions options;
  options.tolerance = 1e-12;
  return Simulation(std::move(body), std::move(actuators), std::move(markers), options);
}

// Against a soft pad whose edge dents the bar: all slip on, all stick on the way back, and some then slip back.
TEST(ContactSensitivity, FollowsWhatTouchesSkinAsDifferencesDo) {
  struct Case {
    double friction, last_command, change;
    bool slips;
  };
  for (const auto& [friction, last_command, change, slips] :
       {Case{0.0, 0.95, -1e-7, false}, Case{0.1, 0.95, -1e-7, true}, Case{0.1, 0.9501, -1e-7, false},
        Case{0.1, 0.9505, 1e-7, true}}) {
    SCOPED_TRACE(last_command);
    Simulation simulation = bar_at_pad({0.01, -0.075, -0.011}, {0.02, -0.055, 0.013}, friction);
    for (const double command : {0.98, 0.965, 0.95, last_command}) {
      simulation.set_command("cable", command);
      ASSERT_TRUE(simulation.solve_equilibrium().converged);
    }
    const ContactReading contact = simulation.contacts().back();
    EXPECT_GT(contact.area_m2, 0.0);
    EXPECT_EQ(contact.slipping_area_m2 > 0.0, slips);
    expect_as_differences(simulation, last_command, change);
  }
}

// Points of the bar that are just beyond an edge of the pad, where a push has no potential: these were 0.2 and 1.8 %
// off. At the second the bar presses on the pad's side, nearly square to it; such a point stayed tied to the front, and
// an equilibrium found again lay 0.1 um away.
TEST(ContactSensitivity, FollowsWhatIsBeyondAnEdgeOfSkinAsDifferencesDo) {
  for (const Eigen::Vector3d& at_m : {Eigen::Vector3d(0, 0, 0.004), {0, 0.01 / 3.0, 0.002}, {0, 0.01 / 3.0, 0.006}}) {
    SCOPED_TRACE(at_m.transpose());
    Simulation simulation =
        bar_at_pad(at_m + Eigen::Vector3d(0.01, -0.085, -0.015), at_m + Eigen::Vector3d(0.02, -0.065, 0.009), 0.1);
    for (const double command : {0.98, 0.965, 0.95}) {
      simulation.set_command("cable", command);
      ASSERT_TRUE(simulation.solve_equilibrium().converged);
    }
    TipSlope{simulation, 0.95}.expect_as_differences(-1e-7);
  }
}

// A box lies on a bar that its cable lifts. Some points of it slip on where the cable lets go a little.
TEST(ContactSensitivity, FollowsAFreeObstacleAsDifferencesDo) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {6, 2, 2}), {264200.0, 0.49, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_gravity({0, -9.81, 0});
  Obstacle box{"box", RoundedBox{{0.07, 0.0205, 0.001}, {0.03, 0.02, 0.012}, 0.001}, {}, 0.2};
  box.mass_kg = 0.004;
  body.set_obstacles({box});
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators.back()->initialise(
      YamlNode::parse("{name: cable, points_m: [[0, 0.006, 0], [0.05, 0.006, 0], [0.095, 0.006, 0]]}", "bar"), body,
      locator);
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0.1, 0, 0), body.mesh(), locator);
  SolverOptions options;
  options.tolerance = 1e-12;
  Simulation simulation(std::move(body), std::move(actuators), std::move(markers), options);
  for (const double command : {1.0, 0.985}) {
    simulation.set_command("cable", command);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
  }
  const ContactReading contact = simulation.contacts()[0];
  EXPECT_GT(contact.slipping_area_m2, 0.0);
  EXPECT_GT(contact.sticking_area_m2, 0.0);
  const Eigen::Vector3d exact = simulation.marker_sensitivities();
  const Eigen::Vector3d off_way_back = expect_as_differences(simulation, 0.985, 1e-7);
  EXPECT_GT(off_way_back.norm(), 0.01 * exact.norm());
}

// A bar pushes a box along a floor, at the limit of friction there.
TEST(ContactSensitivity, FollowsABoxThatSlidesOnAFloorAsDifferencesDo) {
  const Obstacle floor{"floor", Plane{{0, -0.102, 0}, {0, 1, 0}}, {}, 0.0};
  Obstacle box{"box", RoundedBox{{0.0212, -0.092, 0.001}, {0.02, 0.02, 0.02}, 0.001}, {}, 0.0};
  box.mass_kg = 0.01;
  box.friction_on["floor"] = 0.3;
  SolverOptions options;
  options.tolerance = 1e-11;
  Simulation simulation = hanging_bar("model: sliding", options, 1.0, {floor, box});
  for (const double command : {0.99, 0.98, 0.97}) {
    simulation.set_command("cable", command);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
  }
  const ContactReading on_floor = simulation.contacts().back();
  EXPECT_NEAR(on_floor.force_n.x(), -0.3 * on_floor.normal_force_n, 1e-3 * on_floor.normal_force_n);
  TipSlope{simulation, 0.97}.expect_as_differences(-1e-6);
}

// Three points, each of which gives way to the others: those that stick stay below their limit.
TEST(SlipRates, SolveTheComplementarityProblem) {
  const Eigen::Matrix3d coupling = (Eigen::Matrix3d() << 0.8, 0.1, 0, 0.15, 0.7, 0.1, 0, 0.2, 0.6).finished();
  for (const Eigen::Vector3d& beyond : {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, -2, 0.5),
                                        Eigen::Vector3d(-1, -2, -3), Eigen::Vector3d(3, -0.5, -2)}) {
    const Eigen::Vector3d rates = slip_rates(coupling, beyond), spare = rates - coupling * rates - beyond;
    EXPECT_GE(rates.minCoeff(), 0.0);
    EXPECT_GE(spare.minCoeff(), -1e-12);
    EXPECT_NEAR(rates.dot(spare), 0.0, 1e-12);
  }
  EXPECT_TRUE(slip_rates(coupling, Eigen::Vector3d(-1, -2, -3)).isZero(0.0));
  EXPECT_EQ(slip_rates(coupling, Eigen::Vector3d(1, -2, 0.5))[1], 0.0);
}

}  // namespace
}  // namespace soft_robot_lab
