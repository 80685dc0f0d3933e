// SPDX-License-Identifier: BSD-3-Clause
// Free things from meshes on meshes, shapes and bodies: laid, tilted, dropped, against closed forms and shapes that are
// stated.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/body/gap.h"
#include "mechanics/body/mesh_solid.h"
#include "mechanics/body/rigid_places.h"
#include "mesh_shapes.h"

namespace soft_robot_lab {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kGravity = 9.81, kMass = 0.1;
constexpr double kDegree = M_PI / 180.0;

// The same surface of four times as many triangles, `rounds` times.
Triangles finer(Triangles from, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<int, int>, int> middles;
    std::vector<Vector3d> at;
    for (const auto& vertex : from.vertices_m.colwise()) at.emplace_back(vertex);
    const auto middle = [&](int a, int b) {
      const auto [found, fresh] = middles.emplace(std::minmax(a, b), static_cast<int>(at.size()));
      if (fresh) at.push_back(0.5 * (at[static_cast<std::size_t>(a)] + at[static_cast<std::size_t>(b)]));
      return found->second;
    };
    std::vector<Eigen::Vector3i> of;
    for (const auto& t : from.triangles.colwise()) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      for (const Eigen::Vector3i& one : {Eigen::Vector3i(t[0], ab, ca), {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}})
        of.push_back(one);
    }
    from = {Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(at.size())),
            Eigen::Matrix3Xi(3, static_cast<Eigen::Index>(of.size()))};
    for (std::size_t i = 0; i < at.size(); ++i) from.vertices_m.col(static_cast<Eigen::Index>(i)) = at[i];
    for (std::size_t i = 0; i < of.size(); ++i) from.triangles.col(static_cast<Eigen::Index>(i)) = of[i];
  }
  return from;
}

struct Solid {  // as triangles, and as a sharp shape
  Triangles surface;
  ObstacleShape twin;
};

Solid block(const Vector3d& middle_m, const Vector3d& size_m, int rounds = 0) {
  return {finer(box_triangles(middle_m, size_m), rounds), RoundedBox{middle_m, size_m, 1e-5}};
}

Solid rod(const Vector3d& start_m, const Vector3d& end_m, double radius_m, int segments = 48) {
  const double half_m = 0.5 * (end_m - start_m).norm();
  Triangles one = turned({{0, -half_m}, {radius_m, -half_m}, {radius_m, half_m}, {0, half_m}}, segments);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitY(), end_m - start_m);
  one.vertices_m = turn.toRotationMatrix() * one.vertices_m;
  one.vertices_m.colwise() += 0.5 * (start_m + end_m);
  return {one, Cylinder{start_m, end_m, radius_m, 1e-5}};
}

struct Placing {  // of a scene
  double scale = 1.0;
  Isometry3d pose = Isometry3d::Identity();
};

MeshShape shape_of(Triangles from, const Placing& placing = {}) {
  from.vertices_m *= placing.scale;
  from.vertices_m = placing.pose.linear() * from.vertices_m;
  from.vertices_m.colwise() += placing.pose.translation();
  return mesh_shape(from.vertices_m, from.triangles, 0.0);
}

Obstacle free(const std::string& name, ObstacleShape shape, const std::vector<Obstacle>& others, double friction,
              double mass_kg = kMass) {
  Obstacle one{name, std::move(shape), {}, 0.0};
  one.mass_kg = mass_kg;
  for (const Obstacle& other : others) one.friction_on[other.name] = friction;
  return one;
}

Simulation with(std::vector<Obstacle> obstacles, SolverOptions options, const Vector3d& gravity_m_s2) {
  Body body(box_mesh({4.99, 4.99, 4.99}, {5.01, 5.01, 5.01}, {1, 1, 1}), kSilicone);
  body.fix_nodes({4, 4, 4}, {6, 6, 6}, {true, true, true});
  body.set_gravity(gravity_m_s2);
  body.set_obstacles(std::move(obstacles));
  return Simulation(std::move(body), {}, {}, options);
}

Vector3d center_m(const Simulation& simulation, int free = 0) {
  return simulation.state().contact.free.centers_m.col(free);
}

double turned_rad(const Simulation& simulation, int free = 0) {
  return Eigen::AngleAxisd(Eigen::Quaterniond(Eigen::Vector4d(simulation.state().contact.free.turns.col(free))))
      .angle();
}

Vector3d force_n(const Simulation& simulation, const std::string& on) {
  Vector3d sum_n = kZero;
  for (const ContactReading& reading : simulation.contacts()) {
    if (reading.on == on) sum_n += reading.force_n;
    if (reading.surface == on) sum_n -= reading.force_n;
  }
  return sum_n;
}

// An outline of radii and heights, counter-clockwise, turned about the y axis.
Triangles tube(const std::vector<Eigen::Vector2d>& outline, int segments) {
  const int rings = static_cast<int>(outline.size());
  std::vector<Vector3d> corners;
  std::vector<std::array<int, 4>> quads;
  for (int i = 0; i < segments; ++i) {
    const double angle_rad = 2.0 * M_PI * i / segments;
    for (int ring = 0; ring < rings; ++ring) {
      const Eigen::Vector2d& at = outline[static_cast<std::size_t>(ring)];
      corners.emplace_back(at.x() * std::cos(angle_rad), at.y(), at.x() * std::sin(angle_rad));
      const int next = (ring + 1) % rings, beside = (i + 1) % segments;
      quads.push_back({i * rings + ring, i * rings + next, beside * rings + next, beside * rings + ring});
    }
  }
  return of_quads(corners, quads);
}

struct Laid {
  std::string name;
  std::vector<Solid> below;
  Solid above;
};

Triangles turned_about(Triangles one, const Vector3d& at_m, const Vector3d& turn_rad) {
  one.vertices_m.colwise() -= at_m;
  one.vertices_m = Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()).toRotationMatrix() * one.vertices_m;
  one.vertices_m.colwise() += at_m;
  return one;
}

Solid plate(double x_m = 0.0, double y_m = 0.0, int rounds = 0) {
  return block({x_m, y_m, 0.005}, {0.1, 0.1, 0.01}, rounds);
}
Solid post(double width_m = 0.02, int rounds = 0) { return block({0, 0, -0.05}, {width_m, width_m, 0.1}, rounds); }
Solid post_turned(double turn_rad) {
  Solid one = post();
  one.surface = turned_about(one.surface, kZero, {0, 0, turn_rad});
  return one;
}

// All balance where they are, and touch at z = 0.
std::vector<Laid> laid() {
  return {
      {"a plate on a post", {post()}, plate()},
      {"of many triangles", {post(0.02, 2)}, plate(0, 0, 3)},
      {"on one turned by 30 degrees", {post_turned(30 * kDegree)}, plate()},
      {"on one turned by 45 degrees", {post_turned(45 * kDegree)}, plate()},
      {"on a thin one", {post(0.005)}, plate()},
      {"on two", {block({-0.045, 0, -0.05}, {0.01, 0.01, 0.1}), block({0.045, 0, -0.05}, {0.01, 0.01, 0.1})}, plate()},
      {"on a round one", {rod({0, 0, -0.1}, kZero, 0.01)}, plate()},
      {"on a block that is larger", {block({0, 0, -0.05}, {0.3, 0.3, 0.1})}, plate()},
      {"on a block that is equal", {block({0, 0, -0.05}, {0.1, 0.1, 0.1})}, plate()},
      {"off the middle", {post()}, plate(0.008, -0.008)},
      {"a bar across a bar", {block({0, 0, -0.005}, {0.1, 0.01, 0.01})}, block({0, 0, 0.005}, {0.01, 0.1, 0.01})},
      {"off its middle", {block({0, 0, -0.005}, {0.1, 0.01, 0.01})}, block({0.01, 0.003, 0.005}, {0.01, 0.1, 0.01})},
      {"off its middle the other way",
       {block({0, 0, -0.005}, {0.1, 0.01, 0.01})},
       block({0.01, -0.003, 0.005}, {0.01, 0.1, 0.01})},
      {"a rod on end on a block", {block({0, 0, -0.05}, {0.3, 0.3, 0.1})}, rod(kZero, {0, 0, 0.04}, 0.01)},
      {"on a thin post", {post(0.01)}, rod(kZero, {0, 0, 0.04}, 0.02)},
      {"on another rod", {rod({0, 0, -0.1}, kZero, 0.01)}, rod({0.003, 0, 0}, {0.003, 0, 0.04}, 0.01)},
  };
}

enum class Pairing { meshes, above, below };  // which are meshes

std::vector<Obstacle> obstacles_of(const Laid& one, Pairing pairing, double friction, const Placing& placing = {}) {
  std::vector<Obstacle> all;
  for (const Solid& solid : one.below)
    all.push_back({"below_" + std::to_string(all.size()),
                   pairing == Pairing::above ? solid.twin : ObstacleShape(shape_of(solid.surface, placing)),
                   {},
                   0.0});
  const double mass_kg = kMass * std::pow(placing.scale, 3);
  all.push_back(free("it",
                     pairing == Pairing::below ? one.above.twin : ObstacleShape(shape_of(one.above.surface, placing)),
                     all, friction, mass_kg));
  return all;
}

void expect_stays(const std::string& name, Simulation& simulation, const Vector3d& start_m, double scale,
                  const Vector3d& gravity_m_s2, double moves_m, double turns_rad) {
  const Vector3d weight_n = kMass * std::pow(scale, 3) * gravity_m_s2;
  EXPECT_LT((center_m(simulation) - start_m).norm(), moves_m * scale) << name;
  EXPECT_LT(turned_rad(simulation), turns_rad) << name;
  EXPECT_LT((force_n(simulation, "it") + weight_n).norm(), 2e-3 * weight_n.norm()) << name;
}

Isometry3d drawn_pose(std::mt19937& random, double far_m) {
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  const auto any = [&] {
    const double x = side(random), y = side(random), z = side(random);
    return Vector3d(x, y, z);
  };
  const Vector3d axis = any().normalized(), way_m = far_m * any();
  return Eigen::Translation3d(way_m) * Eigen::AngleAxisd(M_PI * side(random), axis);
}

std::vector<Placing> placings() {
  std::mt19937 random(5);
  return {{}, {0.1, Isometry3d::Identity()}, {10.0, Isometry3d::Identity()}, {1.0, drawn_pose(random, 0.3)}};
}

void expect_stays_in_time(const std::string& name, Simulation& simulation, double scale, const Vector3d& gravity_m_s2) {
  const Vector3d start_m = center_m(simulation);
  for (int i = 0; i < 24; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << name << ": " << report.message << " in step " << i;
  }
  expect_stays(name, simulation, start_m, scale, gravity_m_s2, 1e-5, 1e-3);
}

SolverOptions with_integrator(Integrator integrator) {
  SolverOptions options;
  options.time_step_s = 1.0 / 240.0;
  options.integrator = integrator;
  return options;
}

// Each in one placing, but those of these kinds in all.
bool is_looked_at(std::size_t scene, std::size_t placing) {
  return scene % 4 == placing || laid()[scene].name == "off its middle" || laid()[scene].name == "a plate on a post";
}

TEST(MeshLaid, StaysInTime) {
  for (std::size_t count = 0; count < placings().size(); ++count) {
    const Placing placing = placings()[count];
    for (std::size_t scene = 0; scene < laid().size(); ++scene) {
      if (!is_looked_at(scene, count)) continue;
      const Laid one = laid()[scene];
      const auto integrator = (count + scene / 4) % 2 == 0 ? Integrator::implicit_euler : Integrator::tr_bdf2;
      const Vector3d gravity = placing.pose.linear() * Vector3d(0, 0, -kGravity);
      Simulation simulation =
          with(obstacles_of(one, Pairing::meshes, 0.5, placing), with_integrator(integrator), gravity);
      expect_stays_in_time(one.name + " x " + std::to_string(placing.scale), simulation, placing.scale, gravity);
    }
  }
}

// Of two rods end on end no equilibrium is found: it says so.
TEST(MeshLaid, IsInEquilibrium) {
  for (std::size_t count = 0; count < placings().size(); ++count) {
    const Placing placing = placings()[count];
    for (std::size_t scene = 0; scene < laid().size(); ++scene) {
      if (!is_looked_at(scene, (count + 1) % 4)) continue;
      const Laid one = laid()[scene];
      const Vector3d gravity = placing.pose.linear() * Vector3d(0, 0, -kGravity);
      Simulation simulation = with(obstacles_of(one, Pairing::meshes, 0.5, placing), {}, gravity);
      const Vector3d start_m = center_m(simulation);
      const std::string name = one.name + " x " + std::to_string(placing.scale);
      const SolveReport report = simulation.solve_equilibrium();
      EXPECT_TRUE(report.converged || one.name == "on another rod") << name << ": " << report.message;
      if (report.converged) expect_stays(name, simulation, start_m, placing.scale, gravity, 1e-5, 1e-3);
    }
  }
}

TEST(MeshLaid, OnShapesAndUnderThem) {
  for (const Pairing pairing : {Pairing::above, Pairing::below}) {
    for (const Laid& one : laid()) {
      if (one.name.find("turned") != std::string::npos && pairing == Pairing::above) continue;  // its twin is not
      const Vector3d gravity(0, 0, -kGravity);
      Simulation rest = with(obstacles_of(one, pairing, 0.5), {}, gravity);
      const std::string name = one.name + (pairing == Pairing::above ? " on shapes" : " of a shape");
      const Vector3d start_m = center_m(rest);
      const SolveReport report = rest.solve_equilibrium();
      EXPECT_TRUE(report.converged) << name << ": " << report.message;
      if (report.converged) expect_stays(name + " at rest", rest, start_m, 1.0, gravity, 1e-5, 1e-3);
      Simulation simulation =
          with(obstacles_of(one, pairing, 0.5), with_integrator(Integrator::implicit_euler), gravity);
      expect_stays_in_time(name, simulation, 1.0, gravity);
    }
  }
}

TEST(MeshLaid, WithXpbdStays) {
  for (const Laid& one : laid()) {
    Simulation simulation = with(obstacles_of(one, Pairing::meshes, 0.5), xpbd(20, 0.005), {0, 0, -kGravity});
    const Vector3d start_m = center_m(simulation);
    for (int i = 0; i < 20; ++i) simulation.step();
    EXPECT_LT((center_m(simulation) - start_m).norm(), 2e-5) << one.name;
    EXPECT_LT(turned_rad(simulation), 2e-3) << one.name;
  }
}

struct Stands {
  bool in_time, at_rest;
};

// On a slope, with as much friction as holds it; for so many steps.
Stands stands(const ObstacleShape& below, const ObstacleShape& above, double angle_rad, int steps) {
  const Vector3d gravity = kGravity * Vector3d(std::sin(angle_rad), 0, -std::cos(angle_rad));
  std::vector<Obstacle> all{{"below", below, {}, 0.0}};
  all.push_back(free("it", above, all, 2.0));
  Simulation moving = with(all, with_integrator(Integrator::implicit_euler), gravity), rest = with(all, {}, gravity);
  for (int i = 0; i < steps && turned_rad(moving) < 0.3; ++i) EXPECT_TRUE(moving.step().converged);
  const bool found = rest.solve_equilibrium().converged;
  return {turned_rad(moving) < 0.01, found && turned_rad(rest) < 0.01};
}

// 20 x 20 mm and 60 mm high: tan of 18.43 degrees is 1 / 3.
TEST(MeshLaid, ABlockTipsWhereItsWeightPassesItsEdge) {
  const double limit_rad = std::atan(1.0 / 3.0);
  const Solid thing = block({0, 0, 0.03}, {0.02, 0.02, 0.06}), table = block({0, 0, -0.01}, {0.2, 0.2, 0.02}),
              equal = block({0, 0, -0.03}, {0.02, 0.02, 0.06});
  const RoundedBox stated{{0, 0, 0.03}, {0.02, 0.02, 0.06}, 1e-5};
  const Plane plane{kZero, Vector3d::UnitZ()};
  struct Case {
    std::string name;
    ObstacleShape below, above;
  };
  const Case cases[] = {{"box on plane", plane, stated},
                        {"mesh on plane", plane, shape_of(thing.surface)},
                        {"mesh on box", RoundedBox{{0, 0, -0.01}, {0.2, 0.2, 0.02}, 1e-3}, shape_of(thing.surface)},
                        {"mesh on mesh", shape_of(table.surface), shape_of(thing.surface)},
                        {"fine mesh on mesh", shape_of(table.surface), shape_of(finer(thing.surface, 2))},
                        {"box on mesh", shape_of(table.surface), stated},
                        {"mesh on its equal", shape_of(equal.surface), shape_of(thing.surface)}};
  for (const Case& one : cases) {
    const Stands before = stands(one.below, one.above, 0.99 * limit_rad, 60),
                 after = stands(one.below, one.above, 1.01 * limit_rad, 200);
    EXPECT_TRUE(before.in_time && before.at_rest) << one.name << before.in_time << before.at_rest;
    EXPECT_FALSE(after.in_time || after.at_rest) << one.name << after.in_time << after.at_rest;
  }
}

Solid drawn(const Vector3d& middle_m, std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.01, 0.04);
  const double a_m = size(random), b_m = size(random), c_m = size(random);
  return block(middle_m, {a_m, b_m, c_m});
}

// Dropped on one another and on a floor while they tumble. How deep they are is that of the shapes that are stated.
TEST(MeshLaid, ThingsDrawnAtRandomGoIntoNone) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> spin(-10, 10);
    const Solid below = drawn(kZero, random), above = drawn({0, 0, 0.08}, random);
    const Isometry3d turn(drawn_pose(random, 0.0).linear());
    std::vector<Obstacle> all{{"floor", shape_of(block({0, 0, -0.1}, {0.3, 0.3, 0.1}).surface), {}, 0.0},
                              {"below", shape_of(below.surface, {1.0, turn}), {}, 0.0}};
    all.push_back(free("it", shape_of(above.surface), all, seed % 2 ? 0.5 : 0.0));
    const double spin_x = spin(random), spin_y = spin(random);
    all.back().angular_velocity_rad_s = {spin_x, spin_y, spin(random)};
    const double step_m = std::max(std::get<MeshShape>(all[1].shape).solid->rounding_m(),
                                   std::get<MeshShape>(all[2].shape).solid->rounding_m());
    Simulation simulation =
        with(all, with_integrator(seed % 3 ? Integrator::implicit_euler : Integrator::tr_bdf2), {0, 0, -kGravity});
    simulation.keep_energy_ledger();
    const auto energy_j = [&] { return simulation.energy_ledger()->kinetic_j + simulation.energy_ledger()->gravity_j; };
    const double start_j = energy_j();
    double most_m = 0.0, most_j = start_j;
    bool too_fast = false;
    for (int i = 0; i < 75 && !too_fast; ++i) {
      const SolveReport report = simulation.step();
      ASSERT_TRUE(report.converged) << seed << ": " << report.message << " in step " << i;
      too_fast = std::any_of(report.warnings.begin(), report.warnings.end(),
                             [](const SolveWarning& warning) { return warning.kind == "fast_obstacle"; });
      if (too_fast) continue;
      const FreePoses& poses = simulation.state().contact.free;
      Isometry3d pose(Eigen::Quaterniond(Eigen::Vector4d(poses.turns.col(0))));
      pose.translation() = poses.centers_m.col(0) - pose.linear() * Vector3d(0, 0, 0.08);
      most_m =
          std::max({most_m, -apart_m({above.twin, pose}, {below.twin, turn}),
                    -apart_m({above.twin, pose}, {Plane{{0, 0, -0.05}, Vector3d::UnitZ()}, Isometry3d::Identity()})});
      if (i > 10) most_j = std::max(most_j, energy_j());
    }
    EXPECT_LT(most_m, 0.5 * step_m) << seed;
    EXPECT_LT(most_j, start_j + 1e-3 * kMass * kGravity * 0.1) << seed;
  }
}

// A cap on a peg, and a ring that falls along it: edges beyond their thin walls do not touch it.
TEST(MeshLaid, HollowThingsGoOverAPeg) {
  const auto hollow = [](bool with_roof) {
    // About z, 40 mm high, 2 mm thick, with its foot at z = 0; a roof of 5 mm.
    Triangles one = with_roof
                        ? turned({{0, 0.035}, {0.012, 0.035}, {0.012, 0}, {0.014, 0}, {0.014, 0.04}, {0, 0.04}}, 16)
                        : tube({{0.012, 0.0}, {0.014, 0.0}, {0.014, 0.04}, {0.012, 0.04}}, 16);
    return turned_about(one, kZero, {M_PI / 2, 0, 0});
  };
  const Solid peg = block({0, 0, 0.03}, {0.014, 0.014, 0.06});
  for (const bool with_roof : {true, false}) {
    Triangles over = hollow(with_roof);
    const double start_m = with_roof ? 0.0252 : 0.03;
    over.vertices_m.row(2).array() += start_m;
    std::vector<Obstacle> all{{"peg", shape_of(peg.surface), {}, 0.0}};
    all.push_back(free("it", shape_of(over), all, 0.5));
    Simulation simulation = with(all, with_integrator(Integrator::tr_bdf2), {0, 0, -kGravity});
    const double before_m = center_m(simulation).z();
    for (int i = 0; i < 36; ++i) ASSERT_TRUE(simulation.step().converged) << with_roof << i;
    const double fallen_m = with_roof ? 0.0002 : 0.5 * kGravity * 0.15 * 0.15;
    EXPECT_NEAR(before_m - center_m(simulation).z(), fallen_m, 1e-5) << with_roof;
    EXPECT_LT(turned_rad(simulation), 1e-4) << with_roof;
  }
}

}  // namespace
}  // namespace soft_robot_lab
