// SPDX-License-Identifier: BSD-3-Clause
// Cables of which only the path is given: where they run in the silicone and where they are free.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "mechanics/box_mesh.h"
#include "mechanics/actuators/cable/taut_string.h"
#include "mechanics/mesh/cable_path.h"
#include "mechanics/mesh/skin.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/mechanics/simulation.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

// The mesh without the elements whose centre is there.
TetMesh without(const TetMesh& whole, const std::function<bool(const Eigen::Vector3d&)>& there) {
  TetMesh mesh = whole;
  mesh.tets.resize(whole.tets.rows(), 0);
  std::vector<int> renumbered(static_cast<std::size_t>(whole.node_count()), -1);
  int nodes = 0;
  for (int tet = 0; tet < whole.tet_count(); ++tet) {
    Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
    for (int i = 0; i < 4; ++i) center_m += 0.25 * whole.nodes_m.col(whole.tets(i, tet));
    if (there(center_m)) continue;
    mesh.tets.conservativeResize(Eigen::NoChange, mesh.tet_count() + 1);
    for (Eigen::Index a = 0; a < whole.tets.rows(); ++a) {
      int& number = renumbered[static_cast<std::size_t>(whole.tets(a, tet))];
      if (number < 0) {
        number = nodes++;
        mesh.nodes_m.col(number) = whole.nodes_m.col(whole.tets(a, tet));
      }
      mesh.tets(a, mesh.tet_count() - 1) = number;
    }
  }
  mesh.nodes_m.conservativeResize(Eigen::NoChange, nodes);
  return mesh;
}

// 60 x 20 x 20 mm with a slot through its upper half, 10 mm wide, or as wide as given: [20, 30] mm.
TetMesh slotted(double width_m = 0.01) {
  TetMesh mesh = box_mesh({0, -0.01, -0.01}, {0.06, 0.01, 0.01}, {6, 2, 2}, false);
  for (int node = 0; node < mesh.node_count(); ++node)
    if (std::abs(mesh.nodes_m(0, node) - 0.03) < 1e-9) mesh.nodes_m(0, node) = 0.02 + width_m;
  return make_quadratic(without(mesh, [&](const Eigen::Vector3d& center_m) {
    return center_m.y() > 0.0 && center_m.x() > 0.02 && center_m.x() < 0.02 + width_m;
  }));
}

ActuatorReading at_rest(const TetMesh& mesh, const std::string& settings) {
  Body body(mesh, Material{});
  const MeshLocator locator(body.mesh());
  Cable cable;
  cable.initialise(YamlNode::parse("{name: cable, plug_radius_m: 0.001, " + settings + "}", "cable.yaml"), body,
                   locator);
  return cable.observe(body.mesh().nodes_m, {0.0}, cable.rest_state());
}

std::vector<double> along_x(const ActuatorReading& reading) {
  std::vector<double> x_m;
  for (const Eigen::Vector3d& point_m : reading.path_m) x_m.push_back(point_m.x());
  return x_m;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& wanted, double by) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], wanted[i], by) << i;
}

const std::string kThroughSlot = "path_m: [[0, 0.005, 0.003], [0.06, 0.005, 0.003]]";

TEST(CableRoute, HasPointsWhereItLeavesAndEnters) {
  expect_near(along_x(at_rest(slotted(), kThroughSlot + ", via_points: given")), {0, 0.02, 0.03, 0.06}, 1e-9);
  // Below the slot's floor it stays inside.
  expect_near(along_x(at_rest(slotted(), "path_m: [[0, -0.005, 0.003], [0.06, -0.005, 0.003]], via_points: given")),
              {0, 0.06}, 1e-9);
}

TEST(CableRoute, HasAPointInEveryElementThatItPassesAndNoneInTheAir) {
  const std::vector<double> x_m = along_x(at_rest(slotted(), kThroughSlot));
  ASSERT_GE(x_m.size(), 4u + 2u * 2u + 3u * 2u);  // two or three elements a cell
  for (const double x : x_m) EXPECT_FALSE(x > 0.02 + 1e-9 && x < 0.03 - 1e-9) << x;
  EXPECT_NEAR(*at_rest(slotted(), kThroughSlot).rest_length_m, 0.06, 1e-9);
}

TEST(CableRoute, KeepsCornersAndSetsPointsOnEitherSide) {
  const ActuatorReading cable = at_rest(
      slotted(), "path_m: [[0, 0.005, 0.003], [0.015, 0.005, 0.003], [0.06, 0.005, -0.003]], via_points: given");
  ASSERT_EQ(cable.path_m.size(), 5u);
  const Eigen::Vector3d corner_m(0.015, 0.005, 0.003), end_m(0.06, 0.005, -0.003);
  EXPECT_NEAR((cable.path_m[1] - corner_m).norm(), 0.0, 1e-9);
  // A mouth of the sheath lies in the skin, so that the whole of its disc takes hold.
  EXPECT_NEAR((cable.path_m[2] - corner_m - 5.0 / 45.0 * (end_m - corner_m)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((cable.path_m[3] - corner_m - 15.0 / 45.0 * (end_m - corner_m)).norm(), 0.0, 1e-9);
}

// y = 10 mm + 8 mm (1 - (x / 30 mm - 1)^2) on the upper side: a quadratic face has it exactly.
TEST(CableRoute, MeetsCurvedFacesWhereTheyAre) {
  TetMesh mesh = box_mesh({0, -0.01, -0.01}, {0.06, 0.01, 0.01}, {2, 1, 1});
  for (int node = 0; node < mesh.node_count(); ++node) {
    const double x = mesh.nodes_m(0, node) / 0.03 - 1.0, up = (mesh.nodes_m(1, node) + 0.01) / 0.02;
    mesh.nodes_m(1, node) += up * 0.008 * (1.0 - x * x);
  }
  complete_boundary(mesh);
  const std::vector<SkinCrossing> met = skin_crossings(mesh, {-0.01, 0.015, 0.0021}, {0.07, 0.015, 0.0021});
  const double half_m = 0.03 * std::sqrt(1.0 - 5.0 / 8.0);
  ASSERT_EQ(met.size(), 2u);
  EXPECT_NEAR(0.08 * met[0].share - 0.01, 0.03 - half_m, 1e-9);
  EXPECT_NEAR(0.08 * met[1].share - 0.01, 0.03 + half_m, 1e-9);
  const double slope = 2.0 * 0.008 * half_m / (0.03 * 0.03);
  EXPECT_NEAR((met[0].normal - Eigen::Vector3d(-slope, 1, 0).normalized()).norm(), 0.0, 1e-9);
}

TEST(CableRoute, PassesOverSlitsFarThinnerThanItsSheath) {
  const TetMesh slit = slotted(0.0001);  // at most 0.05 mm from silicone
  EXPECT_EQ(at_rest(slit, kThroughSlot + ", via_points: given, sheath_radius_m: 0.001").path_m.size(), 2u);
  expect_near(along_x(at_rest(slit, kThroughSlot + ", via_points: given, sheath_radius_m: 0.0002")),
              {0, 0.02, 0.0201, 0.06}, 1e-9);
}

// Of four control points the curve is the Bézier curve of these points.
TEST(CableRoute, FollowsASpline) {
  const Eigen::Vector3d a(0, -0.005, 0), b(0.02, -0.005, 0), c(0.04, -0.005, -0.004), d(0.06, -0.005, -0.004);
  const std::vector<Eigen::Vector3d> points_m = points_on_spline({a, b, c, d}, 1e-5);
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double t = static_cast<double>(i) / (static_cast<double>(points_m.size()) - 1.0), s = 1.0 - t;
    const Eigen::Vector3d wanted_m = s * s * s * a + 3 * s * s * t * b + 3 * s * t * t * c + t * t * t * d;
    EXPECT_LT((points_m[i] - wanted_m).norm(), 1e-12) << i;
  }
  const std::string curve =
      "spline_m: [[0, -0.005, 0], [0.02, -0.005, 0], [0.04, -0.005, -0.004], [0.06, -0.005, -0.004]]";
  double length_m = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i) length_m += (points_m[i] - points_m[i - 1]).norm();
  EXPECT_NEAR(*at_rest(slotted(), curve).rest_length_m, length_m, 0.0001 * length_m);
  EXPECT_EQ(points_on_spline({a, d}, 1e-5).size(), 2u) << "a straight line";
}

// Where it leaves the silicone it is straight: no point of the curve holds it there.
TEST(CableRoute, IsStraightWhereItsSplinePassesThroughAir) {
  const std::vector<double> x_m =
      along_x(at_rest(slotted(), "spline_m: [[0, 0.002, 0], [0.03, 0.008, 0], [0.06, 0.002, 0]]"));
  int in_slot = 0;
  for (const double x : x_m) in_slot += x > 0.02 + 1e-4 && x < 0.03 - 1e-4;
  EXPECT_EQ(in_slot, 0);
  EXPECT_EQ(std::count_if(x_m.begin(), x_m.end(), [](double x) { return std::abs(x - 0.02) < 1e-4; }), 1);
  EXPECT_EQ(std::count_if(x_m.begin(), x_m.end(), [](double x) { return std::abs(x - 0.03) < 1e-4; }), 1);
}

std::string refusal(const std::string& settings) {
  try {
    at_rest(slotted(), settings);
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "";
}

TEST(CableRoute, RefusesWhatIsNeitherInASheathNorFree) {
  const struct {
    std::string settings, words;
  } cases[] = {
      {"path_m: [[0, 0.0099999, 0], [0.06, 0.0099999, 0]]",
       "path_m[1]: on the way to this point the path runs along the skin, within 0.0001 m of it"},
      {"path_m: [[0, 0.01, 0.003], [0.015, 0.01, 0.003], [0.05, 0, 0]]", "path_m[1]: on the way to this point"},
      {"path_m: [[-0.004, 0, 0], [0.05, 0, 0]]",
       "path_m[0]: point 0 at (-0.004, 0, 0) m lies 0.004 m outside the body, where nothing holds the cable's end"},
      {"path_m: [[0, 0.005, 0], [0.025, 0.005, 0], [0.05, 0.005, 0]]",
       "path_m[1]: point 1 at (0.025, 0.005, 0) m lies 0.005 m outside the body, where nothing bends the cable"},
      {"path_m: [[0, 0, 0], [0.025, 0.005, 0]]", "path_m[1]: point 1 at (0.025, 0.005, 0) m lies 0.005 m outside"},
      {"spline_m: [[0, 0, 0], [0.02, 0, 0], [0.06, 0.02, 0]]", "spline_m: point "},
      {"spline_m: [[0, 0, 0]]", "spline_m: a cable needs at least two points, this one has 1"},
      {"path_m: [[0, 0, 0]]", "path_m: a cable needs at least two points, this one has 1"},
      {"path_m: [[0, 0, 0], [0.05, 0, 0]], points_m: [[0, 0, 0], [0.05, 0, 0]]",
       "must have one of points_m, path_m, spline_m"},
      {"via_points: given", "must have one of points_m, path_m, spline_m"},
  };
  for (const auto& wrong : cases)
    EXPECT_NE(refusal(wrong.settings).find(wrong.words), std::string::npos) << refusal(wrong.settings);
}

// The slotted bar held at both ends, loaded on its back, with a cable of 2000 N/m through its upper half.
double tension_n(const std::string& path, const Eigen::Vector3i& cells) {
  TetMesh bar = box_mesh({0, -0.01, -0.01}, {0.12, 0.01, 0.01}, cells, false);
  Body body(make_quadratic(without(bar,
                                   [](const Eigen::Vector3d& center_m) {
                                     return center_m.y() > 0.0 && center_m.x() > 0.05 && center_m.x() < 0.07;
                                   })),
            Material{264200.0, 0.499, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.fix_nodes({0.119999, -1, -1}, {1, 1, 1}, {true, true, true});
  body.add_traction({-1, -1, -1}, {1, -0.009999, 1}, {0, 4000.0, 0});
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> cables;
  cables.push_back(std::make_unique<Cable>());
  cables[0]->initialise(YamlNode::parse("{name: cable, compliance_m_n: 5.0e-4, " + path + "}", "bar"), body, locator);
  Simulation simulation(std::move(body), std::move(cables), {}, {});
  simulation.set_command("cable", 0.98);
  EXPECT_TRUE(simulation.solve_equilibrium().converged);
  return *simulation.actuator_state(0).tension_n;
}

std::string hand_set(int spans_each_side) {
  std::ostringstream text;
  text << "points_m: [";
  for (int i = 0; i <= spans_each_side; ++i)
    text << (i ? ", [" : "[") << 0.05 * i / spans_each_side << ", 0.0053, 0.0007]";
  for (int i = 0; i <= spans_each_side; ++i) text << ", [" << 0.07 + 0.05 * i / spans_each_side << ", 0.0053, 0.0007]";
  text << "]";
  return text.str();
}

TEST(CableRoute, ComesToWhatManyHandSetPointsSay) {
  const std::string path = "path_m: [[0, 0.0053, 0.0007], [0.12, 0.0053, 0.0007]]";
  const Eigen::Vector3i cells(12, 2, 2);
  const double many_n = tension_n(hand_set(40), cells);
  EXPECT_NEAR(tension_n(path, cells), many_n, 0.003 * many_n);
  // Mouths alone do not see that the silicone between them bends.
  EXPECT_GT(std::abs(tension_n(path + ", via_points: given", cells) - many_n), 0.01 * many_n);
}

// Around a post, led over one point above it: a turn of up to 200 degrees, by the shortest way on that side.
TEST(TautString, StaysOnTheSideThatItIsLedOver) {
  constexpr double kRadius_m = 0.01;
  for (const double far : {1.5, 3.0, 6.0})  // of the ends, over the radius
    for (const double above : {1.05, 1.5, 4.0})
      for (const double turn_deg : {60.0, 100.0, 120.0, 140.0, 160.0, 180.0, 200.0}) {
        const double half = 0.5 * turn_deg * M_PI / 180.0, angle = half + std::acos(1.0 / far);
        if (angle > 0.97 * M_PI) continue;  // the ends are nearly one
        const Eigen::Vector3d end_m = far * kRadius_m * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0.0);
        const Eigen::Vector3d other_m(-end_m.x(), end_m.y(), 0.0);
        const TautString string({Cylinder{{0, 0, -1}, {0, 0, 1}, kRadius_m, 0.001}}, {{0.0, above * kRadius_m, 0.0}},
                                2.0 * (end_m - Eigen::Vector3d(0.0, above * kRadius_m, 0.0)).norm());
        const auto shape = string.between(end_m, other_m);
        const double length_m = 2.0 * kRadius_m * (std::sqrt(far * far - 1.0) + half);
        EXPECT_NEAR(shape->length_m, length_m, 2e-3 * length_m) << far << " " << above << " " << turn_deg;
      }
}

}  // namespace
}  // namespace soft_robot_lab
