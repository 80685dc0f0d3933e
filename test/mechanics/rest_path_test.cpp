// SPDX-License-Identifier: BSD-3-Clause
// The way to a rest state: obstacles and holds go through all their poses, and nothing passes through anything.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "box_mesh.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();
const Material kSilicone{264200.0, 0.45, 1070.0};

bool warns_of(const SolveReport& report, const std::string& kind) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const SolveWarning& warning) { return warning.kind == kind; });
}

Simulation with_marker(Body body, const Eigen::Vector3d& at_m) {
  std::vector<Marker> markers;
  markers.emplace_back("marker", at_m, body.mesh(), MeshLocator(body.mesh()));
  return Simulation(std::move(body), {}, std::move(markers), {});
}

// A bar of 20 x 20 x 100 mm that hangs from z = 0.
Body hanging_bar() {
  Body body(box_mesh({-0.01, -0.01, -0.1}, {0.01, 0.01, 0}, {2, 2, 10}), kSilicone);
  body.fix_nodes({-1, -1, -1e-6}, {1, 1, 1}, {true, true, true});
  return body;
}

Obstacle rod(double way_m) {
  return {"rod", Capsule{{-0.0161, -0.1, -0.08}, {-0.0161, 0.1, -0.08}, 0.005}, {{}, {1.0, {way_m, 0, 0}, kZero}}, 0.0};
}

TEST(RestPath, ARodPushesABarItDoesNotPassThrough) {
  for (const double way_m : {0.02, 0.05}) {
    Body body = hanging_bar();
    body.set_gravity({0, 0, -9.81});
    body.set_obstacles({rod(way_m)});
    Simulation simulation = with_marker(std::move(body), {0, 0, -0.1});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_GT(simulation.marker_position(0).x(), way_m - 0.012) << "the tip stays before the rod";
    ASSERT_EQ(simulation.contacts().size(), 1u);
    EXPECT_GT(simulation.contacts()[0].normal_force_n, 0.05);
  }
}

// A block of 30 x 30 x 20 mm that is pressed on a larger one by 10 um, and drawn along it by 1 mm. Points that came to
// touch on the way stuck in the next step, having no pressure yet: no rest state was found in 3000 iterations.
TEST(RestPath, ABlockThatIsHardlyPressedSlides) {
  constexpr double kFriction = 0.4;
  TetMesh mesh = box_mesh({-0.03, -0.03, 0}, {0.03, 0.03, 0.02}, {5, 5, 2});
  add_body("top", box_mesh({-0.012, -0.013, 0.02}, {0.018, 0.017, 0.04}, {4, 3, 2}), mesh);
  Body body(std::move(mesh), {{100e3, 0.45, 1070.0}, {200e3, 0.45, 1070.0}});
  body.fix_nodes({-1, -1, -1}, {1, 1, 1e-6}, {true, true, true});
  const Eigen::Vector3d pressed_m(0, 0, -1e-5), drawn_m(1e-3, 3e-4, -1e-5);
  body.fix_nodes({-1, -1, 0.04 - 1e-6}, {1, 1, 1}, {true, true, true},
                 {{}, {1.0, pressed_m, kZero}, {2.0, drawn_m, kZero}}, "drawn");
  body.let_skin_touch({{0, 1, kFriction}});
  Simulation simulation = with_marker(std::move(body), {0, 0, 0});
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_LT(report.iterations, 200);
  const ContactReading pair = simulation.contacts().at(0);
  EXPECT_GT(pair.normal_force_n, 0.02);
  const double along_n = std::hypot(pair.force_n.x(), pair.force_n.y());
  EXPECT_NEAR(along_n, kFriction * pair.normal_force_n, 0.02 * kFriction * pair.normal_force_n);
}

// Only the first stage of a ball from afar was asked whether its way counts: it rested 0.5 mm from the other.
TEST(RestPath, ABallFromAfarRubsABarAsideAsOneFromNearby) {
  std::vector<Eigen::Vector3d> tips_m;
  for (const double away_m : {0.001, 0.03}) {
    Body body = hanging_bar();
    body.set_gravity({0, 0, -9.81});
    const std::vector<ObstaclePose> motion{{}, {1.0, {-0.012 - away_m, 0, 0}, kZero}};
    body.set_obstacles({{"ball", Sphere{{0.022 + away_m, 0.003, -0.06}, 0.012}, motion, 0.5}});
    Simulation simulation = with_marker(std::move(body), {0, 0, -0.1});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    tips_m.push_back(simulation.marker_position(0));
  }
  EXPECT_LT(tips_m[0].x(), -0.02);
  EXPECT_LT((tips_m[1] - tips_m[0]).norm(), 1e-4);
}

// A bar across another one, which its hand carries down by 31 mm: it bends over the other. The other is 10 mm thick.
// Its fall to the rest state led through that, in one stage, with its tip 11 mm below.
TEST(RestPath, ABarThatIsCarriedDownOnAnotherDoesNotGoThroughIt) {
  for (const double down_m : {0.02, 0.031}) {
    TetMesh mesh = box_mesh({0, -0.005, -0.005}, {0.08, 0.005, 0.005}, {8, 1, 1});
    add_body("upper", box_mesh({0.055, -0.032, 0.016}, {0.065, 0.048, 0.026}, {1, 8, 1}), mesh);
    const Material soft{80e3, 0.45, 1070.0};
    Body body(std::move(mesh), {soft, soft});
    body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
    body.fix_nodes({0.079999, -1, -1}, {1, 1, 1}, {true, true, true});
    body.fix_nodes({-1, 0.047999, 0.01}, {1, 1, 1}, {true, true, true}, {{}, {1.0, {-0.001, 0.008, -down_m}, kZero}},
                   "hand");
    body.let_skin_touch({{0, 1, 0.0}});
    Simulation simulation = with_marker(std::move(body), {0.06, -0.032, 0.021});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_GT(simulation.marker_position(0).z(), 0.015);
    EXPECT_FALSE(simulation.contacts().empty());
  }
}

TEST(RestPath, AnEndThatIsTurnedByAWholeTurnTwistsTheBar) {
  Body body(box_mesh({-0.005, -0.005, 0}, {0.005, 0.005, 0.06}, {1, 1, 8}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, 1, 1e-6}, {true, true, true});
  std::vector<ObstaclePose> turn;
  for (int i = 0; i <= 8; ++i) turn.push_back({1.0 * i, {0, 0, 0}, {0, 0, 0.25 * M_PI * i}});
  body.fix_nodes({-1, -1, 0.059999}, {1, 1, 1}, {true, true, true}, turn, "top");
  Simulation simulation = with_marker(std::move(body), {0.005, 0, 0.03});
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_NEAR(simulation.marker_position(0).x(), -0.005, 0.0005) << "half way up it has turned by half a turn";
}

TEST(RestPath, APlateThatMovesAsideInTheAirDragsNothing) {
  Body body(box_mesh({-0.01, -0.01, 0}, {0.01, 0.01, 0.02}, {2, 2, 2}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, 1, 1e-6}, {true, true, true});
  const std::vector<ObstaclePose> aside_and_down{{}, {1.0, {0.01, 0, 0}, kZero}, {2.0, {0.01, 0, -0.0061}, kZero}};
  body.set_obstacles({{"plate", RoundedBox{{-0.01, 0, 0.0301}, {0.1, 0.1, 0.01}, 0.001}, aside_and_down, 0.2}});
  Simulation simulation = with_marker(std::move(body), {0, 0, 0.02});
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  ASSERT_EQ(simulation.contacts().size(), 1u);
  EXPECT_GT(simulation.contacts()[0].normal_force_n, 3.0);
  EXPECT_LT(std::abs(simulation.contacts()[0].force_n.x()), 0.05);
}

TEST(RestPath, AnObstacleThatIsTooSmallForItsContactPointsIsNamed) {
  for (const double radius_m : {0.001, 0.008}) {
    Body body(box_mesh({-0.03, -0.03, -0.02}, {0.03, 0.03, 0}, {6, 6, 2}), kSilicone);
    body.fix_nodes({-1, -1, -1}, {1, 1, -0.019999}, {true, true, true});
    const Capsule needle{{0.001, 0.002, radius_m + 1e-4}, {0.001, 0.002, 0.05}, radius_m};
    body.set_obstacles({{"needle", needle, {{}, {1.0, {0, 0, -0.0006}, kZero}}, 0.0}});
    Simulation simulation = with_marker(std::move(body), {0, 0, 0});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_EQ(warns_of(report, "coarse_contact"), radius_m < 0.005) << radius_m;
  }
}

// A bar sinks onto a needle's tip: between contact points the tip went in, and no face met it any more.
TEST(RestPath, AnObstacleThatTheBodySwallowedIsNamed) {
  for (const double radius_m : {0.001, 0.006}) {
    Body body(box_mesh({0, -0.006, -0.006}, {0.06, 0.006, 0.006}, {10, 2, 2}), kSilicone);
    body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
    body.set_gravity({0, 0, -3 * 9.81});
    body.set_obstacles({{"tip", Sphere{{0.0437, 0.001, -0.0081 - radius_m}, radius_m}, {}, 0.0}});
    Simulation simulation = with_marker(std::move(body), {0.06, 0, 0});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_EQ(warns_of(report, "coarse_contact"), radius_m < 0.005) << radius_m << " " << simulation.marker_position(0);
  }
}

// A bar of 100 x 10 x 10 mm that sags by 86 mm where nothing is below it.
Simulation sagging_bar(const Obstacle& obstacle, const SolverOptions& options = {}) {
  Body body(box_mesh({0, -0.005, -0.005}, {0.1, 0.005, 0.005}, {10, 1, 1}), {60e3, 0.45, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_gravity({0, 0, -9.81});
  body.set_obstacles({obstacle});
  std::vector<Marker> markers;
  markers.emplace_back("marker", Eigen::Vector3d(0.1, 0, 0), body.mesh(), MeshLocator(body.mesh()));
  return Simulation(std::move(body), {}, std::move(markers), options);
}

// On its way down the bar took them through itself, between its contact points, and they were below it in the end: on
// its top. What is beside the way, or below its end, is not named.
TEST(RestPath, AnObstacleThatWentThroughTheBodyIsNamed) {
  const auto shapes_at = [](const Eigen::Vector3d& at_m) {
    return std::vector<ObstacleShape>{Sphere{at_m, 0.0002}, Sphere{at_m, 0.001},
                                      Capsule{at_m, at_m - Eigen::Vector3d(0.001, 0, 0.02), 0.0005},
                                      RoundedBox{at_m, {0.0006, 0.0008, 0.001}, 0.0001}};
  };
  const Eigen::Vector3d on_the_way_m(0.08, 0.001, -0.02), beside_m(0.08, 0.0075, -0.02), below_m(0.08, 0.001, -0.1);
  for (const Eigen::Vector3d& at_m : {on_the_way_m, beside_m, below_m}) {
    for (const ObstacleShape& shape : shapes_at(at_m)) {
      Simulation simulation = sagging_bar({"one", shape, {}, 0.9});
      const SolveReport report = simulation.solve_equilibrium();
      ASSERT_TRUE(report.converged) << report.message;
      EXPECT_EQ(warns_of(report, "coarse_contact"), at_m == on_the_way_m)
          << shape.index() << " at " << at_m.transpose();
    }
  }
}

TEST(RestPath, AnObstacleThatGoesThroughTheBodyInTimeIsNamed) {
  for (const double aside_m : {0.0, 0.0065}) {
    const Sphere ball{{0.08, 0.001 + aside_m, -0.02}, 0.0002};
    SolverOptions options;
    options.time_step_s = 0.05;
    Simulation simulation = sagging_bar({"ball", ball, {}, 0.9}, options);
    bool named = false;
    for (int i = 0; i < 6; ++i) named = warns_of(simulation.step(), "coarse_contact") || named;
    EXPECT_LT(simulation.marker_position(0).z(), -0.05);
    EXPECT_EQ(named, aside_m == 0.0);
  }
}

// It moves in one stage through a bar that hardly does.
TEST(RestPath, AnObstacleThatMovesThroughTheBodyIsNamed) {
  for (const double aside_m : {0.0, 0.0065}) {
    const Sphere ball{{0.0312, 0.001 + aside_m, 0.02}, 0.0004};
    Simulation simulation = sagging_bar({"ball", ball, {{}, {1.0, {0, 0, -0.06}, kZero}}, 0.9});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_EQ(warns_of(report, "coarse_contact"), aside_m == 0.0);
  }
}

// They lay below it in the end too, converged without a word: the first by 65 mm, as all of its weight came in one
// stage. The second lies outside of the straight way of the bar's end, and inside of the bent one.
TEST(RestPath, ABallThatFrictionKeepsABarOnIsNotSkipped) {
  for (const double radius_m : {0.0025, 0.003, 0.0035, 0.004, 0.0045, 0.006}) {
    Simulation simulation = sagging_bar({"ball", Sphere{{0.08, 0.001, -0.018 - radius_m}, radius_m}, {}, 0.9});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_TRUE(simulation.marker_position(0).z() > -0.03 || warns_of(report, "coarse_contact")) << radius_m;
    EXPECT_TRUE(radius_m < 0.0035 || simulation.marker_position(0).z() > -0.03) << radius_m;
  }
}

TEST(RestPath, ABallBesideTheBentWayOfAnEndIsNotSkipped) {
  Body body(box_mesh({0, -0.005, -0.005}, {0.1, 0.005, 0.005}, {16, 2, 2}), {120e3, 0.45, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_gravity({0, 0, -9.81});
  body.set_obstacles({{"ball", Sphere{{0.0961, 0.0013, -0.0408}, 0.00565}, {}, 0.5}});
  Simulation simulation = with_marker(std::move(body), {0.1, 0, 0});
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_GT(simulation.marker_position(0).z(), -0.04) << "0.072 m without the ball";
  EXPECT_EQ(simulation.contacts().size(), 1u);
}

// A ball pressed into a short bar, which slips off to a side: in one stage that was the other side than in small ones.
TEST(RestPath, AnObstacleThatMovesFarLeadsWhereItLeadsInPieces) {
  const auto bar_beside_ball = [](double share) {
    Body body(box_mesh({-0.01, -0.01, -0.06}, {0.01, 0.01, 0}, {1, 1, 3}), kSilicone);
    body.fix_nodes({-1, -1, -1e-6}, {1, 1, 1}, {true, true, true});
    body.set_gravity({0, 0, -9.81});
    const Sphere ball{{0.0253, 0, -0.0409}, 0.0139};
    body.set_obstacles({{"ball", ball, {{}, {1.0, {-0.0127 * share, 0, 0}, kZero}}, 0.0}});
    return with_marker(std::move(body), {0, 0, -0.06});
  };
  Simulation at_once = bar_beside_ball(1.0);
  ASSERT_TRUE(at_once.solve_equilibrium().converged);
  SimulationState state = bar_beside_ball(0.0).state();
  Eigen::Vector3d in_pieces_m;
  for (int i = 1; i <= 20; ++i) {
    Simulation piece = bar_beside_ball(0.05 * i);
    state.contact.time_s = 0.0;
    piece.set_state(state);
    ASSERT_TRUE(piece.solve_equilibrium().converged) << i;
    state = piece.state();
    in_pieces_m = piece.marker_position(0);
  }
  EXPECT_LT((at_once.marker_position(0) - in_pieces_m).norm(), 1e-4);
}

// The edge of a box is a line that no contact point needs to meet.
TEST(RestPath, ASharpEdgeBetweenContactPointsIsNamed) {
  for (const int cells : {1, 3}) {
    Body body(box_mesh({-0.01, -0.01, -0.1}, {0.01, 0.01, 0}, {cells, cells, 5 * cells}), kSilicone);
    body.fix_nodes({-1, -1, -1e-6}, {1, 1, 1}, {true, true, true});
    const RoundedBox box{{0.02156, 0, -0.0436}, {0.0201, 0.0403, 0.0201}, 0.001};
    body.set_obstacles({{"box", box, {{}, {1.0, {-0.0155, 0, 0}, kZero}}, 0.0}});
    Simulation simulation = with_marker(std::move(body), {0, 0, -0.1});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_EQ(warns_of(report, "coarse_contact"), cells == 1) << cells;
  }
}

}  // namespace
}  // namespace soft_robot_lab
