// SPDX-License-Identifier: BSD-3-Clause
// Free rigid obstacles, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/body/gap.h"
#include "mechanics/contact/rigid_contact.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;
constexpr double kRadius = 0.01, kMass = 0.02;
constexpr Integrator kIntegrators[] = {Integrator::implicit_euler, Integrator::bdf2, Integrator::tr_bdf2};

SolverOptions steps_of(double time_step_s, Integrator integrator = Integrator::implicit_euler) {
  SolverOptions options;
  options.time_step_s = time_step_s;
  options.integrator = integrator;
  return options;
}

void run(Simulation& simulation, double duration_s) {
  const auto steps = std::lround(duration_s / simulation.options().time_step_s);
  for (long i = 0; i < steps; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message << " at " << simulation.state().time_s << " s";
  }
}

// 40 x 10 x 40 mm on a rigid ground, top at y = 0.
Body pad(const Eigen::Vector3i& cells = {4, 1, 4}) {
  Body body(box_mesh({-0.02, -0.01, -0.02}, {0.02, 0, 0.02}, cells), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, -0.01 + 1e-6, 1}, {true, true, true});
  body.set_gravity({0, -kGravity, 0});
  return body;
}

Obstacle ball(const Vector3d& center_m, double friction = 0.0) {
  Obstacle one{"ball", Sphere{center_m, kRadius}, {}, friction};
  one.mass_kg = kMass;
  return one;
}

Simulation with(Body body, std::vector<Obstacle> obstacles, const SolverOptions& options) {
  body.set_obstacles(std::move(obstacles));
  return Simulation(std::move(body), {}, {}, options);
}

Vector3d center_m(const Simulation& simulation, int free = 0) {
  return simulation.state().contact.free.centers_m.col(free);
}
Vector3d velocity_m_s(const Simulation& simulation, int free = 0) {
  return simulation.state().free_velocities.linear_m_s.col(free);
}
Vector3d spin_rad_s(const Simulation& simulation, int free = 0) {
  return simulation.state().free_velocities.angular_rad_s.col(free);
}

TEST(FreeObstacle, FallsAsABodyInAVacuum) {
  for (const Integrator integrator : kIntegrators) {
    Obstacle thrown = ball({0, 0.5, 0});
    thrown.velocity_m_s = {0.3, 0, 0};
    thrown.angular_velocity_rad_s = {0, 5, 0};
    Simulation simulation = with(pad(), {thrown}, steps_of(0.002, integrator));
    simulation.keep_energy_ledger();
    run(simulation, 0.2);
    // Implicit Euler falls by g h t / 2 further than it should.
    const double further_m = integrator == Integrator::implicit_euler ? 0.5 * kGravity * 0.002 * 0.2 : 0.0;
    EXPECT_NEAR(center_m(simulation).y(), 0.5 - 0.5 * kGravity * 0.04 - further_m, 5e-5);
    EXPECT_NEAR(velocity_m_s(simulation).y(), -kGravity * 0.2, 1e-6);
    EXPECT_NEAR(center_m(simulation).x(), 0.06, 1e-9);
    EXPECT_NEAR(spin_rad_s(simulation).y(), 5.0, 1e-9);
    const Eigen::Quaterniond turn(Eigen::Vector4d(simulation.state().contact.free.turns.col(0)));
    EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), 1.0, 1e-9);
    const EnergyLedger& ledger = *simulation.energy_ledger();
    EXPECT_NEAR(ledger.closure_error_j, 0.0, 1e-2 * ledger.turned_over_j);
  }
}

// In a short step everything moves little; a ball that nothing holds has no force by which it would be awake.
// What was left of the forces on it was measured by those of the whole body, so that it stood in the air.
TEST(FreeObstacle, ALightBallFallsAsAHeavyOne) {
  for (const Integrator integrator : kIntegrators) {
    for (const double mass_kg : {1e-2, 1e-8, 1e-13}) {
      Obstacle falling = ball({0, 0.5, 0});
      falling.mass_kg = mass_kg;
      Simulation simulation = with(pad(), {falling}, steps_of(0.002, integrator));
      run(simulation, 0.2);
      EXPECT_NEAR(velocity_m_s(simulation).y(), -kGravity * 0.2, 2e-3 * kGravity * 0.2) << mass_kg << " kg";
    }
  }
}

TEST(FreeObstacle, DriftsOnHoweverShortTheSteps) {
  for (const double time_step_s : {1e-4, 1e-3, 1e-2}) {
    Obstacle drifting = ball({0, 0.5, 0});
    drifting.velocity_m_s = {2e-5, 0, 0};
    drifting.angular_velocity_rad_s = {0, 0, 2e-4};
    Body body = pad({1, 1, 1});
    body.set_gravity(Vector3d::Zero());
    Simulation simulation = with(std::move(body), {drifting}, steps_of(time_step_s));
    run(simulation, 0.1);
    EXPECT_FALSE(simulation.state().rest_residual.has_value()) << time_step_s;
    EXPECT_NEAR(center_m(simulation).x(), 2e-6, 2e-10) << time_step_s;
    EXPECT_NEAR(spin_rad_s(simulation).z(), 2e-4, 1e-9) << time_step_s;
  }
}

// Torque-free motion about the middle axis: the Dzhanibekov effect. Angular momentum stays; energy nearly does.
struct Tumbling {
  Vector3d momentum_error;
  double energy_error;
  Eigen::Vector4d turn;
};

Tumbling tumble(Integrator integrator, double time_step_s, double duration_s) {
  Obstacle box{"box", RoundedBox{{0, 0.5, 0}, {0.01, 0.02, 0.04}, 0.001}, {}, 0.0};
  box.mass_kg = kMass;
  box.angular_velocity_rad_s = {0.1, 20, 0.1};
  Body body = pad({1, 1, 1});
  body.set_gravity(Vector3d::Zero());
  Simulation simulation = with(std::move(body), {box}, steps_of(time_step_s, integrator));
  const Eigen::Matrix3d inertia = solid_inertia_kg_m2(box.shape, kMass);
  const Vector3d momentum = inertia * box.angular_velocity_rad_s;
  run(simulation, duration_s);
  const Eigen::Vector4d turn = simulation.state().contact.free.turns.col(0);
  const Eigen::Matrix3d turned = Eigen::Quaterniond(turn).toRotationMatrix();
  const Vector3d now = turned * inertia * turned.transpose() * spin_rad_s(simulation);
  const double energy = box.angular_velocity_rad_s.dot(momentum);
  return {(now - momentum) / momentum.norm(), spin_rad_s(simulation).dot(now) / energy - 1.0, turn};
}

TEST(FreeObstacle, ATumblingBoxKeepsItsAngularMomentum) {
  for (const Integrator integrator : {Integrator::bdf2, Integrator::tr_bdf2}) {
    const Tumbling end = tumble(integrator, 0.002, 1.0);
    EXPECT_LT(end.momentum_error.norm(), 1e-6);
    EXPECT_NEAR(end.energy_error, 0.0, 0.02);
  }
}

TEST(FreeObstacle, TrBdf2TurnsABoxToSecondOrder) {
  const double duration_s = 0.256;
  const auto error_rad = [&](double time_step_s) {
    static const Eigen::Vector4d fine = tumble(Integrator::tr_bdf2, 0.00025, duration_s).turn;
    return turned_rad(fine, tumble(Integrator::tr_bdf2, time_step_s, duration_s).turn).norm();
  };
  const double coarse = error_rad(0.004), half = error_rad(0.002);
  EXPECT_NEAR(std::log2(coarse / half), 2.0, 0.2) << coarse << " " << half;
}

TEST(FreeObstacle, ABallAtRestOnASoftPadPressesByItsWeight) {
  for (const double friction : {0.0, 0.5}) {
    Simulation simulation = with(pad(), {ball({0.001, kRadius, 0.002}, friction)}, {});
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_LT((simulation.contacts()[0].force_n - Vector3d(0, -kMass * kGravity, 0)).norm(), 1e-5);
    EXPECT_LT(center_m(simulation).y(), kRadius);
    EXPECT_GT(center_m(simulation).y(), kRadius - 1e-3);
  }
}

TEST(FreeObstacle, AnEquilibriumNamesTheMotionThatNothingHolds) {
  Simulation simulation = with(pad(), {ball({0, kRadius, 0})}, {});
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].text, "nothing keeps obstacle 'ball' from turning about x, y, z");

  Simulation beside = with(pad(), {ball({0.1, kRadius, 0})}, {});
  const SolveReport falls = beside.solve_equilibrium();
  EXPECT_FALSE(falls.converged);
  EXPECT_NE(falls.message.find("nothing keeps obstacle 'ball' from moving along x, y, z"), std::string::npos)
      << falls.message;
}

TEST(FreeObstacle, ADroppedBallComesToRestWithItsWeight) {
  Body body = pad();
  body.set_viscosity({2.0, 2e-3, 0.0, 1.0});
  Simulation simulation = with(std::move(body), {ball({0, kRadius + 0.002, 0}, 0.5)}, steps_of(0.005));
  simulation.keep_energy_ledger();
  run(simulation, 1.5);
  EXPECT_TRUE(simulation.state().rest_residual.has_value());
  EXPECT_LT((simulation.contacts()[0].force_n - Vector3d(0, -kMass * kGravity, 0)).norm(), 1e-5);
  const EnergyLedger& ledger = *simulation.energy_ledger();
  EXPECT_NEAR(ledger.closure_error_j, 0.0, 0.01 * ledger.turned_over_j);
}

// Dropped by 20 mm without friction.
TEST(FreeObstacle, ABallBouncesWithoutGainingEnergy) {
  constexpr double kDropM = 0.02;
  for (const Integrator integrator : kIntegrators) {
    Simulation simulation = with(pad(), {ball({0.001, kRadius + kDropM, 0.002})}, steps_of(0.002, integrator));
    simulation.keep_energy_ledger();
    double most_j = 0.0, rebound_m = 0.0;
    bool touched = false;
    for (int i = 0; i < 150; ++i) {
      ASSERT_TRUE(simulation.step().converged) << i;
      const EnergyLedger& ledger = *simulation.energy_ledger();
      most_j = std::max(most_j, ledger.kinetic_j + ledger.elastic_j + ledger.gravity_j);
      touched = touched || simulation.contacts()[0].normal_force_n > 0.0;
      if (touched) rebound_m = std::max(rebound_m, center_m(simulation).y() - kRadius);
    }
    EXPECT_LT(most_j, 0.01 * kMass * kGravity * kDropM) << static_cast<int>(integrator);
    EXPECT_GT(rebound_m, integrator == Integrator::tr_bdf2 ? 0.2 * kDropM : 0.0) << static_cast<int>(integrator);
    EXPECT_LT(rebound_m, kDropM) << static_cast<int>(integrator);
  }
}

TEST(FreeObstacle, ACollisionWithoutGravityKeepsMomentum) {
  for (const Integrator integrator : kIntegrators) {
    Body body = loose_block();
    Obstacle thrown = ball({0.004, 0.02 + kRadius + 0.001, 0.002}, 0.5);
    thrown.velocity_m_s = {0.1, -0.5, 0};
    SolverOptions options = steps_of(0.001, integrator);
    options.dynamic_tolerance = 1e-6;
    Simulation simulation = with(std::move(body), {thrown}, options);
    const auto momentum = [&] {
      return Vector3d(kMass * velocity_m_s(simulation) +
                      simulation.state().velocities_m_s * simulation.body().node_masses_kg());
    };
    const auto angular_momentum = [&] {
      Vector3d sum = kMass * center_m(simulation).cross(velocity_m_s(simulation)) +
                     0.4 * kMass * kRadius * kRadius * spin_rad_s(simulation);
      for (Eigen::Index node = 0; node < simulation.state().positions_m.cols(); ++node)
        sum += simulation.body().node_masses_kg()[node] *
               Vector3d(simulation.state().positions_m.col(node))
                   .cross(Vector3d(simulation.state().velocities_m_s.col(node)));
      return sum;
    };
    const Vector3d before = momentum(), turning_before = angular_momentum();
    bool touched = false;
    for (int i = 0; i < 60; ++i) {
      ASSERT_TRUE(simulation.step().converged);
      touched = touched || simulation.contacts()[0].normal_force_n > 0.0;
    }
    EXPECT_TRUE(touched);
    EXPECT_GT(velocity_m_s(simulation).y(), -0.4);
    EXPECT_LT((momentum() - before).norm(), 1e-5 * before.norm());
    EXPECT_LT((angular_momentum() - turning_before).norm(), 2e-2 * turning_before.norm());
  }
}

// Speeds up along x from a time on, with a pose at each step of 5 ms, after other poses.
std::vector<ObstaclePose> speeding_up(double start_s, double acceleration_m_s2, std::vector<ObstaclePose> poses) {
  const Vector3d from_m = poses.back().translation_m;
  for (int i = 0; i <= 60; ++i) {
    const double since_s = 0.005 * i, way_m = 0.5 * acceleration_m_s2 * since_s * since_s;
    poses.push_back({start_s + since_s, from_m + Vector3d(way_m, 0, 0), kZero});
  }
  return poses;
}

// In the frame of the first obstacle.
double along_x_m(const Simulation& simulation) {
  return center_m(simulation).x() -
         pose_at(simulation.body().obstacles()[0], simulation.state().time_s).translation().x();
}

// How far a block slides back on a table that has sped up for 100 and for 200 ms.
Eigen::Vector2d slid_on_table_m(double friction, double acceleration_m_s2) {
  Obstacle block{"block", RoundedBox{{0.2, 0, 0}, {0.02, 0.02, 0.02}, 0.001}, {}, 0.0};
  block.mass_kg = 0.1;
  block.friction_on["table"] = friction;
  const Obstacle table{"table", RoundedBox{{0.3, -0.02, 0}, {0.4, 0.02, 0.2}, 0.002},
                       speeding_up(0.05, acceleration_m_s2, {{0.0}}), 0.0};
  Simulation simulation = with(pad({2, 1, 2}), {table, block}, steps_of(0.005));
  run(simulation, 0.15);
  const double first_m = 0.2 - along_x_m(simulation);
  run(simulation, 0.1);
  return {first_m, 0.2 - along_x_m(simulation)};
}

TEST(FreeObstacle, ATableThatSpeedsUpTakesABlockAlongWhileFrictionBearsIt) {
  for (const double share : {0.3, 0.8, 0.9, 0.98})
    EXPECT_LT(slid_on_table_m(0.5, share * 0.5 * kGravity).cwiseAbs().maxCoeff(), 1e-6) << share;
  const double more_m_s2 = 0.05 * 0.5 * kGravity;
  const Eigen::Vector2d slid_m = slid_on_table_m(0.5, 0.5 * kGravity + more_m_s2);
  EXPECT_NEAR(slid_m[1] - slid_m[0], 0.5 * more_m_s2 * (0.04 - 0.01), 0.05 * 0.5 * more_m_s2 * 0.03);
}

// A block of 100 g between a pad and a lid that rub on it, with its weight along both. How far it slides in them during
// the last 50 ms, and the force with which they press. From 50 ms on both may speed up.
struct Grip {
  double slid_m, squeeze_n;
};

Grip grip_block(double friction, double gravity_m_s2, double acceleration_m_s2 = 0.0,
                const SolverOptions& options = steps_of(0.005), const Viscosity& viscosity = {}) {
  Body body(box_mesh({-0.01, -0.01, -0.01}, {0.01, 0, 0.01}, {2, 1, 2}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, -0.01 + 1e-6, 1}, {true, true, true}, speeding_up(0.05, acceleration_m_s2, {{0.0}}),
                 "base");
  body.set_gravity({-gravity_m_s2, 0, 0});
  body.set_viscosity(viscosity);
  Obstacle block{"block", RoundedBox{{0, 0.01, 0}, {0.06, 0.02, 0.06}, 0.002}, {}, friction};
  block.mass_kg = 0.1;
  block.friction_on["lid"] = friction;
  const std::vector<ObstaclePose> pressed{{0.0, kZero, kZero}, {0.005, {0, -0.0005, 0}, kZero}};
  const Obstacle lid{"lid", RoundedBox{{0, 0.03, 0}, {0.1, 0.02, 0.1}, 0.002},
                     speeding_up(0.05, acceleration_m_s2, pressed), 0.0};
  Simulation simulation = with(std::move(body), {lid, block}, options);
  run(simulation, 0.2);
  const double before_m = along_x_m(simulation);
  run(simulation, 0.05);
  return {before_m - along_x_m(simulation), simulation.contacts()[1].normal_force_n};
}

// It holds while 2 mu N > m (g + a), some 3 % on either side of that.
void expect_grip(double gravity_m_s2, double acceleration_m_s2) {
  const double load_n = 0.1 * (gravity_m_s2 + acceleration_m_s2);
  const auto grip = [&](double friction) { return grip_block(friction, gravity_m_s2, acceleration_m_s2); };
  const double limit = load_n / (2.0 * grip(1.1 * load_n / 13.9).squeeze_n);
  const Grip held = grip(1.03 * limit), lost = grip(0.97 * limit);
  const double held_ratio = 2.0 * 1.03 * limit * held.squeeze_n / load_n,
               lost_ratio = 2.0 * 0.97 * limit * lost.squeeze_n / load_n;
  EXPECT_GT(held_ratio, 1.0);
  EXPECT_LT(held_ratio, 1.06);
  EXPECT_LT(std::abs(held.slid_m), 1e-6) << held_ratio;
  EXPECT_LT(lost_ratio, 1.0);
  EXPECT_GT(lost.slid_m, 2e-3) << lost_ratio;
}

TEST(FreeObstacle, AGripHoldsWhatItsFrictionBearsAndDropsMore) { expect_grip(kGravity + 5.0, 0.0); }
TEST(FreeObstacle, AGripThatSpeedsUpHoldsWhatItsFrictionBearsAndDropsMore) { expect_grip(kGravity, 5.0); }

// On a rigid floor, beside the pad.
std::vector<Obstacle> on_floor(Obstacle one, double friction) {
  one.friction_on["floor"] = friction;
  return {{"floor", Plane{{0, -0.02, 0}, {0, 1, 0}}, {}, 0.0}, one};
}

TEST(FreeObstacle, ASlidingBlockStopsAfterItsStoppingDistance) {
  const double mu = 0.4, speed_m_s = 0.6;
  Obstacle block{"block", RoundedBox{{0.1, -0.01, 0}, {0.02, 0.02, 0.02}, 0.001}, {}, 0.0};
  block.mass_kg = kMass;
  for (const Integrator integrator : {Integrator::bdf2, Integrator::tr_bdf2}) {
    Simulation simulation = with(pad(), on_floor(block, mu), steps_of(0.001, integrator));
    run(simulation, 0.05);
    SimulationState state = simulation.state();
    state.free_velocities.linear_m_s(0, 0) += speed_m_s;
    state.rest_residual.reset();
    simulation.set_state(state);
    const double start_m = center_m(simulation).x();
    run(simulation, 0.3);
    const double expected_m = speed_m_s * speed_m_s / (2.0 * mu * kGravity);
    EXPECT_NEAR(center_m(simulation).x() - start_m, expected_m, 0.02 * expected_m);
    const double stopped_m = center_m(simulation).x();
    run(simulation, 1.0);
    EXPECT_NEAR(center_m(simulation).x(), stopped_m, 1e-7);
    EXPECT_NEAR(simulation.contacts().back().force_n.y(), kMass * kGravity, 1e-5);
  }
}

// A ball pushed without spin slides until it rolls at 5/7 of its speed.
TEST(FreeObstacle, ASlidingBallRollsAtFiveSeventhsOfItsSpeed) {
  Obstacle pushed = ball({0.1, -0.02 + kRadius, 0});
  pushed.velocity_m_s = {0.5, 0, 0};
  Simulation simulation = with(pad(), on_floor(pushed, 0.5), steps_of(0.001, Integrator::bdf2));
  run(simulation, 0.2);
  EXPECT_NEAR(velocity_m_s(simulation).x(), 5.0 / 7.0 * 0.5, 0.005);
  EXPECT_NEAR(spin_rad_s(simulation).z(), -velocity_m_s(simulation).x() / kRadius, 0.5);
}

TEST(FreeObstacle, ABallRollsOnSoftGroundWithoutSlip) {
  Obstacle rolling = ball({-0.012, kRadius - 2e-5, 0}, 1.0);
  rolling.velocity_m_s = {0.1, 0, 0};
  rolling.angular_velocity_rad_s = {0, 0, -0.1 / kRadius};
  Simulation simulation = with(pad({8, 2, 8}), {rolling}, steps_of(0.002));
  const double start_m = center_m(simulation).x();
  run(simulation, 0.1);
  const double way_m = center_m(simulation).x() - start_m;
  EXPECT_GT(way_m, 0.004);
  EXPECT_LT(way_m, 0.0105);
  EXPECT_NEAR(-spin_rad_s(simulation).z() * kRadius, velocity_m_s(simulation).x(), 0.15 * velocity_m_s(simulation).x());
}

TEST(FreeObstacle, ASavedStateGoesOnToTheLastBit) {
  for (const Integrator integrator : {Integrator::bdf2, Integrator::tr_bdf2}) {
    Simulation simulation = with(pad(), {ball({0, kRadius + 0.001, 0}, 0.5)}, steps_of(0.002, integrator));
    run(simulation, 0.03);
    const SimulationState saved = simulation.state();
    run(simulation, 0.02);
    const SimulationState end = simulation.state();
    simulation.set_state(saved);
    run(simulation, 0.02);
    EXPECT_TRUE(simulation.state() == end);
    Simulation other(simulation.model());
    other.set_state(saved);
    run(other, 0.02);
    EXPECT_TRUE(other.state() == end);
  }
}

TEST(FreeObstacle, WithXpbdAGripHoldsABlockWhileFrictionBearsIt) {
  const auto grip = [](double friction) {
    return grip_block(friction, kGravity, 0.0, xpbd(100, 0.005), {20.0, 0.002, 0.0, 1.0});
  };
  const double limit = 0.1 * kGravity / (2.0 * grip(0.08).squeeze_n);
  EXPECT_LT(std::abs(grip(1.05 * limit).slid_m), 2e-6);
  EXPECT_GT(grip(0.95 * limit).slid_m, 1e-4);
}

// Pressed on askew, so that it tilts.
TEST(FreeObstacle, WithXpbdABlockRestsOnASoftPadAsWithNewton) {
  const auto rest = [](const SolverOptions& options) {
    Obstacle block{"block", RoundedBox{{0.004, 0.008, -0.003}, {0.02, 0.016, 0.02}, 0.001}, {}, 0.5};
    block.mass_kg = 0.1;
    Simulation simulation = with(pad(), {block}, options);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    return simulation;
  };
  const Simulation newton = rest({}), local = rest(xpbd(40));
  const FreePoses &expected = newton.state().contact.free, &found = local.state().contact.free;
  const Vector3d way_m = expected.centers_m.col(0) - Vector3d(0.004, 0.008, -0.003);
  EXPECT_LT((found.centers_m - expected.centers_m).norm(), 0.01 * way_m.norm());
  const Eigen::Vector4d none = Eigen::Vector4d::UnitW(), turn = expected.turns.col(0);
  EXPECT_LT(turned_rad(turn, found.turns.col(0)).norm(), 0.01 * turned_rad(none, turn).norm());
  const Vector3d expected_n = newton.contacts()[0].force_n;
  EXPECT_NEAR(expected_n.y(), -0.1 * kGravity, 1e-5);
  EXPECT_LT((local.contacts()[0].force_n - expected_n).norm(), 0.01 * expected_n.norm());
}

TEST(FreeObstacle, WithXpbdABoxFallsAndTumblesAsInAVacuum) {
  Obstacle box{"box", RoundedBox{{0, 0.5, 0}, {0.01, 0.02, 0.04}, 0.001}, {}, 0.0};
  box.mass_kg = kMass;
  box.angular_velocity_rad_s = {0.1, 20, 0.1};
  const Vector3d momentum = solid_inertia_kg_m2(box.shape, kMass) * box.angular_velocity_rad_s;
  Simulation simulation = with(pad({1, 1, 1}), {box}, xpbd(40, 0.01));
  run(simulation, 0.25);
  EXPECT_NEAR(center_m(simulation).y(), 0.5 - 0.5 * kGravity * 0.0625, 1e-3);
  EXPECT_NEAR(velocity_m_s(simulation).y(), -kGravity * 0.25, 1e-9);
  const Eigen::Matrix3d turned =
      Eigen::Quaterniond(Eigen::Vector4d(simulation.state().contact.free.turns.col(0))).toRotationMatrix();
  const Vector3d now = turned * solid_inertia_kg_m2(box.shape, kMass) * turned.transpose() * spin_rad_s(simulation);
  EXPECT_LT((now - momentum).norm(), 1e-9 * momentum.norm());
  EXPECT_NEAR(spin_rad_s(simulation).dot(now), box.angular_velocity_rad_s.dot(momentum),
              0.01 * box.angular_velocity_rad_s.dot(momentum));
}

TEST(FreeObstacle, WithXpbdARestoredStateGoesOnAsIfItHadNeverStopped) {
  Simulation simulation = with(pad(), {ball({0.001, kRadius, 0.002}, 0.5)}, xpbd(40, 0.005));
  run(simulation, 0.01);
  EXPECT_GT(simulation.contacts()[0].normal_force_n, 0.0);
  const SimulationState saved = simulation.state();
  run(simulation, 0.02);
  Simulation other(simulation.model());
  other.set_state(saved);
  run(other, 0.02);
  EXPECT_TRUE(other.state() == simulation.state());
}

std::string refusal(std::vector<Obstacle> obstacles) {
  Body body = pad();
  try {
    body.set_obstacles(std::move(obstacles));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(FreeObstacle, RefusesWhatCannotBeFree) {
  Obstacle moved = ball({0, 0.1, 0});
  moved.motion = {{0.0, kZero, kZero}};
  EXPECT_NE(refusal({moved}).find("motion: a free obstacle"), std::string::npos);
  Obstacle plane{"floor", Plane{{0, -0.02, 0}, {0, 1, 0}}, {}, 0.0};
  plane.mass_kg = 1.0;
  EXPECT_NE(refusal({plane}).find("a plane cannot be free"), std::string::npos);
  Obstacle light = ball({0, 0.1, 0});
  light.mass_kg = -1.0;
  EXPECT_NE(refusal({light}).find("mass_kg: -1"), std::string::npos);
  Obstacle flat = ball({0, 0.1, 0});
  flat.inertia_kg_m2 = Eigen::Matrix3d::Zero();
  EXPECT_NE(refusal({flat}).find("inertia_kg_m2"), std::string::npos);
  Obstacle fixed = ball({0, 0.1, 0});
  fixed.mass_kg = 0.0;
  fixed.velocity_m_s = {1, 0, 0};
  EXPECT_NE(refusal({fixed}).find("give mass_kg too"), std::string::npos);
  const std::string inside = refusal(on_floor(ball({0.1, -0.02, 0}), 0.0));
  EXPECT_NE(inside.find("is 0.01 m inside obstacle 'floor'"), std::string::npos) << inside;
}

}  // namespace
}  // namespace soft_robot_lab
