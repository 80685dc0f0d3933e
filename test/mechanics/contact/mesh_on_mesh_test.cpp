// SPDX-License-Identifier: BSD-3-Clause
// Free obstacles from meshes on obstacles from meshes, against shapes that have closed forms, and balance of forces.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/body/free_obstacles.h"
#include "mechanics/body/mesh_solid.h"
#include "mechanics/body/rigid_places.h"
#include "mesh_shapes.h"

namespace soft_robot_lab {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kGravity = 9.81;

MeshShape shape_of(const Triangles& from, double rounding_m = 0.0) {
  return mesh_shape(from.vertices_m, from.triangles, rounding_m);
}

Isometry3d at_random(std::mt19937& random, double far_m) {
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  const auto any = [&] {
    const double x = side(random), y = side(random), z = side(random);
    return Vector3d(x, y, z);
  };
  const Vector3d axis = any().normalized(), way_m = far_m * any();
  return Eigen::Translation3d(way_m) * Eigen::AngleAxisd(M_PI * side(random), axis);
}

// Corners, edges and faces of either in any poses. Each mesh's edges are rounded for the other's.
TEST(MeshOnMesh, IsAsFarApartAsSharpBoxes) {
  const Vector3d small_m(0.02, 0.03, 0.04), large_m(0.05, 0.015, 0.03);
  const MeshShape one = shape_of(shuffled(box_triangles(kZero, small_m), 4)),
                  other = shape_of(box_triangles(kZero, large_m));
  const RoundedBox sharp_one{kZero, small_m, 1e-7}, sharp_other{kZero, large_m, 1e-7};
  const double step_m = std::max(one.solid->rounding_m(), other.solid->rounding_m());
  std::mt19937 random(3);
  int seen = 0;
  double most_m = 0.0;
  for (int i = 0; i < 4000 && seen < 150; ++i) {
    const Isometry3d own_pose = at_random(random, 0.03), pose = at_random(random, 0.01);
    const double expected_m = apart_m({sharp_one, own_pose}, {sharp_other, pose});
    if (expected_m < 0.0 || expected_m > 0.005) continue;
    ++seen;
    const double gap_m = apart_m({one, own_pose}, {other, pose});
    EXPECT_NEAR(gap_m, expected_m, 0.3 * expected_m + 0.8 * step_m);
    EXPECT_NEAR(gap_m, apart_m({other, pose}, {one, own_pose}), 1e-12);
    if (expected_m < 0.5 * step_m) most_m = std::max(most_m, std::abs(gap_m - expected_m));
  }
  EXPECT_EQ(seen, 150);
  EXPECT_LT(most_m, 0.8 * step_m);
}

// As the one moves, and as its material turns about the place.
TEST(MeshOnMesh, NormalsAreDerivativesOfTheGap) {
  const MeshShape one = shape_of(l_triangles(0.03, 0.01, 0.02)),
                  other = shape_of(box_triangles(kZero, {0.03, 0.02, 0.04}));
  const std::vector<RigidPlace> places = rigid_places(one, other);
  constexpr double kStep = 1e-7;
  std::mt19937 random(8);
  int lines = 0;
  for (int i = 0; i < 800; ++i) {
    const Isometry3d own_pose = at_random(random, 0.02), pose = at_random(random, 0.001);
    for (const RigidPlace& place : places) {
      const auto met = meet(place, one, own_pose, other, pose);
      const bool crosses = std::holds_alternative<LineOnLine>(place.kind);
      const double near_m = (crosses ? 2.0 : 0.1) * other.solid->rounding_m();
      if (!met || met->gap_m < -0.1 * near_m || met->gap_m > near_m) continue;
      lines += crosses ? 1 : 0;
      for (int axis = 0; axis < 3; ++axis) {
        const auto moved = [&](double way_m) {
          return meet(place, one, Eigen::Translation3d(way_m * Vector3d::Unit(axis)) * own_pose, other, pose);
        };
        const auto more = moved(kStep), less = moved(-kStep);
        if (!more || !less || std::abs(more->gap_m - less->gap_m) > 4 * kStep) continue;  // another valley
        EXPECT_NEAR((more->gap_m - less->gap_m) / (2 * kStep), met->normal[axis], 1e-4);
      }
    }
  }
  EXPECT_GT(lines, 20);
}

// Held below, far from all rigid things.
Body bystander() {
  Body body(box_mesh({-0.52, -0.51, -0.02}, {-0.48, -0.5, 0.02}, {1, 1, 1}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, 1, 1}, {true, true, true});
  body.set_gravity({0, -kGravity, 0});
  return body;
}

Obstacle free_thing(const std::string& name, const ObstacleShape& shape, double mass_kg) {
  Obstacle one{name, shape, {}, 0.0};
  one.mass_kg = mass_kg;
  return one;
}

Simulation of(const std::vector<Obstacle>& obstacles, SolverOptions options) {
  Body body = bystander();
  body.set_obstacles(obstacles);
  return Simulation(std::move(body), {}, {}, options);
}

void run(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message << " in step " << i;
  }
}

double height_m(const Simulation& simulation, int free) { return simulation.state().contact.free.centers_m(1, free); }

double leans_rad(const Simulation& simulation, int free) {
  const Eigen::Quaterniond turn(Eigen::Vector4d(simulation.state().contact.free.turns.col(free)));
  return std::acos(std::min(1.0, (turn * Vector3d::UnitY()).y()));
}

// Of equal boxes edge lies on edge, corner on corner.
TEST(MeshOnMesh, AStackOfEqualBoxesStands) {
  const Vector3d size_m(0.03, 0.02, 0.04);
  for (const double turn_rad : {0.0, 0.4}) {
    const auto block = [&](double y, double turned_rad) {
      Triangles box = box_triangles(kZero, size_m);
      box.vertices_m = Eigen::AngleAxisd(turned_rad, Vector3d::UnitY()).toRotationMatrix() * box.vertices_m;
      box.vertices_m.colwise() += Vector3d(0.0, y, 0.0);
      return shape_of(box);
    };
    Obstacle lower = free_thing("lower", block(0.03001, 0.0), 0.05),
             upper = free_thing("upper", block(0.05002, turn_rad), 0.03);
    lower.friction_on = {{"table", 0.5}};
    upper.friction_on = {{"lower", 0.5}};
    SolverOptions options;
    options.time_step_s = 0.005;
    Simulation simulation = of({{"table", block(0.01, 0.0), {}, 0.0}, lower, upper}, options);
    run(simulation, 60);
    EXPECT_NEAR(height_m(simulation, 0), 0.03, 1e-6) << turn_rad;
    EXPECT_NEAR(height_m(simulation, 1), 0.05, 2e-6) << turn_rad;
    for (const int free : {0, 1}) EXPECT_LT(leans_rad(simulation, free), 1e-4) << turn_rad;
    for (const ContactReading& contact : simulation.contacts()) {
      if (contact.on == "lower" && contact.surface == "table") {
        EXPECT_NEAR(contact.force_n.y(), 0.08 * kGravity, 1e-3 * 0.08 * kGravity);
      }
    }
    const std::vector<ContactReading> contacts = simulation.contacts();
    const auto of_upper = std::find_if(contacts.begin(), contacts.end(), [](const ContactReading& one) {
      return one.on == "lower" && one.surface == "upper";
    });
    ASSERT_NE(of_upper, contacts.end());
    EXPECT_NEAR(of_upper->force_n.y(), -0.03 * kGravity, 1e-3 * 0.03 * kGravity);
    EXPECT_LT((of_upper->center_m - Vector3d(0, 0.04, 0)).norm(), 2e-4);
  }
}

// Across two ridges, of which no corner touches it.
TEST(MeshOnMesh, ABarLiesAcrossTwoRidges) {
  const auto rail = [](double z_m) {
    Triangles one = prism({{-0.005, -0.01}, {0.005, -0.01}, {0.0, 0.0}, {-0.0025, -0.005}}, 0.04, {{0, 1, 2, 3}});
    one.vertices_m = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).toRotationMatrix() * one.vertices_m;
    one.vertices_m.colwise() += Vector3d(-0.02, 0.1, z_m);
    return shape_of(one);
  };
  Obstacle bar = free_thing("bar", shape_of(box_triangles({0, 0.1052, 0}, {0.012, 0.01, 0.06})), 0.03);
  bar.friction_on = {{"front", 0.5}, {"back", 0.5}};
  SolverOptions options;
  options.time_step_s = 0.002;
  Simulation simulation = of({bar, {"front", rail(-0.02), {}, 0.0}, {"back", rail(0.015), {}, 0.0}}, options);
  run(simulation, 100);
  EXPECT_NEAR(height_m(simulation, 0), 0.105, 1e-5);
  double sum_n = 0.0, turn_n_m = 0.0;
  for (const ContactReading& contact : simulation.contacts()) {
    if (contact.on != "bar") continue;
    sum_n += contact.force_n.y();
    turn_n_m += contact.force_n.y() * contact.center_m.z();
  }
  EXPECT_NEAR(sum_n, 0.03 * kGravity, 1e-3 * 0.03 * kGravity);
  EXPECT_NEAR(turn_n_m, 0.0, 2e-5);
}

// In the right angle of an L that opens upwards: R sqrt(2) above its inner edge.
TEST(MeshOnMesh, ABallRestsInAConcaveMesh) {
  constexpr double kRadius = 0.01;
  Triangles valley = l_triangles(0.03, 0.01, 0.04);
  valley.vertices_m.colwise() -= Vector3d(0.01, 0.01, 0.02);
  valley.vertices_m = Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitZ()).toRotationMatrix() * valley.vertices_m;
  Obstacle ball =
      free_thing("ball", shape_of(sphere_triangles({0, std::sqrt(2.0) * kRadius + 1e-4, 0}, kRadius, 4)), 0.02);
  ball.friction_on = {{"valley", 0.3}};
  SolverOptions options;
  options.time_step_s = 0.004;
  Simulation simulation = of({ball, {"valley", shape_of(valley), {}, 0.0}}, options);
  run(simulation, 150);
  EXPECT_NEAR(height_m(simulation, 0), std::sqrt(2.0) * kRadius, 3e-5);  // its facets stand back by 12 um
  EXPECT_LT(simulation.state().free_velocities.linear_m_s.norm(), 1e-3);
  const ContactReading reading = simulation.contacts().back();
  EXPECT_NEAR(reading.force_n.y(), 0.02 * kGravity, 2e-3);
  EXPECT_LT(reading.force_n.head<1>().norm(), 2e-3);
}

// Thrown on a table, corner first.
TEST(MeshOnMesh, ABoxTumblesToLieFlatAndGainsNoEnergy) {
  for (const unsigned seed : {1u, 2u}) {
    std::mt19937 random(seed);
    const Isometry3d turn(at_random(random, 0.0).linear());
    Triangles box = box_triangles(kZero, {0.02, 0.03, 0.04});
    box.vertices_m = turn.linear() * box.vertices_m;
    box.vertices_m.row(1).array() += 0.002 - box.vertices_m.row(1).minCoeff();
    Obstacle thing = free_thing("thing", shape_of(box), 0.05);
    thing.friction_on = {{"table", 0.4}};
    SolverOptions options;
    options.time_step_s = 0.002;
    Simulation simulation =
        of({thing, {"table", shape_of(box_triangles({0, -0.01, 0}, {0.3, 0.02, 0.3})), {}, 0.0}}, options);
    double before_m = height_m(simulation, 0);
    for (int i = 0; i < 400; ++i) {
      const SolveReport report = simulation.step();
      ASSERT_TRUE(report.converged) << report.message << " in step " << i;
      EXPECT_LT(height_m(simulation, 0), before_m + 1e-3) << i;
      before_m = std::min(before_m, height_m(simulation, 0));
    }
    const double lies_m = height_m(simulation, 0);
    const double off_m = std::min({std::abs(lies_m - 0.01), std::abs(lies_m - 0.015), std::abs(lies_m - 0.02)});
    EXPECT_LT(off_m, 2e-6) << lies_m;
    EXPECT_LT(simulation.state().free_velocities.linear_m_s.norm(), 1e-4);
    EXPECT_NEAR(simulation.contacts().back().force_n.y(), 0.05 * kGravity, 1e-3);
  }
}

// Down a slope of 30 degrees at mu 0.3; it stays at mu 0.7.
TEST(MeshOnMesh, AThingSlidesDownAMeshAsFrictionSays) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(-M_PI / 6, Vector3d::UnitZ()).toRotationMatrix();
  for (const double friction : {0.3, 0.7}) {
    Triangles angle = l_triangles(0.024, 0.01, 0.008), slope = box_triangles({0.04, -0.01, 0}, {0.2, 0.02, 0.08});
    angle.vertices_m = Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitX()).toRotationMatrix() * angle.vertices_m;
    angle.vertices_m.colwise() += Vector3d(-0.01, 1e-5, 0.01);
    angle.vertices_m = turn * angle.vertices_m;
    slope.vertices_m = turn * slope.vertices_m;
    Obstacle thing = free_thing("thing", shape_of(angle), 0.02);
    thing.friction_on = {{"slope", friction}};
    SolverOptions options;
    options.time_step_s = 0.002;
    options.integrator = Integrator::tr_bdf2;
    Simulation simulation = of({thing, {"slope", shape_of(slope), {}, 0.0}}, options);
    const auto along_m = [&] { return turn.col(0).dot(simulation.state().contact.free.centers_m.col(0)); };
    const double start_m = along_m();
    run(simulation, 100);
    const double way_m = 0.5 * 0.04 * kGravity * (0.5 - 0.3 * std::sqrt(0.75));
    EXPECT_NEAR(along_m() - start_m, friction < 0.5 ? way_m : 0.0, 0.02 * way_m);
  }
}

TEST(MeshOnMesh, WithXpbdAStackStands) {
  const Vector3d size_m(0.03, 0.02, 0.04);
  Obstacle block = free_thing("block", shape_of(box_triangles({0, 0.0301, 0}, size_m)), 0.05);
  block.friction_on = {{"table", 0.5}};
  Simulation simulation =
      of({{"table", shape_of(box_triangles({0, 0.01, 0}, size_m)), {}, 0.0}, block}, xpbd(20, 0.005));
  for (int i = 0; i < 100; ++i) simulation.step();
  EXPECT_NEAR(height_m(simulation, 0), 0.03, 1e-5);
  EXPECT_LT(leans_rad(simulation, 0), 1e-3);
}

// A plate of 2 mm, thrown on another one; or the step says that it is too fast.
TEST(MeshOnMesh, AFastThinThingPassesThroughNoThinOneInSilence) {
  for (const double speed_m_s : {2.0, 20.0, 200.0}) {
    Obstacle plate = free_thing("plate", shape_of(box_triangles({0.02, 0.0051, 0}, {0.04, 0.002, 0.04})), 0.01);
    plate.velocity_m_s = {0, -speed_m_s, 0};
    SolverOptions options;
    options.time_step_s = 0.005;
    Simulation simulation =
        of({plate, {"table", shape_of(box_triangles({0, 0, 0}, {0.1, 0.002, 0.1})), {}, 0.0}}, options);
    bool warns = false;
    for (int i = 0; i < 10; ++i) {
      const SolveReport report = simulation.step();
      warns = warns || !report.converged ||
              std::any_of(report.warnings.begin(), report.warnings.end(),
                          [](const SolveWarning& warning) { return warning.kind == "fast_obstacle"; });
    }
    EXPECT_TRUE(warns || height_m(simulation, 0) > 0.0019) << speed_m_s << " " << height_m(simulation, 0);
    EXPECT_TRUE(speed_m_s > 10.0 || !warns) << speed_m_s;
  }
}

TEST(MeshOnMesh, OneInsideAnotherIsRefusedAtTheStart) {
  const auto why = [&](const Triangles& other) -> std::string {
    Body body = bystander();
    try {
      body.set_obstacles({free_thing("thing", shape_of(box_triangles(kZero, {0.02, 0.02, 0.02})), 0.01),
                          {"other", shape_of(other), {}, 0.0}});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why(box_triangles({0, 0.0201, 0}, {0.02, 0.02, 0.02})), "");
  EXPECT_NE(why(box_triangles({0, 0.018, 0}, {0.02, 0.02, 0.02})).find("inside obstacle 'other' at the start"),
            std::string::npos);
  EXPECT_NE(why(box_triangles({0, 0.0, 0}, {0.1, 0.1, 0.1})).find("inside obstacle 'other'"), std::string::npos);
  // A cross of two bars: no corner of either is in the other.
  EXPECT_NE(why(box_triangles({0, 0.005, 0}, {0.1, 0.01, 0.01})).find("inside obstacle 'other'"), std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
