// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/body.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "box_mesh.h"
#include "soft_robot_lab/mechanics/embedding.h"
#include "soft_robot_lab/mechanics/marker.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kEverywhere = Eigen::Vector3d::Constant(10.0);

TEST(Body, MassIsDensityTimesVolume) {
  for (const bool quadratic : {true, false}) {
    const Body body(box_mesh({0, 0, 0}, {0.1, 0.02, 0.03}, {3, 2, 1}, quadratic), {1e5, 0.4, 1070.0});
    EXPECT_NEAR(body.node_masses_kg().sum(), 1070.0 * 0.1 * 0.02 * 0.03, 1e-12);
    EXPECT_GT(body.node_masses_kg().minCoeff(), 0.0);
  }
}

TEST(Body, TractionSpreadsOverTheFacesInTheBox) {
  for (const bool quadratic : {true, false}) {
    Body body(box_mesh({0, 0, 0}, {0.1, 0.02, 0.03}, {3, 2, 2}, quadratic), Material{});
    const double area = body.add_traction({0.1 - 1e-9, -1, -1}, kEverywhere, {0, 5.0, 0});
    EXPECT_NEAR(area, 0.02 * 0.03, 1e-12);
    body.add_force({-1, -1, -1}, {1e-9, 1, 1}, {2.0, 0, 0});
    const Eigen::Vector3d total = body.external_forces_n().rowwise().sum();
    EXPECT_NEAR(total.x(), 2.0, 1e-12);
    EXPECT_NEAR(total.y(), 5.0 * 0.02 * 0.03, 1e-12);
    EXPECT_THROW(body.add_force({5, 5, 5}, {6, 6, 6}, {1, 0, 0}), std::invalid_argument);
  }
}

TEST(Body, HoldsTheNodesInTheBoxOnTheGivenAxes) {
  Body body(box_mesh({0, 0, 0}, {0.1, 0.02, 0.02}, {5, 1, 1}), Material{});
  EXPECT_EQ(body.fixed_node_count(), 0);
  EXPECT_EQ(body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, false, false}), 9);
  EXPECT_EQ(body.fixed_node_count(), 9);
  EXPECT_EQ(body.fixed().row(0).count(), 9);
  EXPECT_EQ(body.fixed().row(1).count(), 0);
}

TEST(Material, RefusesWhatNoSiliconeCanBe) {
  struct Case {
    Material material;
    const char* words;
  };
  const Case cases[] = {{{0.0, 0.4, 1000}, "youngs_modulus_pa: 0 is out of range (0"},
                        {{1e5, 0.5, 1000}, "poissons_ratio: 0.5 is out of range [0, 0.5)"},
                        {{1e5, -0.1, 1000}, "poissons_ratio: -0.1"},
                        {{1e5, 0.4, -1}, "density_kg_m3: -1 is out of range (0"},
                        {{std::nan(""), 0.4, 1000}, "youngs_modulus_pa: nan"},
                        {Material::mooney_rivlin(5e4, -1e3, 0.4, 1000), "c01_pa: -1000 is out of range [0"},
                        {Material::mooney_rivlin(-1e3, 5e4, 0.4, 1000), "c10_pa: -1000 is out of range [0"},
                        {Material::mooney_rivlin(0, 0, 0.4, 1000), "c10_pa: 0 is out of range [0"},
                        {Material::mooney_rivlin(5e4, 1e3, 0.5, 1000), "poissons_ratio: 0.5"},
                        {Material::yeoh(-5e4, 0, 0, 0.4, 1000), "c1_pa: -50000 is out of range (0"},
                        {Material::yeoh(5e4, -1e2, 0, 0.4, 1000), "c2_pa: -100 is out of range [0"},
                        {Material::yeoh(3e4, -3.1e3, 100, 0.4, 1000), "c2_pa: -3100 is out of range (-3000"},
                        {Material::yeoh(5e4, 1e3, -1, 0.4, 1000), "c3_pa: -1 is out of range [0"},
                        {Material::yeoh(5e4, std::nan(""), 0, 0.4, 1000), "c2_pa: nan"}};
  for (const Case& wrong : cases) {
    try {
      wrong.material.validate();
      FAIL() << wrong.words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(wrong.words), std::string::npos) << error.what();
    }
  }
}

TEST(Material, TakesConstantsThatStayStable) {
  EXPECT_NO_THROW(Material::yeoh(3e4, -2.9e3, 100, 0.4, 1000).validate());
  EXPECT_NO_THROW(Material::mooney_rivlin(0, 3e4, 0.4, 1000).validate());
  EXPECT_NEAR(Material::mooney_rivlin(2e4, 3e4, 0.4, 1000).lame_mu_pa(), 1e5, 1e-9);
  EXPECT_NEAR(Material::yeoh(5e4, 1e3, 10, 0.4, 1000).youngs_modulus_pa, 2.8e5, 1e-9);
}

class LocatorTest : public ::testing::Test {
 protected:
  TetMesh mesh_ = [] {
    TetMesh mesh = box_mesh({0, 0, 0}, {0.04, 0.02, 0.02}, {4, 2, 2});
    complete_boundary(mesh);
    return mesh;
  }();
  MeshLocator locator_{mesh_};
};

TEST_F(LocatorTest, FindsPointsInside) {
  const Eigen::Vector3d point(0.013, 0.011, 0.007);
  const Location location = locator_.locate(point);
  EXPECT_EQ(location.distance_m, 0.0);
  EXPECT_LT((locator_.embed(location).at(mesh_.nodes_m) - point).norm(), 1e-12);
}

TEST_F(LocatorTest, MovesOutsidePointsToTheNearestPlaceAndSaysHowFar) {
  const Location location = locator_.locate({0.045, 0.01, 0.013});
  EXPECT_NEAR(location.distance_m, 0.005, 1e-9);
  EXPECT_LT((location.nearest_m - Eigen::Vector3d(0.04, 0.01, 0.013)).norm(), 1e-9);
  EXPECT_LT((locator_.embed(location).at(mesh_.nodes_m) - location.nearest_m).norm(), 1e-9);
}

TEST_F(LocatorTest, CarriesPointsThroughAQuadraticField) {
  // Quadratic elements reproduce quadratic motion exactly, wherever the point lies.
  const auto bend = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p + Eigen::Vector3d(-p.z() * p.x(), p.y() * p.y(), 5.0 * p.x() * p.x()));
  };
  Eigen::Matrix3Xd bent = mesh_.nodes_m;
  for (Eigen::Index i = 0; i < bent.cols(); ++i) bent.col(i) = bend(mesh_.nodes_m.col(i));
  const Eigen::Vector3d point(0.0137, 0.0022, 0.0171);
  EXPECT_LT((locator_.embed(point).at(bent) - bend(point)).norm(), 1e-12);
}

TEST_F(LocatorTest, SpreadsPointsWithoutMovingTheirCentre) {
  const Eigen::Vector3d centre(0.02, 0.01, 0.01);
  EXPECT_LT((locator_.embed_disc(centre, {1, 0, 0}, 0.003).at(mesh_.nodes_m) - centre).norm(), 1e-12);
  EXPECT_LT((locator_.embed_box(centre, 0.006).at(mesh_.nodes_m) - centre).norm(), 1e-12);
  const EmbeddedPoint disc = locator_.embed_disc(centre, {1, 0, 0}, 0.003);
  double sum = 0.0;
  for (double weight : disc.weights) sum += weight;
  EXPECT_NEAR(sum, 1.0, 1e-12);
}

TEST_F(LocatorTest, RefusesAPointThatIsNotANumber) {
  EXPECT_THROW(locator_.locate({std::nan(""), 0, 0}), std::invalid_argument);
}

TEST_F(LocatorTest, StalkedMarkersTurnWithTheSkin) {
  const Marker marker("flag", {0.05, 0.01, 0.01}, mesh_, locator_);
  const Eigen::Affine3d motion = Eigen::Translation3d(0.1, 0.0, 0.0) * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY());
  EXPECT_LT((marker.position(motion * mesh_.nodes_m) - motion * Eigen::Vector3d(0.05, 0.01, 0.01)).norm(), 1e-12);
}

TEST_F(LocatorTest, MarkerVelocitiesAgreeWithCentralDifferences) {
  const Marker marker("flag", {0.047, 0.013, 0.01}, mesh_, locator_);
  Eigen::Matrix3Xd positions = mesh_.nodes_m, motion = mesh_.nodes_m;
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    positions.data()[i] += 0.0008 * std::sin(1.7 * static_cast<double>(i));
    motion.data()[i] = std::cos(0.9 * static_cast<double>(i));
  }
  const double h = 1e-7;
  const Eigen::Vector3d expected =
      (marker.position(positions + h * motion) - marker.position(positions - h * motion)) / (2.0 * h);
  EXPECT_LT((marker.velocity(positions, motion) - expected).norm(), 1e-6 * expected.norm());
}

}  // namespace
}  // namespace soft_robot_lab
