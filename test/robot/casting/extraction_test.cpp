// SPDX-License-Identifier: BSD-3-Clause
#include "robot/casting/extraction.h"

#include <stdexcept>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "shapes.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

Extraction verify(const Surface& surface, const Eigen::Vector3d& direction) {
  return verify_extraction(CastShape(surface), direction);
}

std::optional<Eigen::Vector3d> best(const Surface& surface) { return best_direction(surface, find_tops(surface)); }

TEST(Extraction, LetsABoxOutWithoutDraft) {
  const Extraction out = verify(box({0.03, 0.02, 0.01}).surface(), kUp);
  EXPECT_TRUE(out.passed);
  EXPECT_NEAR(out.draft_deg, 0, 1e-9);
  EXPECT_NEAR(out.top_area_m2, 6e-4, 1e-12);
}

TEST(Extraction, MeasuresTheDraftOfAFrustum) {
  const double wider = 0.02 * std::tan(5 * kPi / 180);
  const Surface surface = frustum({0.01, 0.01}, {0.01 + wider, 0.01 + wider}, 0.02).surface();
  const Extraction out = verify(surface, kUp);
  EXPECT_TRUE(out.passed);
  EXPECT_NEAR(out.draft_deg, 5, 1e-6);
  const auto direction = best(surface);
  ASSERT_TRUE(direction);
  EXPECT_NEAR(direction->dot(kUp), 1, 1e-9);
}

TEST(Extraction, HoldsAFrustumUpsideDown) {
  const double narrower = 0.02 * std::tan(5 * kPi / 180);
  const Surface surface = frustum({0.01, 0.01}, {0.01 - narrower, 0.01 - narrower}, 0.02).surface();
  const Extraction out = verify(surface, kUp);
  EXPECT_FALSE(out.passed);
  EXPECT_NEAR(out.draft_deg, -5, 1e-6);
  EXPECT_NEAR(out.blocked_area_m2, 4 * 0.02 / std::cos(5 * kPi / 180) * (0.02 - narrower), 1e-9);
  // The mould above the slopes: the prism of the foot less the frustum.
  EXPECT_NEAR(out.undercut_volume_m3, 0.02 * 0.02 * 0.02 - surface.volume_m3(), 0.01 * out.undercut_volume_m3);
}

TEST(Extraction, TurnsAFrustumOverByItself) {
  const double narrower = 0.02 * std::tan(5 * kPi / 180);
  const auto direction = best(frustum({0.01, 0.01}, {0.01 - narrower, 0.01 - narrower}, 0.02).surface());
  ASSERT_TRUE(direction);
  EXPECT_NEAR(direction->dot(-kUp), 1, 1e-9);
}

// Round its axis, by `share` of a facet of `around` over the height.
Surface twisted(Shape shape, double height, double share, int around) {
  Surface surface = shape.surface();
  Eigen::Matrix3Xd vertices_m = surface.vertices_m;
  for (Eigen::Index i = 0; i < vertices_m.cols(); ++i) {
    const double angle = share * 2 * kPi / around * vertices_m(2, i) / height;
    vertices_m.col(i) = Eigen::AngleAxisd(angle, kUp) * surface.vertices_m.col(i);
  }
  return make_surface(vertices_m, surface.triangles);
}

// The facets of an STL file lean where its grid is twisted; its walls do not.
TEST(Extraction, TakesLeaningFacetsForTheRoundWallThatTheyFollow) {
  for (const auto& [around, share] : {std::pair(12, 0.3), {16, 0.5}, {16, -0.5}, {48, 1.0}}) {
    Surface tube = twisted(pipe(0.02, 0.012, 0.05, around), 0.05, share, around);
    EXPECT_FALSE(verify(tube, kUp).passed) << "known as it is";
    tube.estimate_sags();
    const Extraction out = verify(tube, kUp);
    EXPECT_TRUE(out.passed) << around;
    EXPECT_NEAR(out.draft_deg, 0, 0.1) << around;
    EXPECT_TRUE(verify_two_parts(RayTree(tube), kUp).passed) << around;
  }
}

TEST(Extraction, HoldsRoundWallsThatLeanAllTheWayOrBulge) {
  const auto held = [](const std::vector<Eigen::Vector2d>& outline) {
    Surface surface = revolved(outline, 32).surface();
    surface.estimate_sags();
    return verify(surface, kUp).blocked_area_m2;
  };
  EXPECT_EQ(held({{0.002, 0}, {0.01, 0}, {0.01, 0.05}, {0.002, 0.05}}), 0);
  EXPECT_GT(held({{0.002, 0}, {0.01, 0}, {0.0091, 0.05}, {0.002, 0.05}}), 0.001);
  std::vector<Eigen::Vector2d> barrel{{0.002, 0}};
  for (int i = 0; i <= 20; ++i) barrel.emplace_back(0.01 + 0.001 * std::sin(i * kPi / 20), 0.0025 * i);
  barrel.emplace_back(0.002, 0.05);
  EXPECT_GT(held(barrel), 0.0005);
}

TEST(Extraction, FindsTheOnlyWayOutOfAShearedPrism) {
  const double moved = 0.02 * std::tan(30 * kPi / 180);
  const Surface surface = frustum({0.01, 0.01}, {0.01, 0.01}, 0.02, {moved, 0}).surface();
  const Eigen::Vector3d along(std::sin(kPi / 6), 0, std::cos(kPi / 6));
  const Extraction out = verify(surface, along);
  EXPECT_TRUE(out.passed);
  EXPECT_NEAR(out.draft_deg, 0, 1e-6);
  EXPECT_FALSE(verify(surface, kUp).passed);
  const std::vector<HullPlane> tops = find_tops(surface);
  const auto only = std::find_if(tops.begin(), tops.end(), [](const auto& top) { return top.normal.z() > 0.9; });
  ASSERT_NE(only, tops.end());
  const auto direction = best_direction(surface, {*only});
  ASSERT_TRUE(direction);
  EXPECT_NEAR(direction->dot(along), 1, 1e-9);
}

// A T, its bar above or lying: through its flat end it goes, along its stem it does not.
std::vector<Eigen::Vector2d> tee() {
  return {{-0.004, 0},    {0.004, 0},      {0.004, 0.01},  {0.012, 0.01},
          {0.012, 0.016}, {-0.012, 0.016}, {-0.012, 0.01}, {-0.004, 0.01}};
}

TEST(Extraction, DrawsATeeAlongItsLengthAndByItsBar) {
  const Surface surface = prism(tee(), 0.03, {0, 0.012}).surface();
  EXPECT_TRUE(verify(surface, kUp).passed);
  EXPECT_TRUE(verify(surface, Eigen::Vector3d::UnitY()).passed);
  const Extraction down = verify(surface, -kUp);
  EXPECT_FALSE(down.passed);
  EXPECT_NEAR(down.blocked_area_m2, 2 * 0.008 * 0.03, 1e-9);
  EXPECT_NEAR(down.trap_depth_m, 0.01, 1e-6);
  EXPECT_NEAR(down.undercut_volume_m3, 2 * 0.008 * 0.03 * 0.01, 1e-10);
}

TEST(Extraction, NamesBothBarsOfADoubleTeeAndLetsTwoPartsDrawIt) {
  // Like a spool of boxes on a core, seen from the side: nothing flat spans it, two halves do.
  Shape spool = revolved({{0.002, 0},
                          {0.01, 0},
                          {0.01, 0.003},
                          {0.005, 0.003},
                          {0.005, 0.009},
                          {0.01, 0.009},
                          {0.01, 0.012},
                          {0.002, 0.012}},
                         8);
  const Surface surface = spool.surface();
  EXPECT_FALSE(best(surface));
  const RayTree tree(surface);
  EXPECT_FALSE(verify_two_parts(tree, kUp).passed);
  const TwoPart across = verify_two_parts(tree, Eigen::Vector3d::UnitX());
  EXPECT_FALSE(across.passed);  // its bore lies across that way
  EXPECT_GT(across.undercut_volume_m3, 0);
}

TEST(Extraction, LetsTwoPartsDrawASphere) {
  std::vector<Eigen::Vector2d> outline;
  for (int i = 0; i <= 20; ++i) {
    const double turn = -kPi / 2 + kPi * i / 20;
    outline.emplace_back(std::max(1e-5, 0.01 * std::cos(turn)), 0.01 * std::sin(turn));
  }
  const Surface surface = revolved(outline, 40).surface();
  const RayTree tree(surface);
  EXPECT_FALSE(best(surface));
  EXPECT_LT(verify_two_parts(tree, kUp).blocked_area_m2, 1e-4 * surface.areas_m2.sum());
}

TEST(Extraction, RefusesASurfaceWithAHole) {
  Shape shape = box({1, 1, 1});
  shape.triangles.pop_back();
  try {
    shape.surface();
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("is not closed: an edge at ("), std::string::npos) << error.what();
  }
}

TEST(Extraction, RefusesASurfaceThatIsInsideOut) {
  Shape shape = box({1, 1, 1});
  shape.turn_inside_out();
  EXPECT_THROW(shape.surface(), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
