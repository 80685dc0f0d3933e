// SPDX-License-Identifier: BSD-3-Clause
// Rigid things that would be in one another: how deep, and that no step and no rest state ends so.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/body/mesh_solid.h"
#include "mechanics/body/rigid_depth.h"
#include "mesh_shapes.h"

namespace soft_robot_lab {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

MeshShape mesh_box(const Vector3d& center_m, const Vector3d& size_m) {
  const Triangles box = box_triangles(center_m, size_m);
  return mesh_shape(box.vertices_m, box.triangles, 0.0);
}

struct Named {
  std::string name;
  ObstacleShape shape;
};

// With their lowest places at z = 0.
std::vector<Named> things() {
  const Vector3d size_m(0.02, 0.03, 0.04);
  return {{"sphere", Sphere{{0, 0, 0.01}, 0.01}},
          {"lying capsule", Capsule{{-0.01, 0, 0.01}, {0.02, 0, 0.01}, 0.01}},
          {"standing capsule", Capsule{{0, 0, 0.01}, {0, 0, 0.03}, 0.01}},
          {"lying cylinder", Cylinder{{-0.02, 0, 0.01}, {0.02, 0, 0.01}, 0.01, 0.001}},
          {"standing cylinder", Cylinder{{0, 0, 0}, {0, 0, 0.04}, 0.01, 0.001}},
          {"disc", Cylinder{{0, 0, 0}, {0, 0, 0.004}, 0.02, 0.0005}},
          {"box", RoundedBox{{0, 0, 0.02}, size_m, 1e-4}},
          {"mesh", mesh_box({0, 0, 0.02}, size_m)}};
}

// With their tops at z = 0.
std::vector<Named> grounds() {
  const Vector3d middle_m(0.01, 0.02, -0.03), size_m(0.2, 0.2, 0.06);
  return {{"plane", Plane{{1, 2, 0}, Vector3d::UnitZ()}},
          {"box", RoundedBox{middle_m, size_m, 1e-3}},
          {"round table", Cylinder{{0, 0, -0.05}, {0, 0, 0}, 0.08, 0.002}},
          {"mesh", mesh_box(middle_m, size_m)}};
}

Isometry3d drawn_turn(std::mt19937& random) {
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  const double x = side(random), y = side(random), z = side(random);
  Isometry3d pose(Eigen::AngleAxisd(M_PI * side(random), Vector3d(x, y, z).normalized()));
  pose.translation() = Vector3d(z, x, y);
  return pose;
}

TEST(RigidOverlap, IsAsDeepAsAThingIsBelowTheTopOfAnother) {
  std::mt19937 random(7);
  for (const Named& thing : things()) {
    for (const Named& ground : grounds()) {
      const std::string name = thing.name + " in " + ground.name;
      const Isometry3d place = drawn_turn(random);
      const double allowed_m = allowed_overlap_m(thing.shape, ground.shape);
      const auto depth_m = [&](double below_m, bool swapped) {
        const Isometry3d lowered = place * Eigen::Translation3d(0, 0, -below_m);
        const PlacedShape one{thing.shape, lowered}, other{ground.shape, place};
        return swapped ? depth_beyond_m(other, one, allowed_m) : depth_beyond_m(one, other, allowed_m);
      };
      for (const double below : {-5.0, -0.5, 0.5, 0.95}) EXPECT_EQ(depth_m(below * allowed_m, false), 0.0) << name;
      EXPECT_NEAR(depth_m(1.5 * allowed_m, false), 1.5 * allowed_m, 0.02 * allowed_m) << name;
      if (ground.name != "plane") {
        EXPECT_NEAR(depth_m(1.5 * allowed_m, true), 1.5 * allowed_m, 0.02 * allowed_m) << name;
      }
    }
  }
}

// No corner of either is in the other.
TEST(RigidOverlap, SeesBarsThatCross) {
  const Vector3d along_m(0.1, 0.01, 0.01), across_m(0.01, 0.1, 0.01);
  for (const bool own_mesh : {false, true}) {
    for (const bool other_mesh : {false, true}) {
      const ObstacleShape one = own_mesh ? ObstacleShape(mesh_box(kZero, along_m)) : RoundedBox{kZero, along_m, 1e-4},
                          other =
                              other_mesh ? ObstacleShape(mesh_box(kZero, across_m)) : RoundedBox{kZero, across_m, 1e-4};
      const double allowed_m = allowed_overlap_m(one, other);
      const auto depth_m = [&](double below_m) {
        return depth_beyond_m({one, Isometry3d(Eigen::Translation3d(0, 0, 0.01 - below_m))},
                              {other, Isometry3d::Identity()}, allowed_m);
      };
      EXPECT_EQ(depth_m(-1e-4), 0.0);
      EXPECT_EQ(depth_m(0.9 * allowed_m), 0.0);
      for (const double below_m : {0.004, 0.008, 0.01, 0.012})
        EXPECT_GT(depth_m(below_m), allowed_m) << own_mesh << other_mesh << below_m;
      EXPECT_EQ(depth_m(0.0201), 0.0);
    }
  }
}

Simulation with(std::vector<Obstacle> obstacles, const SolverOptions& options) {
  Body body(box_mesh({4.99, 4.99, 4.99}, {5.01, 5.01, 5.01}, {1, 1, 1}), kSilicone);
  body.fix_nodes({4, 4, 4}, {6, 6, 6}, {true, true, true});
  body.set_gravity({0, 0, -9.81});
  body.set_obstacles(std::move(obstacles));
  return Simulation(std::move(body), {}, {}, options);
}

SolverOptions in_steps(Integrator integrator, double time_step_s) {
  SolverOptions options;
  options.integrator = integrator;
  options.time_step_s = time_step_s;
  return options;
}

bool says_so(const SolveReport& report) {
  return !report.converged && report.message.find("'bar' and 'post'") != std::string::npos &&
         std::any_of(report.warnings.begin(), report.warnings.end(),
                     [](const SolveWarning& warning) { return warning.kind == "rigid_overlap"; });
}

// A bar on a floor, and another one that a state puts half-way through it, which contact cannot see.
TEST(RigidOverlap, IsNoRestStateAndNoEndOfAStep) {
  const Vector3d middle_m(0, 0, 0.005), size_m(0.1, 0.01, 0.01), post_middle_m(0, 0, 0.03),
      post_size_m(0.01, 0.1, 0.01);
  const ObstacleShape own = RoundedBox{middle_m, size_m, 1e-4}, across = RoundedBox{post_middle_m, post_size_m, 1e-4};
  const auto simulation = [&](const SolverOptions& options, double post_m) {
    Obstacle bar{"bar", own, {}, 0.0}, post{"post", across, {}, 0.0};
    bar.mass_kg = 0.05;
    post.motion = {{0.0}, {1.0, {0, 0, post_m}}};
    bar.friction_on = {{"floor", 0.5}};
    Simulation one = with({{"floor", Plane{kZero, Vector3d::UnitZ()}, {}, 0.0}, bar, post}, options);
    SimulationState state = one.state();
    state.contact.time_s = state.contact.before_s = 1.0;
    one.set_state(state);
    return one;
  };
  for (const double post_m : {-0.01, -0.023}) {
    const bool apart = post_m == -0.01;
    for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2, Integrator::tr_bdf2}) {
      Simulation moving = simulation(in_steps(integrator, 0.005), post_m);
      const SolveReport report = moving.step();
      EXPECT_EQ(report.converged, apart) << report.message;
      EXPECT_EQ(says_so(report), !apart) << report.message;
    }
    Simulation rest = simulation({}, post_m);
    const SolveReport report = rest.solve_equilibrium();
    EXPECT_EQ(report.converged, apart) << report.message;
    EXPECT_EQ(says_so(report), !apart) << report.message;
    Simulation substeps = simulation(xpbd(20, 0.005), post_m);
    EXPECT_EQ(says_so(substeps.step()), !apart);
  }
}

// Two boxes drawn at random that fall on a floor of 10 mm and on one another, while they turn. `floor` and all of them
// may be meshes.
struct Drop {
  std::vector<Obstacle> obstacles;
  std::vector<RoundedBox> boxes;  // the floor is the first
};

Drop drawn_drop(unsigned seed, bool of_mesh, bool on_mesh) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> size(0.01, 0.04), spin(-10, 10), aside(-0.01, 0.01);
  Drop drop;
  drop.boxes.push_back({{0, 0, -0.005}, {0.3, 0.3, 0.01}, 1e-5});
  for (const double height_m : {0.05, 0.12}) {
    const double a_m = size(random), b_m = size(random), c_m = size(random), x_m = aside(random);
    drop.boxes.push_back({{x_m, aside(random), height_m}, {a_m, b_m, c_m}, 1e-5});
    const double spin_x = spin(random), spin_y = spin(random);
    Obstacle one;
    one.angular_velocity_rad_s = {spin_x, spin_y, spin(random)};
    one.mass_kg = 0.1;
    drop.obstacles.push_back(one);
  }
  drop.obstacles.insert(drop.obstacles.begin(), Obstacle{});
  const double friction = seed % 2 == 0 ? 0.0 : 0.5;
  for (std::size_t i = 0; i < drop.boxes.size(); ++i) {
    Obstacle& one = drop.obstacles[i];
    one.name = std::to_string(i);
    one.shape = drop.boxes[i];
    if (i == 0 ? on_mesh : of_mesh) one.shape = mesh_box(drop.boxes[i].center_m, drop.boxes[i].size_m);
    for (std::size_t k = 0; k < i && i > 0; ++k) one.friction_on[std::to_string(k)] = friction;
  }
  return drop;
}

// As deep as they are in one another, by the boxes that they stand for; -1: a step failed.
double deepest_m(unsigned seed, bool of_mesh, bool on_mesh, const SolverOptions& options, double end_s) {
  const Drop drop = drawn_drop(seed, of_mesh, on_mesh);
  Simulation simulation = with(drop.obstacles, options);
  double most_m = 0.0;
  std::vector<ObstacleShape> shapes(drop.boxes.begin(), drop.boxes.end());
  for (int i = 0; i * options.time_step_s < end_s; ++i) {
    const SolveReport report = simulation.step();
    EXPECT_TRUE(report.converged) << seed << ": " << report.message << " in step " << i;
    if (!report.converged) return -1.0;
    const std::vector<Isometry3d> poses = simulation.obstacle_poses();
    for (std::size_t one = 1; one < shapes.size(); ++one)
      for (std::size_t other = 0; other < one; ++other)
        most_m = std::max(most_m, -apart_m({shapes[one], poses[one]}, {shapes[other], poses[other]}));
  }
  return most_m;
}

TEST(RigidOverlap, DroppedMeshesStayApart) {
  const SolverOptions options = in_steps(Integrator::implicit_euler, 1.0 / 240.0);
  for (const unsigned seed : {2u, 4u, 12u}) EXPECT_LT(deepest_m(seed, true, true, options, 0.2), 2e-4) << seed;
}

TEST(RigidOverlap, DroppedBoxesAndMeshesStayApart) {
  for (const unsigned seed : {1u, 2u, 4u, 6u, 12u, 13u})
    EXPECT_LT(deepest_m(seed, false, true, in_steps(Integrator::implicit_euler, 1.0 / 240.0), 0.3), 2e-4) << seed;
  for (const unsigned seed : {2u, 6u})
    EXPECT_LT(deepest_m(seed, true, false, in_steps(Integrator::tr_bdf2, 1.0 / 240.0), 0.2), 2e-4) << seed;
}

// Contact sees edges that cross only to some depth: where a step led beyond that nothing held them, and they lay 14 mm
// in one another, or fell through the floor.
TEST(RigidOverlap, DroppedBoxesStayApart) {
  for (const unsigned seed : {1u, 2u, 4u, 6u, 8u, 12u, 13u, 17u, 24u}) {
    EXPECT_LT(deepest_m(seed, false, false, in_steps(Integrator::implicit_euler, 1.0 / 240.0), 0.4), 5e-5) << seed;
    EXPECT_LT(deepest_m(seed, false, false, in_steps(Integrator::tr_bdf2, 1.0 / 60.0), 0.4), 5e-5) << seed;
  }
}

}  // namespace
}  // namespace soft_robot_lab
