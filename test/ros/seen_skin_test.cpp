// SPDX-License-Identifier: BSD-3-Clause
#include "ros/view/seen_skin.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

using Point = Eigen::Vector3f;

// Two triangles that turn counter-clockwise from without.
void add_square(const Point& origin, const Point& u, const Point& v, std::vector<Point>& corners) {
  for (const Point& corner : {origin, Point(origin + u), Point(origin + u + v)}) corners.push_back(corner);
  for (const Point& corner : {origin, Point(origin + u + v), Point(origin + v)}) corners.push_back(corner);
}

void add_cube(const Point& least, float size, std::vector<Point>& corners) {
  const Point x(size, 0, 0), y(0, size, 0), z(0, 0, size);
  add_square(least, z, y, corners);      // -x
  add_square(least + x, y, z, corners);  // +x
  add_square(least, x, z, corners);      // -y
  add_square(least + y, z, x, corners);  // +y
  add_square(least, y, x, corners);      // -z
  add_square(least + z, x, y, corners);  // +z
}

SeenSkin cubes(const std::vector<float>& at_y) {
  std::vector<Point> corners;
  for (const float y : at_y) add_cube({0, y, 0}, 1.0f, corners);
  SeenSkin skin;
  skin.set_corners(corners);
  return skin;
}

const Point before(0.5f, -10.0f, 0.5f), aslant(-8.0f, -10.0f, 7.0f);

TEST(SeenSkin, ShowsOnlyWhatFacesTheEye) {
  const SeenSkin cube = cubes({0.0f});
  EXPECT_EQ(cube.sorted_from(before).size(), 2u) << "one square";
  EXPECT_EQ(cube.sorted_from(aslant).size(), 6u) << "three";
  EXPECT_TRUE(cube.sorted_from({0.5f, 0.5f, 0.5f}).empty()) << "from within";
}

// A translucent skin that is drawn otherwise shows the pattern of its triangles.
TEST(SeenSkin, OrdersTrianglesFromTheFarthestToTheNearest) {
  const SeenSkin skin = cubes({0.0f, 5.0f, 2.5f});
  for (const Point& eye : {before, aslant, Point(0.3f, 20.0f, 1.0f)}) {
    float last = INFINITY;
    for (const int triangle : skin.sorted_from(eye)) {
      const Point* corner = &skin.corners_m()[static_cast<std::size_t>(3 * triangle)];
      const float distance = (Point((corner[0] + corner[1] + corner[2]) / 3.0f) - eye).norm();
      EXPECT_LE(distance, last + 1e-4f);
      last = distance;
    }
  }
}

TEST(SeenSkin, DrawsCreasesAndOutlinesOnce) {
  const SeenSkin cube = cubes({0.0f});
  EXPECT_EQ(cube.edges().size(), 18u) << "twelve, and the diagonals of six squares";
  const auto drawn = [&](const Point& eye) {
    return std::count_if(cube.edges().begin(), cube.edges().end(),
                         [&](const SeenSkin::Edge& edge) { return cube.is_drawn(edge, eye); });
  };
  EXPECT_EQ(drawn(before), 4);
  EXPECT_EQ(drawn(aslant), 9) << "no diagonal, none of the three hidden edges";
}

TEST(SeenSkin, KnowsHowMuchACornerTurnsAway) {
  const SeenSkin cube = cubes({0.0f});
  for (const int triangle : cube.sorted_from(before))
    for (int corner = 3 * triangle; corner < 3 * triangle + 3; ++corner)
      EXPECT_GT(cube.facing(corner, before), 0.99f) << "no normal is taken across a sharp edge";
  for (int corner = 0; corner < 6; ++corner) EXPECT_LT(cube.facing(corner, before), 0.06f) << "a side, seen along it";
}

TEST(SeenSkin, FollowsASkinThatMovesAndAnotherOne) {
  SeenSkin skin = cubes({0.0f});
  std::vector<Point> corners = skin.corners_m();
  for (Point& corner : corners) corner.z() += 0.2f * corner.x();
  skin.set_corners(corners);
  EXPECT_EQ(skin.edges().size(), 18u);
  EXPECT_EQ(skin.sorted_from(before).size(), 2u);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] += Point(static_cast<float>(i / 3), 0, 0);  // torn apart
  skin.set_corners(corners);
  EXPECT_EQ(skin.edges().size(), 36u);
  skin.set_corners({});
  EXPECT_TRUE(skin.edges().empty());
  EXPECT_TRUE(skin.sorted_from(before).empty());
}

TEST(SeenSkin, FollowsAPlaceThatIsHeld) {
  SeenSkin skin = cubes({0.0f});
  const SeenSkin::Place held = skin.nearest({0.3f, -0.2f, 0.6f});
  EXPECT_LT((skin.at(held) - Point(0.3f, 0.0f, 0.6f)).norm(), 1e-5f);
  std::vector<Point> corners = skin.corners_m();
  for (Point& corner : corners) corner += Point(0.0f, corner.x(), 0.0f);
  skin.set_corners(corners);
  EXPECT_LT((skin.at(held) - Point(0.3f, 0.3f, 0.6f)).norm(), 1e-5f);
}

TEST(SeenSkin, LeavesOutTrianglesWithoutAnArea) {
  SeenSkin skin;
  skin.set_corners({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  EXPECT_TRUE(skin.sorted_from(before).empty());
  EXPECT_EQ(skin.facing(0, before), 0.0f);
}

}  // namespace
}  // namespace soft_robot_lab
