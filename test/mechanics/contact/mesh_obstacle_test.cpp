// SPDX-License-Identifier: BSD-3-Clause
// Obstacles from meshes, against the shapes that have closed forms, closed forms, and balance of forces.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/body/free_obstacles.h"
#include "mechanics/body/mesh_solid.h"
#include "mesh_shapes.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;

MeshShape shape_of(const Triangles& from, double rounding_m = 0.0) {
  return mesh_shape(from.vertices_m, from.triangles, rounding_m);
}

std::vector<Vector3d> places(int count, double half_m, const Vector3d& middle_m = kZero) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> side(-half_m, half_m);
  std::vector<Vector3d> all;
  for (int i = 0; i < count; ++i) {
    const double x = side(random), y = side(random), z = side(random);
    all.push_back(middle_m + Vector3d(x, y, z));
  }
  return all;
}

std::vector<Triangles> some_surfaces() {
  return {sphere_triangles({0.001, 0.002, 0}, 0.01, 4), box_triangles({0, 0.001, 0}, {0.015, 0.02, 0.01}),
          l_triangles(0.02, 0.006, 0.01)};
}

TEST(MeshGap, NormalAndHessianAreItsDerivativesNearTheSurface) {
  constexpr double kStep = 1e-8;
  int seen = 0;
  for (const Triangles& surface : some_surfaces()) {
    const MeshShape shape = shape_of(surface);
    const double near_m = 0.2 * shape.solid->rounding_m();
    for (const Vector3d& at : places(20000, 0.012, shape.solid->surface().centroid_m())) {
      const Gap here = shape.solid->gap(at);
      if (std::abs(here.gap_m) > near_m) continue;
      ++seen;
      EXPECT_NEAR(here.normal.norm(), 1.0, 1e-12);
      for (int axis = 0; axis < 3; ++axis) {
        const Gap more = shape.solid->gap(at + kStep * Vector3d::Unit(axis)),
                  less = shape.solid->gap(at - kStep * Vector3d::Unit(axis));
        EXPECT_NEAR((more.gap_m - less.gap_m) / (2 * kStep), here.normal[axis], 1e-6) << at.transpose();
        const Vector3d change = (more.normal - less.normal) / (2 * kStep);
        EXPECT_LT((change - here.hessian.col(axis)).norm(), 1e-4 / shape.solid->rounding_m()) << at.transpose();
      }
    }
  }
  EXPECT_GT(seen, 300);
}

double true_distance_m(const Triangles& surface, const Vector3d& at_m) {
  double least_m = 1e9;
  for (const auto& t : surface.triangles.colwise())
    least_m = std::min(least_m, (at_m - nearest_on_triangle(at_m, surface.vertices_m(Eigen::all, t)).at_m).norm());
  return least_m;
}

// Near the surface it is the distance but for the rounding; farther off it may be less, and never more.
TEST(MeshGap, IsNoMoreThanTheDistance) {
  for (const Triangles& surface : some_surfaces()) {
    const MeshShape shape = shape_of(surface);
    const double rounding_m = shape.solid->rounding_m();
    for (const Vector3d& at : places(2000, 0.04)) {
      const double gap_m = shape.solid->gap(at).gap_m, distance_m = true_distance_m(surface, at);
      if (gap_m < 0.0) continue;
      EXPECT_LT(gap_m, distance_m + 0.7 * rounding_m) << at.transpose();
      EXPECT_GT(gap_m, 0.6 * distance_m - 0.1 * rounding_m) << at.transpose();
    }
  }
}

// As a step's trial may be, which is refused for that.
TEST(MeshGap, OfAPlaceThatIsNoNumberIsNone) {
  const MeshShape shape = shape_of(box_triangles({0, 0, 0}, {0.01, 0.01, 0.01}));
  for (const double none : {std::nan(""), HUGE_VAL}) EXPECT_FALSE(std::isfinite(shape.solid->gap({0, none, 0}).gap_m));
}

// A large ball meets the triangles themselves, whose edges need no rounding.
TEST(MeshGap, OfALargeBallIsTheDistanceToTheTriangles) {
  constexpr double kStep = 1e-7;
  for (const Triangles& surface : some_surfaces()) {
    const MeshShape shape = shape_of(surface);
    for (const Vector3d& at : places(1000, 0.03)) {
      const Gap here = shape.solid->gap_of_ball(at, 0.01);
      if (here.gap_m < 0.001) continue;
      EXPECT_NEAR(here.gap_m, true_distance_m(surface, at), 1e-12) << at.transpose();
      const Gap more = shape.solid->gap_of_ball(at + kStep * here.normal, 0.01);
      EXPECT_NEAR(more.gap_m - here.gap_m, kStep, 1e-3 * kStep) << at.transpose();
      EXPECT_LT((here.hessian * here.normal).norm(), 1e-9 / here.gap_m) << at.transpose();
    }
  }
}

TEST(MeshGap, HasTheFacesOfABoxAndRoundsItsEdges) {
  const Vector3d size_m(0.02, 0.03, 0.04);
  const MeshShape mesh = shape_of(box_triangles(kZero, size_m));
  const double rounding_m = mesh.solid->rounding_m();
  EXPECT_NEAR(rounding_m, 0.04 / 64, 1e-12);
  const RoundedBox box{kZero, size_m, rounding_m};
  for (const Vector3d& at : places(5000, 0.018)) {
    const double gap_m = mesh.solid->gap(at).gap_m, expected_m = gap_to(box, at).gap_m;
    if (std::abs(expected_m) > 0.5 * rounding_m) continue;
    const Vector3d beyond_m = at.cwiseAbs() - 0.5 * size_m + Vector3d::Constant(4.0 * rounding_m);
    const bool over_a_face = (beyond_m.array() > 0.0).count() == 1;
    EXPECT_NEAR(gap_m, expected_m, over_a_face ? 1e-12 : 0.25 * rounding_m) << at.transpose();
  }
}

// The file's triangles stand back by up to e^2 / (6 R), with e their edges; the spline by step^2 / (3 R).
TEST(MeshGap, OfASphereIsWithinItsBound) {
  constexpr double kRadius = 0.015;
  for (const int rounds : {3, 4, 5}) {
    const Triangles ball = sphere_triangles(kZero, kRadius, rounds);
    const MeshShape mesh = shape_of(ball);
    double edge_m = 0.0;
    for (const auto& t : ball.triangles.colwise())
      edge_m = std::max(edge_m, (ball.vertices_m.col(t[0]) - ball.vertices_m.col(t[1])).norm());
    const double bound_m = (edge_m * edge_m / 6.0 + std::pow(mesh.solid->rounding_m(), 2) / 3.0) / kRadius;
    double most_m = 0.0;
    for (const Vector3d& way : places(500, 1.0)) {
      const double gap_m = mesh.solid->gap(kRadius * way.normalized()).gap_m;
      most_m = std::max(most_m, std::abs(gap_m));
    }
    EXPECT_LT(most_m, bound_m) << rounds;
    EXPECT_GT(most_m, 0.1 * bound_m) << rounds;
  }
}

void expect_alike(const Triangles& surface, const Triangles& other, const Eigen::Matrix3d& turn, double tolerance) {
  const MeshShape one = shape_of(surface), turned = shape_of(other);
  const double rounding_m = one.solid->rounding_m();
  for (const Vector3d& at : places(2000, 0.02)) {
    const Gap here = one.solid->gap(at), there = turned.solid->gap(turn * at);
    if (std::abs(here.gap_m) > 3.0 * rounding_m) continue;
    EXPECT_NEAR(here.gap_m, there.gap_m, tolerance * rounding_m) << at.transpose();
    EXPECT_LT((turn * here.normal - there.normal).norm(), 10 * tolerance) << at.transpose();
  }
}

TEST(MeshGap, DoesNotDependOnTheOrderOfTriangles) {
  for (const Triangles& surface : some_surfaces())
    expect_alike(surface, shuffled(surface, 5), Eigen::Matrix3d::Identity(), 1e-9);
}

// Of a ball, whose facets are of equal sizes, the grid may lie another way.
TEST(MeshGap, TurnsWithTheAxesOfTheFile) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const Triangles& surface : some_surfaces()) {
    Triangles other = shuffled(surface, 5);
    other.vertices_m = turn * other.vertices_m;
    expect_alike(surface, other, turn, surface.triangles.cols() > 100 ? 0.01 : 1e-9);
  }
}

TEST(MeshShape, HasTheMassesOfItsVolume) {
  const Vector3d sides_m(0.02, 0.03, 0.04), middle_m(0.1, -0.2, 0.3);
  const MeshShape box = shape_of(shuffled(box_triangles(middle_m, sides_m), 3));
  EXPECT_NEAR(volume_m3(box), sides_m.prod(), 1e-12 * sides_m.prod());
  EXPECT_LT((center_m(box) - middle_m).norm(), 1e-12);
  const Eigen::Matrix3d expected = solid_inertia_kg_m2(RoundedBox{middle_m, sides_m, 0.001}, 0.2);
  EXPECT_LT((solid_inertia_kg_m2(box, 0.2) - expected).norm(), 1e-10 * expected.norm());
  // Two arms of 40 x 10 and 10 x 30 mm.
  const MeshShape angle = shape_of(l_triangles(0.04, 0.01, 0.02));
  EXPECT_NEAR(volume_m3(angle), 7e-4 * 0.02, 1e-15);
  const double at_m = (4e-4 * 0.02 + 3e-4 * 0.005) / 7e-4;
  EXPECT_LT((center_m(angle) - Vector3d(at_m, (4e-4 * 0.005 + 3e-4 * 0.025) / 7e-4, 0.01)).norm(), 1e-12);
  EXPECT_NEAR(size_m(angle), 0.005, 5e-4);
}

std::string why_not(const Triangles& surface, double rounding_m = 0.0) {
  try {
    shape_of(surface, rounding_m);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(MeshShape, RefusesWhatBoundsNoSolidWithAReason) {
  const Triangles box = box_triangles(kZero, {0.02, 0.03, 0.04});
  Triangles open = box, inverted = box, doubled = box;
  open.triangles.conservativeResize(3, 11);
  for (auto t : inverted.triangles.colwise()) std::swap(t[1], t[2]);
  doubled.triangles.conservativeResize(3, 13);
  doubled.triangles.col(12) = doubled.triangles.col(0);
  EXPECT_NE(why_not(open).find("not closed: the edge at"), std::string::npos);
  EXPECT_NE(why_not(inverted).find("face inward"), std::string::npos);
  EXPECT_NE(why_not(doubled).find("not closed: the edge at"), std::string::npos);
  EXPECT_NE(why_not({Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0)}).find("no triangles"), std::string::npos);
  EXPECT_NE(why_not(box_triangles({1, 2, 3}, {0.1, 0.1, 0.0001})).find("walls too thin or details too fine, as at ("),
            std::string::npos);
  EXPECT_NE(why_not(box, 0.03).find("walls too thin"), std::string::npos);
  EXPECT_NE(why_not(box, 1e-5).find("nodes, at most 8000000"), std::string::npos);
  EXPECT_NE(why_not(box, -1.0).find("rounding_m"), std::string::npos);
  EXPECT_EQ(why_not(box_triangles(kZero, {0.1, 0.1, 0.001})), "");
  EXPECT_EQ(why_not(box_triangles(kZero, {0.014, 0.014, 0.04}), 0.002), "") << "edges are rounded as asked for";
}

// A disc of 80 mm with a pin on it, of a fiftieth of its surface.
TEST(MeshShape, APinIsNotLostWithoutAWord) {
  const auto disc = [](double pin_m) {
    return turned({{0, 0}, {0.04, 0}, {0.04, 0.01}, {pin_m, 0.01}, {pin_m, 0.04}, {0, 0.04}}, 24);
  };
  const MeshShape seen = shape_of(disc(0.0006));
  EXPECT_LT(seen.solid->gap({0, 0.035, 0}).gap_m, 0.0);
  EXPECT_GT(seen.solid->gap({0.002, 0.035, 0}).gap_m, 0.0);
  EXPECT_LT(seen.solid->rounding_m(), 0.08 / 64 / 1.9);
  const std::string said = why_not(disc(0.0001));
  EXPECT_NE(said.find("details too fine, as at ("), std::string::npos) << said;
  EXPECT_NE(said.find(", 0.04, "), std::string::npos) << said;
  EXPECT_NE(why_not(disc(0.0006), 0.002).find("details too fine, as at ("), std::string::npos);
}

// A thing that comes down from its place by `depth_m` on a block of 40 x 20 x 40 mm with its top at y = 20 mm.
Obstacle coming_down(const ObstacleShape& shape, double depth_m, double friction = 0.0, const Vector3d& turn = kZero) {
  return {"thing", shape, {{0.0, {0, 0, 0}, turn}, {1.0, {0, -depth_m, 0}, turn}}, friction};
}

Simulation on_block(const Obstacle& obstacle, const SolverOptions& options = {}) {
  Body body = loose_block({4, 2, 4});
  body.fix_nodes({-1, -1, -1}, {1, 1e-6, 1}, {true, true, true});
  body.set_obstacles({obstacle});
  return Simulation(std::move(body), {}, {}, options);
}

ContactReading pressed(const Obstacle& obstacle) {
  Simulation simulation = on_block(obstacle);
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  return simulation.contacts()[0];
}

TEST(MeshObstacle, ABallIsPressedInAsTheSphere) {
  const Vector3d at_m(0.001, 0.035, 0.002);
  const Vector3d expected_n = pressed(coming_down(Sphere{at_m, 0.015}, 0.003)).force_n;
  const Vector3d force_n = pressed(coming_down(shape_of(sphere_triangles(at_m, 0.015, 5)), 0.003)).force_n;
  EXPECT_GT(-expected_n.y(), 0.5);
  EXPECT_LT((force_n - expected_n).norm(), 0.01 * expected_n.norm());
}

// Of the punch all edges press, of the wide plate none.
TEST(MeshObstacle, ABoxIsPressedInAsTheBoxTurnedAndWithFriction) {
  const Vector3d middle_m(0.002, 0.0301, 0.001), punch_m(0.016, 0.02, 0.018), plate_m(0.1, 0.02, 0.1);
  const double rounding_m = 0.0005;
  for (const auto& [friction, turn] : {std::pair(0.0, kZero), std::pair(0.4, Vector3d(0.0, 0.5, 0.0))}) {
    const auto pushed = [&, friction = friction, turn = turn](const ObstacleShape& shape) {
      Obstacle one = coming_down(shape, 0.002, friction, turn);
      one.motion.push_back({2.0, {0.001, -0.002, 0}, turn});
      return pressed(one).force_n;
    };
    const Vector3d plate_n = pushed(RoundedBox{middle_m, plate_m, rounding_m});
    const Vector3d of_mesh_n = pushed(shape_of(box_triangles(middle_m, plate_m)));
    EXPECT_LT((of_mesh_n - plate_n).norm(), 1e-4 * plate_n.norm()) << friction;
    const Vector3d punch_n = pushed(RoundedBox{middle_m, punch_m, rounding_m});
    const Vector3d of_punch_n = pushed(shape_of(box_triangles(middle_m, punch_m), rounding_m));
    EXPECT_LT((of_punch_n - punch_n).norm(), 0.01 * punch_n.norm()) << friction;
    EXPECT_GT(plate_n.norm(), 5.0);
    EXPECT_EQ(plate_n.cross(Vector3d::UnitY()).norm() > 0.1, friction > 0.0);
  }
}

// An edge of a box, turned by 45 degrees about z, cuts into the block.
TEST(MeshObstacle, AnEdgeIsPressedInAsThatOfABox) {
  const Vector3d middle_m(0, 0.02 + 0.01 * std::sqrt(2.0) - 0.0004, 0), size_m(0.02, 0.02, 0.06);
  const Vector3d turn(0, 0, M_PI / 4);
  const double rounding_m = 0.001;
  const Vector3d expected_n = pressed(coming_down(RoundedBox{middle_m, size_m, rounding_m}, 0.003, 0.3, turn)).force_n;
  const Vector3d force_n =
      pressed(coming_down(shape_of(box_triangles(middle_m, size_m), rounding_m), 0.003, 0.3, turn)).force_n;
  EXPECT_LT((force_n - expected_n).norm(), 0.03 * expected_n.norm());  // the spline's edge is no circle
}

// The block's edge goes into the inner corner of an L, which is two boxes.
TEST(MeshObstacle, AnInnerCornerHoldsAsTheBoxesOfWhichItIs) {
  constexpr double kLong = 0.025, kArm = 0.01, kHeight = 0.06, kEnd = 0.02 + 0.0003 + kArm, kIn = 0.0018;
  Triangles angle = l_triangles(kLong, kArm, kHeight);
  angle.vertices_m = Eigen::AngleAxisd(M_PI, Vector3d::UnitZ()).toRotationMatrix() * angle.vertices_m;
  angle.vertices_m.colwise() += Vector3d(kEnd, kEnd, -0.5 * kHeight);
  const std::vector<ObstaclePose> motion{{0.0}, {1.0, {-kIn, -kIn, 0}}};
  const auto held = [&](std::vector<Obstacle> obstacles) {
    Body body = loose_block({4, 2, 4});
    body.fix_nodes({-1, -1, -1}, {1, 1e-6, 1}, {true, true, true});
    body.set_obstacles(std::move(obstacles));
    Simulation simulation(std::move(body), {}, {}, SolverOptions{});
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    Vector3d sum_n = Vector3d::Zero();
    for (const ContactReading& contact : simulation.contacts()) sum_n += contact.force_n;
    return sum_n;
  };
  const Vector3d across_m(0.5 * kLong, 0.5 * kArm, 0), up_m(0.5 * kArm, 0.5 * kLong, 0), end_m(kEnd, kEnd, 0);
  const double rounding_m = 0.0005;
  const Vector3d expected_n =
      held({{"across", RoundedBox{end_m - across_m, {kLong, kArm, kHeight}, rounding_m}, motion, 0.0},
            {"up", RoundedBox{end_m - up_m, {kArm, kLong, kHeight}, rounding_m}, motion, 0.0}});
  const Vector3d force_n = held({{"angle", shape_of(angle, rounding_m), motion, 0.0}});
  EXPECT_LT(expected_n.maxCoeff(), 1e-3);
  EXPECT_LT(expected_n.head<2>().maxCoeff(), -2.0);
  EXPECT_LT((force_n - expected_n).norm(), 0.02 * expected_n.norm())
      << force_n.transpose() << " / " << expected_n.transpose();
}

// A needle between the contact points of a large face.
TEST(MeshObstacle, ASharpThingBetweenContactPointsWarns) {
  const Triangles needle = box_triangles({0.0017, 0.0302, 0.0021}, {0.0012, 0.02, 0.0012});
  Body body = loose_block({2, 1, 2});
  body.fix_nodes({-1, -1, -1}, {1, 1e-6, 1}, {true, true, true});
  body.set_obstacles({coming_down(shape_of(needle), 0.001)});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  const bool warned = std::any_of(report.warnings.begin(), report.warnings.end(), [](const SolveWarning& warning) {
    return warning.kind == "coarse_contact" && warning.actuator == "thing";
  });
  EXPECT_TRUE(warned);
}

// Steps in time with damping end where the equilibrium is, by both solvers.
TEST(MeshObstacle, ADampedMotionEndsAtTheEquilibrium) {
  const Obstacle angle = coming_down(shape_of([] {
                                       Triangles one = l_triangles(0.02, 0.008, 0.03);
                                       const Eigen::Matrix3d turn =
                                           Eigen::AngleAxisd(-0.75 * M_PI, Vector3d::UnitZ()).toRotationMatrix();
                                       one.vertices_m = turn * one.vertices_m;
                                       const double low_m = one.vertices_m.row(1).minCoeff();
                                       one.vertices_m.row(1).array() += 0.0201 - low_m;
                                       one.vertices_m.row(2).array() -= 0.015;
                                       return one;
                                     }()),
                                     0.003);
  Simulation rest = on_block(angle);
  const SolveReport report = rest.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  const Vector3d expected_n = rest.contacts()[0].force_n;
  EXPECT_LT(expected_n.y(), -0.5);
  SolverOptions options;
  options.time_step_s = 0.02;
  Simulation moving = on_block(angle, options);
  for (int i = 0; i < 75; ++i) {
    const SolveReport step = moving.step();
    ASSERT_TRUE(step.converged) << step.message << " in step " << i;
  }
  EXPECT_LT((moving.contacts()[0].force_n - expected_n).norm(), 2e-3 * expected_n.norm());
  EXPECT_LT((moving.state().positions_m - rest.state().positions_m).colwise().norm().maxCoeff(), 2e-5);
}

TEST(MeshObstacle, WithXpbdABallIsPressedInAsWithNewton) {
  const Obstacle ball = coming_down(shape_of(sphere_triangles({0, 0.0351, 0}, 0.015, 4)), 0.0021);
  const auto with = [&](SolverOptions::Method method) {
    SolverOptions options;
    options.method = method;
    options.tolerance = 1e-4;
    Body body = loose_block({4, 2, 4});
    body.fix_nodes({-1, -1, -1}, {1, 1e-6, 1}, {true, true, true});
    body.set_obstacles({ball});
    Simulation simulation(std::move(body), {}, {}, options);
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    return simulation.contacts()[0].force_n;
  };
  const Vector3d expected_n = with(SolverOptions::Method::newton), force_n = with(SolverOptions::Method::xpbd);
  EXPECT_GT(expected_n.norm(), 0.2);
  EXPECT_LT((force_n - expected_n).norm(), 0.01 * expected_n.norm());
}

Obstacle free_thing(const Triangles& surface, double mass_kg, double friction = 0.0) {
  Obstacle one{"thing", shape_of(surface), {}, friction};
  one.mass_kg = mass_kg;
  return one;
}

// 40 x 10 x 40 mm on a rigid ground, top at y = 0.
Body pad() {
  Body body(box_mesh({-0.02, -0.01, -0.02}, {0.02, 0, 0.02}, {4, 1, 4}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, -0.01 + 1e-6, 1}, {true, true, true});
  body.set_gravity({0, -kGravity, 0});
  return body;
}

// With its arms in x and z; its foot at y = `foot_m`.
Triangles lying_angle(double foot_m) {
  Triangles angle = l_triangles(0.024, 0.01, 0.008);
  angle.vertices_m = Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitX()).toRotationMatrix() * angle.vertices_m;
  angle.vertices_m.colwise() += Vector3d(-0.01, foot_m, 0.01);
  return angle;
}

TEST(MeshObstacle, AFreeThingRestsOnTheBodyByItsWeight) {
  Body body = pad();
  body.set_obstacles({free_thing(lying_angle(0.0002), 0.02, 0.5)});
  Simulation simulation(std::move(body), {}, {}, SolverOptions{});
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_NEAR(-simulation.contacts()[0].force_n.y(), 0.02 * kGravity, 1e-5);
  EXPECT_LT(simulation.contacts()[0].force_n.cross(Vector3d::UnitY()).norm(), 1e-5);
}

TEST(MeshObstacle, AFreeThingFallsOnAPlateAndLiesByItsWeight) {
  Body body = pad();
  Triangles angle = lying_angle(-0.045);
  angle.vertices_m.row(0).array() += 0.1;
  Obstacle thing = free_thing(angle, 0.02);
  thing.friction_on = {{"plate", 0.3}};
  body.set_obstacles({thing, {"plate", Plane{{0, -0.05, 0}, {0, 1, 0}}, {}, 0.0}});
  SolverOptions options;
  options.time_step_s = 0.005;
  Simulation simulation(std::move(body), {}, {}, options);
  const double above_m = center_m(thing.shape).y() + 0.045;
  for (int i = 0; i < 100; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message << " in step " << i;
  }
  EXPECT_NEAR(simulation.state().contact.free.centers_m(1, 0), -0.05 + above_m, 1e-6);
  const std::vector<ContactReading> contacts = simulation.contacts();
  EXPECT_NEAR(contacts.back().force_n.y(), 0.02 * kGravity, 1e-4);
}

// It falls by 1 mm on the body, and comes to rest there by both solvers.
TEST(MeshObstacle, AFreeThingFallsOnTheBodyAndPressesByItsWeight) {
  for (const auto method : {SolverOptions::Method::newton, SolverOptions::Method::xpbd}) {
    Body body = pad();
    body.set_obstacles({free_thing(lying_angle(0.001), 0.02, 0.5)});
    SolverOptions options;
    options.time_step_s = 0.005;
    if (method == SolverOptions::Method::xpbd) options = xpbd(40, 0.005);
    Simulation simulation(std::move(body), {}, {}, options);
    Vector3d mean_n = kZero;
    for (int i = 0; i < 200; ++i) {
      const SolveReport report = simulation.step();
      if (method == SolverOptions::Method::newton) {
        ASSERT_TRUE(report.converged) << report.message << " in step " << i;
      }
      if (i >= 160) mean_n += simulation.contacts()[0].force_n / 40.0;
    }
    EXPECT_NEAR(-mean_n.y(), 0.02 * kGravity, 0.01 * 0.02 * kGravity);
    EXPECT_LT(simulation.state().free_velocities.linear_m_s.norm(), 1e-3);
  }
}

// It slides down a slope of 30 degrees at mu 0.3, and stays at mu 0.7.
TEST(MeshObstacle, AFreeThingSlidesAndSticksAsFrictionSays) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(-M_PI / 6, Vector3d::UnitZ()).toRotationMatrix();
  for (const double friction : {0.3, 0.7}) {
    Triangles angle = lying_angle(0.0);
    angle.vertices_m = turn * angle.vertices_m;
    angle.vertices_m.row(0).array() -= 0.5;
    Obstacle thing = free_thing(angle, 0.02);
    thing.friction_on = {{"slope", friction}};
    Body body = pad();
    body.set_obstacles({thing, {"slope", Plane{{-0.5, -1e-5, 0}, turn.col(1)}, {}, 0.0}});
    SolverOptions options;
    options.time_step_s = 0.002;
    options.integrator = Integrator::tr_bdf2;
    Simulation simulation(std::move(body), {}, {}, options);
    const auto along_m = [&] { return turn.col(0).dot(simulation.state().contact.free.centers_m.col(0)); };
    const double start_m = along_m();
    for (int i = 0; i < 100; ++i) {
      const SolveReport report = simulation.step();
      ASSERT_TRUE(report.converged) << report.message << " in step " << i;
    }
    const double way_m = 0.5 * 0.04 * kGravity * (0.5 - 0.3 * std::sqrt(0.75));
    EXPECT_NEAR(along_m() - start_m, friction < 0.5 ? way_m : 0.0, 0.02 * way_m);
  }
}

TEST(MeshObstacle, AFreeMeshInsideAnotherThingIsRefusedByName) {
  Obstacle thing = free_thing(lying_angle(0.05), 0.02);
  const auto why = [&](const ObstacleShape& shape) -> std::string {
    Body body = pad();
    try {
      body.set_obstacles({thing, {"other", shape, {}, 0.0}});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why(Plane{{0, -1, 0}, {0, 1, 0}}), "");
  EXPECT_EQ(why(Sphere{{0, 0.2, 0}, 0.01}), "");
  EXPECT_EQ(why(RoundedBox{{0, 0.2, 0}, {0.01, 0.01, 0.01}, 0.001}), "");
  EXPECT_NE(why(RoundedBox{{0, 0.054, 0}, {0.01, 0.01, 0.01}, 0.001}).find("inside obstacle 'other' at the start"),
            std::string::npos);
}

// Along x, with its ridge at y = 0.1.
Triangles rail(double z_m) {
  Triangles one = prism({{-0.005, -0.01}, {0.005, -0.01}, {0.0, 0.0}, {-0.0025, -0.005}}, 0.04, {{0, 1, 2, 3}});
  one.vertices_m = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).toRotationMatrix() * one.vertices_m;
  one.vertices_m.colwise() += Vector3d(-0.02, 0.1, z_m);
  return one;
}

// Across two ridges, of which no corner touches them: its edges do, or its side.
TEST(MeshObstacle, FreeShapesLieAcrossTheEdgesOfAMesh) {
  for (const ObstacleShape& shape : {ObstacleShape(RoundedBox{{0, 0.1052, 0}, {0.012, 0.01, 0.06}, 0.001}),
                                     ObstacleShape(Capsule{{0, 0.1052, -0.03}, {0, 0.1052, 0.03}, 0.005}),
                                     ObstacleShape(Cylinder{{0, 0.1052, -0.03}, {0, 0.1052, 0.03}, 0.005, 0.0005})}) {
    Body body = pad();
    Obstacle bar{"bar", shape, {}, 0.0};
    bar.mass_kg = 0.03;
    bar.friction_on = {{"front", 0.5}, {"back", 0.5}};
    const MeshShape front = shape_of(rail(-0.02)), back = shape_of(rail(0.015));
    body.set_obstacles({bar, {"front", front, {}, 0.0}, {"back", back, {}, 0.0}});
    SolverOptions options;
    options.time_step_s = 0.002;
    Simulation simulation(std::move(body), {}, {}, options);
    for (int i = 0; i < 100; ++i) {
      const SolveReport report = simulation.step();
      ASSERT_TRUE(report.converged) << report.message << " in step " << i;
    }
    const double sunk_m = 0.105 - simulation.state().contact.free.centers_m(1, 0);
    EXPECT_GT(sunk_m, -1e-5) << shape.index();
    EXPECT_LT(sunk_m, 1e-5) << shape.index();
    Vector3d sum_n = kZero;
    double turn_n = 0.0;
    for (const ContactReading& contact : simulation.contacts()) {
      sum_n += contact.force_n;
      if (contact.on == "bar") turn_n += contact.force_n.y() * contact.center_m.z();
    }
    EXPECT_NEAR(sum_n.y(), 0.03 * kGravity, 1e-3 * 0.03 * kGravity) << shape.index();
    EXPECT_NEAR(turn_n, 0.0, 2e-5) << shape.index();
  }
}

// A large ball on the flat top of a mesh.
TEST(MeshObstacle, AFreeBallRollsOffAMeshAsOnAPlane) {
  constexpr double kRadius = 0.02;
  const auto rolled = [&](const ObstacleShape& ground) {
    Body body = pad();
    Obstacle ball{"ball", Sphere{{0, 0.1 + kRadius + 1e-6, 0}, kRadius}, {}, 0.0};
    ball.mass_kg = 0.05;
    ball.velocity_m_s = {0.05, 0, 0};
    ball.angular_velocity_rad_s = {0, 0, -0.05 / kRadius};
    ball.friction_on = {{"ground", 0.5}};
    body.set_obstacles({ball, {"ground", ground, {}, 0.0}});
    SolverOptions options;
    options.time_step_s = 0.005;
    Simulation simulation(std::move(body), {}, {}, options);
    for (int i = 0; i < 40; ++i) {
      const SolveReport report = simulation.step();
      EXPECT_TRUE(report.converged) << report.message << " in step " << i;
    }
    EXPECT_NEAR(simulation.contacts().back().force_n.y(), 0.05 * kGravity, 1e-3);
    return Vector3d(simulation.state().contact.free.centers_m.col(0));
  };
  const Vector3d expected_m = rolled(RoundedBox{{0, 0.09, 0}, {0.08, 0.02, 0.06}, 0.001});
  EXPECT_NEAR(expected_m.x(), 0.01, 1e-5);
  EXPECT_LT((rolled(shape_of(box_triangles({0, 0.09, 0}, {0.08, 0.02, 0.06}))) - expected_m).norm(), 1e-8);
}

// The L on a table that is a box.
TEST(MeshObstacle, AFreeThingLiesOnABoxByItsWeight) {
  Obstacle thing = free_thing(lying_angle(0.1001), 0.02);
  thing.friction_on = {{"table", 0.3}};
  Body body = pad();
  body.set_obstacles({thing, {"table", RoundedBox{{0, 0.09, 0}, {0.1, 0.02, 0.1}, 0.001}, {}, 0.0}});
  SolverOptions options;
  options.time_step_s = 0.005;
  Simulation simulation(std::move(body), {}, {}, options);
  const double above_m = center_m(thing.shape).y() - 0.1001;
  for (int i = 0; i < 60; ++i) {
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message << " in step " << i;
  }
  EXPECT_NEAR(simulation.state().contact.free.centers_m(1, 0), 0.1 + above_m, 1e-6);
  EXPECT_NEAR(simulation.contacts().back().force_n.y(), 0.02 * kGravity, 1e-4);
}

// A plate of 1 mm comes down by 60 mm in one step: it does not jump through the block.
TEST(MeshObstacle, AThinFastOneDoesNotPassThroughTheBody) {
  Obstacle plate{
      "plate", shape_of(box_triangles({0, 0.022, 0}, {0.06, 0.001, 0.06})), {{0.0}, {0.02, {0, -0.004, 0}}}, 0.0};
  SolverOptions options;
  options.time_step_s = 0.02;
  Simulation simulation = on_block(plate, options);
  const SolveReport report = simulation.step();
  EXPECT_TRUE(report.converged) << report.message;
  EXPECT_LT(simulation.contacts()[0].force_n.y(), -1.0);
  EXPECT_LT(simulation.state().positions_m.row(1).maxCoeff(), 0.0176);
}

}  // namespace
}  // namespace soft_robot_lab
