// SPDX-License-Identifier: BSD-3-Clause
// Rigid things against one another, in time and at rest: closed forms, and things drawn at random.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/body/gap.h"
#include "mechanics/body/rigid_places.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81, kMass = 0.1;
constexpr double kDegree = M_PI / 180.0;

Obstacle fixed(const std::string& name, ObstacleShape shape, const Vector3d& rotation_rad = kZero) {
  Obstacle one{name, std::move(shape), {}, 0.0};
  if (!rotation_rad.isZero(0.0)) one.motion = {{0.0, kZero, rotation_rad}};
  return one;
}

// It rubs on all others.
Obstacle free(const std::string& name, ObstacleShape shape, const std::vector<Obstacle>& others,
              double friction = 0.5) {
  Obstacle one{name, std::move(shape), {}, 0.0};
  one.mass_kg = kMass;
  for (const Obstacle& other : others) one.friction_on[other.name] = friction;
  return one;
}

// Far away there is a body that does not move.
Simulation with(std::vector<Obstacle> obstacles, Integrator integrator = Integrator::implicit_euler,
                double time_step_s = 1.0 / 240.0, const Vector3d& gravity_m_s2 = {0, 0, -kGravity}) {
  Body body(box_mesh({4.99, 4.99, 4.99}, {5.01, 5.01, 5.01}, {1, 1, 1}), kSilicone);
  body.fix_nodes({4, 4, 4}, {6, 6, 6}, {true, true, true});
  body.set_gravity(gravity_m_s2);
  body.set_obstacles(std::move(obstacles));
  SolverOptions options;
  options.time_step_s = time_step_s;
  options.integrator = integrator;
  return Simulation(std::move(body), {}, {}, options);
}

void run(Simulation& simulation, double duration_s) {
  const auto steps = std::lround(duration_s / simulation.options().time_step_s);
  for (long i = 0; i < steps; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message << " at " << simulation.state().time_s << " s";
  }
}

Vector3d center_m(const Simulation& simulation, int free = 0) {
  return simulation.state().contact.free.centers_m.col(free);
}

double turned_rad(const Simulation& simulation) {
  return Eigen::AngleAxisd(Eigen::Quaterniond(Eigen::Vector4d(simulation.state().contact.free.turns.col(0)))).angle();
}

// Of all obstacles on this one.
Vector3d force_n(const Simulation& simulation, const std::string& on) {
  Vector3d sum_n = kZero;
  for (const ContactReading& reading : simulation.contacts()) {
    if (reading.on == on) sum_n += reading.force_n;
    if (reading.surface == on) sum_n -= reading.force_n;
  }
  return sum_n;
}

PlacedShape placed(const Simulation& simulation, const Obstacle& obstacle) {
  if (!obstacle.is_free()) return {obstacle.shape, pose_at(obstacle, simulation.state().time_s)};
  const FreePoses& poses = simulation.state().contact.free;
  Eigen::Isometry3d pose(Eigen::Quaterniond(Eigen::Vector4d(poses.turns.col(0))));
  pose.translation() = poses.centers_m.col(0) - pose.linear() * soft_robot_lab::center_m(obstacle.shape);
  return {obstacle.shape, pose};
}

// How deep the last obstacle, which alone is free, is in another one.
double deepest_m(const Simulation& simulation) {
  const std::vector<Obstacle>& all = simulation.body().obstacles();
  double deepest_m = 0.0;
  for (std::size_t i = 0; i + 1 < all.size(); ++i)
    deepest_m = std::max(deepest_m, -apart_m(placed(simulation, all.back()), placed(simulation, all[i])));
  return deepest_m;
}

RoundedBox box(const Vector3d& center_m, const Vector3d& size_m) {
  return {center_m, size_m, 0.05 * size_m.minCoeff()};
}
Cylinder cylinder(const Vector3d& start_m, const Vector3d& end_m, double radius_m) {
  return {start_m, end_m, radius_m, 0.1 * radius_m};
}
RoundedBox plate(double x_m = 0.0, double y_m = 0.0) { return box({x_m, y_m, 0.005}, {0.1, 0.1, 0.01}); }
RoundedBox post(double width_m = 0.02) { return box({0, 0, -0.05}, {width_m, width_m, 0.1}); }

struct Laid {
  std::string name;
  std::vector<Obstacle> below;
  ObstacleShape above;
};

// All balance where they are, and touch at z = 0.
std::vector<Laid> laid() {
  const double askew_m = 0.05 * std::sqrt(0.5), edge_m = 0.01 * (std::sqrt(2.0) * 0.9 + 0.1);
  const Obstacle lying = fixed("below", Capsule{{-0.05, 0, -0.01}, {0.05, 0, -0.01}, 0.01});
  const auto on = [](ObstacleShape shape, const Vector3d& rotation_rad = kZero) {
    return std::vector<Obstacle>{fixed("below", std::move(shape), rotation_rad)};
  };
  return {
      {"a plate on a post", on(post()), plate()},
      {"on one turned by 30 degrees", on(post(), {0, 0, 30 * kDegree}), plate()},
      {"on one turned by 45 degrees", on(post(), {0, 0, 45 * kDegree}), plate()},
      {"on a thin one", on(post(0.005)), plate()},
      {"on a needle", on(post(0.0005)), plate()},
      {"on two",
       {fixed("left", box({-0.045, 0, -0.05}, {0.01, 0.01, 0.1})),
        fixed("right", box({0.045, 0, -0.05}, {0.01, 0.01, 0.1}))},
       plate()},
      {"on a round one", on(cylinder({0, 0, -0.1}, kZero, 0.01)), plate()},
      {"on a cylinder that lies", on(cylinder({-0.02, 0, -0.01}, {0.02, 0, -0.01}, 0.01)), plate()},
      {"on a capsule that lies", {lying}, plate()},
      {"on a capsule that stands", on(Capsule{{0, 0, -0.1}, {0, 0, -0.01}, 0.01}), plate()},
      {"on a ball", on(Sphere{{0, 0, -0.01}, 0.01}), plate()},
      {"on a block that is larger", on(box({0, 0, -0.05}, {0.3, 0.3, 0.1})), plate()},
      {"off the middle", on(post()), plate(0.008, -0.008)},
      {"a bar across a bar", on(box({0, 0, -0.005}, {0.1, 0.01, 0.01})), box({0, 0, 0.005}, {0.01, 0.1, 0.01})},
      {"a bar across an edge", on(box({0, 0, -edge_m}, {0.02, 0.1, 0.02}), {0, 45 * kDegree, 0}),
       box({0, 0, 0.01}, {0.1, 0.02, 0.02})},
      {"a capsule across a capsule", {lying}, Capsule{{0, -0.05, 0.01}, {0, 0.05, 0.01}, 0.01}},
      {"a cylinder across a post", on(post()), cylinder({0, -0.05, 0.01}, {0, 0.05, 0.01}, 0.01)},
      {"a cylinder askew across a post", on(post()),
       cylinder({-askew_m, -askew_m, 0.01}, {askew_m, askew_m, 0.01}, 0.01)},
      {"a cylinder on end on a block", on(box({0, 0, -0.05}, {0.3, 0.3, 0.1})), cylinder(kZero, {0, 0, 0.04}, 0.01)},
      {"on a plane", on(Plane{kZero, Vector3d::UnitZ()}), cylinder(kZero, {0, 0, 0.04}, 0.01)},
      {"on a thin post", on(post(0.01)), cylinder(kZero, {0, 0, 0.04}, 0.02)},
      {"on another cylinder", on(cylinder({0, 0, -0.1}, kZero, 0.01)), cylinder({0.003, 0, 0}, {0.003, 0, 0.04}, 0.01)},
  };
}

TEST(RigidContact, WhatIsLaidOnAnotherStays) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::tr_bdf2}) {
    for (const Laid& one : laid()) {
      std::vector<Obstacle> all = one.below;
      all.push_back(free("it", one.above, all));
      Simulation simulation = with(std::move(all), integrator);
      const Vector3d start_m = center_m(simulation);
      run(simulation, 0.2);
      EXPECT_LT((center_m(simulation) - start_m).norm(), 1e-5) << one.name;
      EXPECT_LT(turned_rad(simulation), 1e-3) << one.name;
      EXPECT_LT((force_n(simulation, "it") - Vector3d(0, 0, kMass * kGravity)).norm(), 1e-3) << one.name;
    }
  }
}

TEST(RigidContact, WhatIsLaidOnAnotherIsInEquilibrium) {
  for (const double friction : {0.0, 0.5}) {
    for (const Laid& one : laid()) {
      std::vector<Obstacle> all = one.below;
      all.push_back(free("it", one.above, all, friction));
      Simulation simulation = with(std::move(all));
      const Vector3d start_m = center_m(simulation);
      const SolveReport report = simulation.solve_equilibrium();
      EXPECT_TRUE(report.converged) << one.name << ": " << report.message;
      EXPECT_LT((center_m(simulation) - start_m).norm(), 1e-5) << one.name;
      EXPECT_LT((force_n(simulation, "it") - Vector3d(0, 0, kMass * kGravity)).norm(), 1e-3) << one.name;
    }
  }
}

TEST(RigidContact, AStackStays) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::tr_bdf2}) {
    for (const double width_m : {0.02, 0.06}) {
      std::vector<Obstacle> all{fixed("floor", Plane{kZero, Vector3d::UnitZ()})};
      all.push_back(free("lower", box({0, 0, 0.01}, {0.02, 0.02, 0.02}), all));
      all.push_back(free("upper", box({0.002, 0.003, 0.03}, {width_m, width_m, 0.02}), all));
      Simulation simulation = with(std::move(all), integrator);
      run(simulation, 0.2);
      EXPECT_LT((center_m(simulation, 0) - Vector3d(0, 0, 0.01)).norm(), 1e-6);
      EXPECT_LT((center_m(simulation, 1) - Vector3d(0.002, 0.003, 0.03)).norm(), 1e-6);
      EXPECT_LT((force_n(simulation, "floor") + Vector3d(0, 0, 2 * kMass * kGravity)).norm(), 1e-4);
      EXPECT_LT((force_n(simulation, "upper") - Vector3d(0, 0, kMass * kGravity)).norm(), 1e-4);
    }
  }
}

// Its middle is beside the post, or beyond a corner.
TEST(RigidContact, APlateTipsOverTheEdgeOfAPost) {
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::tr_bdf2}) {
    for (const Vector3d& off_m : {Vector3d(0.02, 0, 0), Vector3d(0.012, 0.012, 0)}) {
      const std::vector<Obstacle> below{fixed("below", post())};
      Simulation simulation = with({below[0], free("it", plate(off_m.x(), off_m.y()), below)}, integrator);
      double most_m = 0.0;
      for (int i = 0; i < 48; ++i) {
        ASSERT_TRUE(simulation.step().converged);
        most_m = std::max(most_m, deepest_m(simulation));
      }
      EXPECT_GT(turned_rad(simulation), 0.7);
      EXPECT_LT(center_m(simulation).z(), 0.0);
      EXPECT_LT(most_m, 5e-5);
    }
  }
}

// Down a slope of 10 degrees by share g sin t^2 / 2: 5/7 of a ball, 2/3 of a cylinder, of a capsule by its inertia.
TEST(RigidContact, RoundThingsRollWithoutSlip) {
  constexpr double kRadius = 0.01, kLength = 0.04, kAngle = 10.0 * kDegree, kTime = 0.3;
  const double tube = kLength / (kLength + 4.0 / 3.0 * kRadius);
  struct Rolling {
    std::string name;
    ObstacleShape shape;
    double share;
  };
  const Vector3d half_m(0, 0.5 * kLength, 0), middle_m(0, 0, kRadius);
  const Rolling rolling[] = {
      {"ball", Sphere{middle_m, kRadius}, 5.0 / 7.0},
      {"cylinder", cylinder(middle_m - half_m, middle_m + half_m, kRadius), 2.0 / 3.0},
      {"disc", Cylinder{middle_m - 0.05 * half_m, middle_m + 0.05 * half_m, kRadius, 1e-4}, 2.0 / 3.0},
      {"capsule", Capsule{middle_m - half_m, middle_m + half_m, kRadius}, 1.0 / (1.4 + 0.1 * tube)}};
  const ObstacleShape grounds[] = {Plane{kZero, Vector3d::UnitZ()}, box({0.2, 0, -0.05}, {0.6, 0.2, 0.1}),
                                   box({0.2, 0, -0.05}, {0.6, 0.01, 0.1})};
  for (const Rolling& one : rolling) {
    for (const ObstacleShape& ground : grounds) {
      for (const Integrator integrator : {Integrator::implicit_euler, Integrator::tr_bdf2}) {
        const double step_s = integrator == Integrator::tr_bdf2 ? 1.0 / 240.0 : 1.0 / 500.0;
        const std::vector<Obstacle> below{fixed("below", ground)};
        Simulation simulation = with({below[0], free("it", one.shape, below)}, integrator, step_s,
                                     kGravity * Vector3d(std::sin(kAngle), 0, -std::cos(kAngle)));
        run(simulation, kTime);
        const double expected_m = 0.5 * one.share * kGravity * std::sin(kAngle) * kTime * kTime;
        EXPECT_NEAR(center_m(simulation).x(), expected_m, 0.01 * expected_m) << one.name << " " << ground.index();
        EXPECT_NEAR(center_m(simulation).z(), kRadius, 1e-6) << one.name << " " << ground.index();
      }
    }
  }
}

// On rails that lie a little askew, edges of its own side cross theirs under all small angles.
TEST(RigidContact, ACylinderRollsOnRailsThatAreNearlyAlongIt) {
  for (const double askew_rad : {1e-7, 1e-5, 1e-3}) {
    const Vector3d turn_rad(0, 0, M_PI / 2 - askew_rad);
    std::vector<Obstacle> all{fixed("left", box({-0.012, 0, -0.01}, {0.2, 0.01, 0.02}), turn_rad),
                              fixed("right", box({0.012, 0, -0.01}, {0.2, 0.01, 0.02}), turn_rad)};
    // Between both it touches edges at x = -7 and 7 mm.
    const double rounding_m = 0.05 * 0.01, x_m = 0.007 + rounding_m, r_m = 0.01 + rounding_m;
    const double z_m = -rounding_m + std::sqrt(r_m * r_m - x_m * x_m);
    all.push_back(free("it", cylinder({0, -0.03, z_m + 1e-4}, {0, 0.03, z_m + 1e-4}, 0.01), all));
    Simulation simulation = with(std::move(all));
    run(simulation, 0.2);
    EXPECT_NEAR(center_m(simulation).z(), z_m, 2e-5) << askew_rad;
    EXPECT_LT(deepest_m(simulation), 1e-6) << askew_rad;
    EXPECT_NEAR(force_n(simulation, "it").z(), kMass * kGravity, 0.01 * kMass * kGravity) << askew_rad;
  }
}

ObstacleShape drawn(const Vector3d& middle_m, std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.004, 0.03);
  const double a_m = size(random), b_m = size(random), c_m = size(random);
  switch (random() % 4) {
    case 0:
      return Sphere{middle_m, a_m};
    case 1:
      return Capsule{middle_m - Vector3d(b_m, 0, 0), middle_m + Vector3d(b_m, 0, 0), 0.5 * a_m};
    case 2:
      return Cylinder{middle_m - Vector3d(0, 0, b_m), middle_m + Vector3d(0, 0, b_m), a_m, 0.1 * std::min(a_m, b_m)};
    default:
      return RoundedBox{middle_m, 2.0 * Vector3d(a_m, b_m, c_m), 0.1 * std::min({a_m, b_m, c_m})};
  }
}

// Dropped on one another and on a floor while they tumble.
TEST(RigidContact, ThingsDrawnAtRandomGoIntoNone) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> spin(-10, 10), turn(-2, 2), aside(-0.01, 0.01);
    const auto three = [&](auto& distribution) {
      const double x = distribution(random), y = distribution(random), z = distribution(random);
      return Vector3d(x, y, z);
    };
    const ObstacleShape below = drawn(kZero, random);
    std::vector<Obstacle> all{fixed("floor", Plane{{0, 0, -0.05}, Vector3d::UnitZ()}),
                              fixed("below", below, three(turn))};
    all.push_back(free("it", drawn(Vector3d(0, 0, 0.1) + three(aside), random), all, seed % 2 ? 0.5 : 0.0));
    all.back().angular_velocity_rad_s = three(spin);
    Simulation simulation = with(std::move(all), seed % 3 ? Integrator::implicit_euler : Integrator::tr_bdf2);
    simulation.keep_energy_ledger();
    const auto energy_j = [&] { return simulation.energy_ledger()->kinetic_j + simulation.energy_ledger()->gravity_j; };
    const double start_j = energy_j(), room_j = 1e-3 * kMass * kGravity * 0.1;
    double most_m = 0.0, most_j = start_j;
    int failed = 0;
    for (int i = 0; i < 150; ++i) {
      const SolveReport report = simulation.step();
      failed += report.converged ? 0 : 1;
      most_m = std::max(most_m, deepest_m(simulation));
      if (i > 10) most_j = std::max(most_j, energy_j());
    }
    EXPECT_EQ(failed, 0) << seed;
    EXPECT_LT(most_m, 5e-5) << seed;
    EXPECT_LT(most_j, start_j + room_j) << seed;
  }
}

// 33 mm in a step: a plate comes down beside its middle on a needle, a bar on a bar. Or the step says that it is too
// fast.
TEST(RigidContact, WhatIsFastPassesThroughNothingInSilence) {
  struct Falling {
    std::string name;
    ObstacleShape below, above;
  };
  const Falling falling[] = {
      {"plate on needle", box({0.04, 0.03, -0.05}, {0.004, 0.004, 0.1}), box({0, 0, 0.02}, {0.1, 0.1, 0.004})},
      {"bar on bar", box({0, 0, -0.002}, {0.1, 0.004, 0.004}), box({0.03, 0.03, 0.02}, {0.004, 0.1, 0.004})},
      {"capsule on capsule", Capsule{{-0.05, 0, -0.002}, {0.05, 0, -0.002}, 0.002},
       Capsule{{0.03, -0.05, 0.02}, {0.03, 0.05, 0.02}, 0.002}},
      {"cylinder on disc", cylinder({0, 0, -0.004}, {0, 0, 0}, 0.02),
       cylinder({0.01, -0.05, 0.02}, {0.01, 0.05, 0.02}, 0.003)}};
  for (const Falling& one : falling) {
    for (const double speed_m_s : {2.0, 200.0}) {
      const std::vector<Obstacle> below{fixed("below", one.below)};
      std::vector<Obstacle> all{below[0], free("it", one.above, below)};
      all[1].velocity_m_s = {0, 0, -speed_m_s};
      Simulation simulation = with(std::move(all), Integrator::implicit_euler, 1.0 / 60.0);
      const SolveReport report = simulation.step();
      const bool warns = std::any_of(report.warnings.begin(), report.warnings.end(),
                                     [](const SolveWarning& warning) { return warning.kind == "fast_obstacle"; });
      EXPECT_EQ(warns, speed_m_s > 100.0) << one.name << " " << speed_m_s;
      if (warns) continue;
      EXPECT_GT(simulation.state().free_velocities.linear_m_s(2, 0), -0.9 * speed_m_s) << one.name << " " << speed_m_s;
      EXPECT_LT(deepest_m(simulation), 1e-4) << one.name << " " << speed_m_s;
    }
  }
}

TEST(RigidContact, RefusesBarsThroughOneAnother) {
  const std::vector<Obstacle> below{fixed("below", box(kZero, {0.1, 0.01, 0.01}))};
  try {
    with({below[0], free("it", box(kZero, {0.01, 0.1, 0.01}), below)});
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("obstacle 'it' is 0.01 m inside obstacle 'below'"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace soft_robot_lab
