// SPDX-License-Identifier: BSD-3-Clause
// Gaps to rigid shapes, against closed forms and central differences.
#include "mechanics/body/gap.h"
#include "mechanics/body/rigid_places.h"

#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

const Vector3d kZero = Vector3d::Zero();

struct Named {
  const char* name;
  ObstacleShape shape;
};

std::vector<Named> shapes() {
  return {{"plane", Plane{{0.1, 0.2, -0.1}, {1.0, 2.0, -0.5}}},
          {"sphere", Sphere{{0.1, 0.2, -0.1}, 0.3}},
          {"capsule", Capsule{{-0.2, 0.1, 0.0}, {0.3, 0.4, -0.2}, 0.1}},
          {"cylinder", Cylinder{{-0.2, 0.1, 0.0}, {0.3, 0.4, -0.2}, 0.2, 0.05}},
          {"box", RoundedBox{{0.1, 0.0, -0.1}, {0.4, 0.6, 0.8}, 0.05}}};
}

Obstacle turned(const ObstacleShape& shape) { return {"it", shape, {{0.0, {0.05, -0.1, 0.2}, {0.4, -0.7, 0.3}}}, 0.0}; }

std::vector<Vector3d> places(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> side(-0.9, 0.9);
  std::vector<Vector3d> all;
  for (int i = 0; i < count; ++i) {
    const double x = side(random), y = side(random), z = side(random);
    all.emplace_back(x, y, z);
  }
  return all;
}

TEST(Gap, NormalAndHessianAreItsDerivatives) {
  constexpr double kStep = 1e-6;
  for (const Named& one : shapes()) {
    const Eigen::Isometry3d pose = pose_at(turned(one.shape), 0.0);
    for (const Vector3d& at : places(300)) {
      const Gap here = gap_to(one.shape, pose, at);
      if (here.gap_m < -0.03) continue;  // deep inside another side may be near
      EXPECT_NEAR(here.normal.norm(), 1.0, 1e-12) << one.name;
      for (int axis = 0; axis < 3; ++axis) {
        const Gap more = gap_to(one.shape, pose, at + kStep * Vector3d::Unit(axis));
        const Gap less = gap_to(one.shape, pose, at - kStep * Vector3d::Unit(axis));
        EXPECT_NEAR((more.gap_m - less.gap_m) / (2 * kStep), here.normal[axis], 1e-7) << one.name;
        const Vector3d change = (more.normal - less.normal) / (2 * kStep);
        if ((more.hessian - less.hessian).norm() > 1e-3 * here.hessian.norm()) continue;  // over a seam of the shape
        EXPECT_LT((change - here.hessian.col(axis)).norm(), 1e-6 * (1.0 + here.hessian.norm())) << one.name;
      }
    }
  }
}

TEST(Gap, NormalIsContinuousOutsideAndToTheRoundingInside) {
  for (const Named& one : shapes())
    for (const Vector3d& at : places(2000)) {
      const Gap here = gap_to(one.shape, at);
      if (here.gap_m < -0.04) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Gap near = gap_to(one.shape, at + 1e-7 * Vector3d::Unit(axis));
        EXPECT_LT((near.normal - here.normal).norm(), 2e-5) << one.name << " at " << at.transpose();
      }
    }
}

// The point of the surface below each place outside: a gap of zero, and as far away as the gap says.
TEST(Gap, IsTheDistanceToTheSurface) {
  for (const Named& one : shapes())
    for (const Vector3d& at : places(300)) {
      const Gap here = gap_to(one.shape, at);
      if (here.gap_m < 0.0) continue;
      const Gap below = gap_to(one.shape, at - here.gap_m * here.normal);
      EXPECT_NEAR(below.gap_m, 0.0, 1e-12) << one.name;
    }
}

TEST(Gap, HasTheClosedFormsOfEachShape) {
  EXPECT_NEAR(gap_to(Plane{{0, 0, 0.5}, {0, 0, 4}}, Vector3d(3, -2, 0.7)).gap_m, 0.2, 1e-15);
  EXPECT_NEAR(gap_to(Sphere{{0, 0, 0}, 1.0}, Vector3d(0, 3, 4)).gap_m, 4.0, 1e-15);
  const Capsule capsule{{0, 0, 0}, {2, 0, 0}, 0.5};
  EXPECT_NEAR(gap_to(capsule, Vector3d(1, 0, 2)).gap_m, 1.5, 1e-15);
  EXPECT_NEAR(gap_to(capsule, Vector3d(5, 0, 4)).gap_m, 4.5, 1e-15);
  const Cylinder cylinder{{0, 0, -1}, {0, 0, 1}, 0.5, 0.1};
  EXPECT_NEAR(gap_to(cylinder, Vector3d(1.5, 0, 0.3)).gap_m, 1.0, 1e-15);
  EXPECT_NEAR(gap_to(cylinder, Vector3d(0.1, 0.1, -1.2)).gap_m, 0.2, 1e-15);
  EXPECT_NEAR(gap_to(cylinder, Vector3d(0.4 + 0.3, 0, 0.9 + 0.4)).gap_m, 0.4, 1e-12);
  EXPECT_NEAR(gap_to(cylinder, Vector3d(0.45, 0, 0)).gap_m, -0.05, 1e-15);
  const RoundedBox box{{0, 0, 0}, {2, 4, 6}, 0.2};
  EXPECT_NEAR(gap_to(box, Vector3d(1.5, 0.3, 0.2)).gap_m, 0.5, 1e-15);
  EXPECT_NEAR(gap_to(box, Vector3d(0.8 + 0.1, 1.8 + 0.2, 2.8 + 0.2)).gap_m, 0.1, 1e-12);
  EXPECT_NEAR(gap_to(box, Vector3d(-0.9, 0, 0)).gap_m, -0.1, 1e-15);
}

TEST(Gap, AnObstacleMovesAndTurnsEvenlyAboutItsMiddle) {
  const Obstacle box{"box",
                     RoundedBox{{1, 2, 3}, {2, 1, 1}, 0.1},
                     {{1.0, {0, 0, 0}, {0, 0, 0}}, {3.0, {0.4, 0, 0}, {0, 0, M_PI / 2}}},
                     0.0};
  EXPECT_TRUE(pose_at(box, 0.0).isApprox(Eigen::Isometry3d::Identity()));
  const Eigen::Isometry3d half = pose_at(box, 2.0);
  EXPECT_TRUE((half * Vector3d(1, 2, 3)).isApprox(Vector3d(1.2, 2, 3), 1e-12));
  EXPECT_TRUE((half * Vector3d(2, 2, 3)).isApprox(Vector3d(1.2 + std::sqrt(0.5), 2 + std::sqrt(0.5), 3), 1e-12));
  EXPECT_TRUE((pose_at(box, 9.0) * Vector3d(2, 2, 3)).isApprox(Vector3d(1.4, 3, 3), 1e-12));
  // Turned by a quarter, its long side of half length 1 lies along y.
  EXPECT_NEAR(gap_to(box.shape, pose_at(box, 3.0), Vector3d(1.4, 3.5, 3)).gap_m, 0.5, 1e-12);
}

TEST(Obstacle, RefusesShapesAndMotionsOutOfRangeByName) {
  const auto message = [](const Obstacle& obstacle) -> std::string {
    try {
      obstacle.validate();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message({"a", Sphere{{0, 0, 0}, -1.0}, {}, 0.0}), "radius_m: -1 is out of range (0, inf)");
  EXPECT_EQ(message({"a", Sphere{{0, 0, 0}, 1.0}, {}, -0.5}), "friction: -0.5 is out of range [0, inf)");
  EXPECT_EQ(message({"a", Capsule{{1, 0, 0}, {1, 0, 0}, 1.0}, {}, 0.0}), "end_m: is where start_m is; must differ");
  EXPECT_NE(
      message({"a", RoundedBox{{0, 0, 0}, {1, 1, 0.2}, 0.2}, {}, 0.0}).find("rounding_m: 0.2 is out of range (0, 0.1]"),
      std::string::npos);
  EXPECT_NE(message({"a", Plane{{0, 0, 0}, {0, 0, 0}}, {}, 0.0}).find("normal"), std::string::npos);
  EXPECT_NE(message({"a", Sphere{{0, 0, 0}, 1.0}, {{1.0, kZero, kZero}, {1.0, kZero, kZero}}, 0.0})
                .find("motion[1].time_s: 1"),
            std::string::npos);
  EXPECT_EQ(message({"a", Sphere{{0, 0, 0}, 1.0}, {{0.0, kZero, kZero}, {1.0, kZero, {0, 0, 6.25}}}, 0.0}),
            "motion[1].rotation_rad: turns by 6.25 rad from the pose before, out of range [0, pi], as the shorter way "
            "round is taken; add poses between");
  EXPECT_EQ(message({"a", Sphere{{0, 0, 0}, 1.0}, {{0.0, kZero, {0, 0, -1.5}}, {1.0, kZero, {0, 0, 1.5}}}, 0.0}), "");
  EXPECT_EQ(message({"a", Sphere{{0, 0, 0}, 1.0}, {{0.0, kZero, {3, 0, 0}}, {1.0, kZero, {0, 3, 0}}}, 0.0}), "");
  EXPECT_NE(message({"a", Sphere{{0, 0, std::nan("")}, 1.0}, {}, 0.0}).find("center_m"), std::string::npos);
  EXPECT_EQ(message({"a", Cylinder{{0, 0, 0}, {0, 0, 1}, 0.2, 0.02}, {{0.0, kZero, kZero}, {1.0, kZero, kZero}}, 0.3}),
            "");
}

// How far apart two convex shapes are, by going to and fro between their closest points.
double by_projections_m(const PlacedShape& one, const PlacedShape& other) {
  Vector3d at_m = one.pose * center_m(one.shape);
  double gap_m = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const PlacedShape& to = i % 2 == 0 ? other : one;
    const Gap gap = gap_to(to.shape, to.pose, at_m);
    gap_m = gap.gap_m;
    at_m -= gap_m * gap.normal;
  }
  return gap_m;
}

// However two shapes are turned, one of the places where they may touch is the nearest of all.
TEST(RigidPlaces, TheNearestIsAsFarAsTheShapesAre) {
  const std::vector<ObstacleShape> shapes{Sphere{kZero, 0.01}, Capsule{{-0.03, 0, 0}, {0.03, 0, 0}, 0.005},
                                          Cylinder{{0, 0, -0.02}, {0, 0, 0.02}, 0.01, 0.0005},
                                          RoundedBox{kZero, {0.02, 0.04, 0.06}, 0.0005},
                                          Cylinder{{0, 0, -0.002}, {0, 0, 0.002}, 0.02, 0.0002}};
  std::mt19937 random(7);
  std::normal_distribution<double> any;
  const auto turned = [&] {
    const double x = any(random), y = any(random), z = any(random), w = any(random);
    return Eigen::Quaterniond(w, x, y, z).normalized();
  };
  for (std::size_t i = 0; i < 200; ++i) {
    const std::size_t a = i % shapes.size(), b = i / shapes.size() % shapes.size();
    PlacedShape one{shapes[a], Eigen::Isometry3d(turned())}, other{shapes[b], Eigen::Isometry3d(turned())};
    const Vector3d way = turned() * Vector3d::UnitX();
    double far_m = 0.2, near_m = 0.0;  // moved in until they are half a millimetre apart
    for (int k = 0; k < 25; ++k) {
      const double middle_m = 0.5 * (far_m + near_m);
      one.pose.translation() = middle_m * way;
      (apart_m(one, other) > 5e-4 ? far_m : near_m) = middle_m;
    }
    one.pose.translation() = far_m * way;
    double least_m = 1.0;
    for (const RigidPlace& place : rigid_places(one.shape, other.shape)) {
      const std::optional<RigidMeeting> met = meet(place, one.shape, one.pose, other.shape, other.pose);
      if (met) least_m = std::min(least_m, met->gap_m);
    }
    EXPECT_NEAR(least_m, 5e-4, 2e-6) << "shapes " << a << " and " << b << ", case " << i;
    EXPECT_NEAR(by_projections_m(one, other), 5e-4, 2e-6) << "shapes " << a << " and " << b << ", case " << i;
  }
}

TEST(RigidPlaces, OverlapsAreAsDeepAsTheyAre) {
  const auto at = [](double x, double y, double z) { return Eigen::Isometry3d(Eigen::Translation3d(x, y, z)); };
  const ObstacleShape ball = Sphere{kZero, 0.01}, bar = RoundedBox{kZero, {0.1, 0.01, 0.01}, 0.001},
                      across = RoundedBox{kZero, {0.01, 0.1, 0.01}, 0.001}, floor = Plane{kZero, Vector3d::UnitZ()};
  EXPECT_NEAR(apart_m({ball, at(0, 0, 0.004)}, {floor, at(0, 0, 0)}), -0.006, 1e-8);
  EXPECT_NEAR(apart_m({ball, at(0, 0, 0.012)}, {ball, at(0, 0, 0)}), -0.008, 1e-8);
  EXPECT_NEAR(apart_m({bar, at(0, 0, 0.007)}, {across, at(0, 0, 0)}), -0.003, 1e-8);
  EXPECT_NEAR(apart_m({bar, at(0, 0, 0.013)}, {across, at(0, 0, 0)}), 0.003, 1e-8);
  EXPECT_NEAR(apart_m({bar, at(0, 0, 0)}, {across, at(0, 0, 0)}), -0.01, 1e-8);
}

}  // namespace
}  // namespace soft_robot_lab
