// SPDX-License-Identifier: BSD-3-Clause
// Skin in other silicone, where the scene lists no contact.
#include <cmath>

#include <gtest/gtest.h>

#include "mechanics/carved_mesh.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kEnd(1, 1, 1);

// Two prongs of 80 x 10 x 5 mm, 5 mm apart, joined over their first 20 mm and held there.
Body fork(bool quadratic) {
  TetMesh mesh = carved({0, 0, 0}, {0.1, 0.01, 0.015}, {10, 1, 3}, [](const Eigen::Vector3d& at_m) {
    return at_m.x() < 0.02 || at_m.z() < 0.005 || at_m.z() > 0.01;
  });
  return Body(quadratic ? make_quadratic(mesh) : make_linear(mesh), {264200.0, 0.45, 1070.0});
}

// Their ends are pressed against one another.
std::optional<SolveWarning> of_pressed(Body body, double force_n, double* gap_m) {
  body.fix_nodes(-kEnd, {0.0201, 1, 1}, {true, true, true});
  body.add_force({0.099999, -1, 0.009999}, kEnd, {0, 0, -force_n});
  body.add_force({0.099999, -1, -1}, {1, 1, 0.005001}, {0, 0, force_n});
  Simulation simulation(std::move(body), {}, {}, {});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  const Eigen::Matrix3Xd &rest_m = simulation.body().mesh().nodes_m, &now_m = simulation.state().positions_m;
  double lower_m = 0.0, upper_m = 0.0;  // of the prongs' inner edges at their ends
  for (Eigen::Index node = 0; node < rest_m.cols(); ++node) {
    if (rest_m(0, node) < 0.0999) continue;
    if (std::abs(rest_m(2, node) - 0.005) < 1e-6) lower_m = now_m(2, node);
    if (std::abs(rest_m(2, node) - 0.01) < 1e-6) upper_m = now_m(2, node);
  }
  *gap_m = upper_m - lower_m;
  std::optional<SolveWarning> found;
  for (const SolveWarning& warning : report.warnings)
    if (warning.kind == "skin_in_silicone") found = warning;
  return found;
}

TEST(SkinOverlap, IsNamedWithItsDepthAndPlace) {
  for (const bool quadratic : {false, true}) {
    double gap_m = 0.0;
    const auto warning = of_pressed(fork(quadratic), quadratic ? 0.00055 : 0.0072, &gap_m);
    ASSERT_LT(gap_m, -0.001);
    ASSERT_GT(gap_m, -0.004) << "less than a prong's thickness";
    ASSERT_TRUE(warning.has_value());
    EXPECT_NEAR(warning->size, -gap_m, 0.15 * -gap_m);
    EXPECT_NEAR(warning->rest_position_m->x(), 0.1, 1e-6);
    EXPECT_NEAR(std::abs(warning->rest_position_m->z() - 0.0075), 0.0025, 1e-6);
    EXPECT_NE(warning->text.find("`contact.self: true` keeps it out"), std::string::npos) << warning->text;
  }
}

TEST(SkinOverlap, IsNoneWhereTheProngsDoNotMeet) {
  double gap_m = 0.0;
  EXPECT_FALSE(of_pressed(fork(true), 0.0002, &gap_m).has_value());
  EXPECT_GT(gap_m, 0.0005);
  EXPECT_FALSE(of_pressed(fork(true), -0.001, &gap_m).has_value());
}

TEST(SkinOverlap, IsNoneWhereContactKeepsItOut) {
  Body body = fork(true);
  body.let_touch_itself();
  double gap_m = 0.0;
  EXPECT_FALSE(of_pressed(std::move(body), 0.00055, &gap_m).has_value());
  EXPECT_GT(gap_m, -0.0005);
}

// Deeper than contact ever lets it in: contact knows nothing of it any more.
TEST(SkinOverlap, IsNamedInSpiteOfContact) {
  Body body = fork(true);
  body.fix_nodes(-kEnd, {0.0201, 1, 1}, {true, true, true});
  body.let_touch_itself();
  Simulation simulation(std::move(body), {}, {}, {});
  EXPECT_TRUE(simulation.unmodelled_contact().empty());
  SimulationState state = simulation.state();
  for (Eigen::Index node = 0; node < state.positions_m.cols(); ++node)
    if (state.positions_m(0, node) > 0.02 && state.positions_m(2, node) > 0.0099)
      state.positions_m(2, node) -= 0.009 * (state.positions_m(0, node) - 0.02) / 0.08;
  simulation.set_state(state);
  const std::vector<SolveWarning> warnings = simulation.unmodelled_contact();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].kind, "skin_in_silicone");
  EXPECT_NEAR(warnings[0].size, 0.009 * 0.075 / 0.08 - 0.005, 1e-6) << "of the last nodes but those at the very end";
  EXPECT_NE(warnings[0].text.find("silicone that it touches"), std::string::npos) << warnings[0].text;
}

// A block that gravity lowers into another one.
TEST(SkinOverlap, OfTwoBodiesNamesThem) {
  TetMesh mesh = carved({0, 0, 0}, {0.02, 0.02, 0.02}, {2, 2, 2}, [](const Eigen::Vector3d&) { return true; });
  const TetMesh upper =
      carved({0.005, 0.005, 0.021}, {0.015, 0.015, 0.061}, {1, 1, 4}, [](const Eigen::Vector3d&) { return true; });
  add_body("upper", upper, mesh);
  Body body(mesh, {20000.0, 0.3, 1070.0});
  body.fix_nodes(-kEnd, {1, 1, 1e-6}, {true, true, true});
  body.fix_nodes({-1, -1, 0.060999}, kEnd, {true, true, true});
  body.add_force({-1, -1, 0.0209}, {1, 1, 0.0211}, {0, 0, -0.2});
  Simulation simulation(std::move(body), {}, {}, {});
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  const std::vector<SolveWarning> warnings = simulation.unmodelled_contact();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].text.find("list ['upper', 'body'] in `contact.bodies`"), std::string::npos) << warnings[0].text;
  EXPECT_GT(warnings[0].size, 0.001);
}

}  // namespace
}  // namespace soft_robot_lab
