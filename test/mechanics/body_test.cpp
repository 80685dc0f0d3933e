// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/body.h"

#include <cmath>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "box_mesh.h"
#include "soft_robot_lab/mechanics/embedding.h"
#include "soft_robot_lab/mechanics/marker.h"
#include "soft_robot_lab/mechanics/simulation.h"

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

// Corners that are not on the mesh's lines; the load's middle is that of the box.
TEST(Body, ALoadActsOnThePartOfEachFaceInItsBox) {
  for (const bool quadratic : {true, false}) {
    const TetMesh mesh = box_mesh({0, 0, 0}, {0.1, 0.02, 0.03}, {3, 2, 2}, quadratic);
    const Eigen::Vector3d from(0.0123, 0.02 - 1e-6, 0.0071), to(0.0789, 1, 0.0233);
    const double area_m2 = (0.0789 - 0.0123) * (0.0233 - 0.0071);
    Body body(mesh, Material{});
    EXPECT_NEAR(body.add_traction(from, to, {0, 0, 7.0}), area_m2, 1e-12 * area_m2);
    const Eigen::Matrix3Xd forces_n = body.external_forces_n();
    EXPECT_NEAR(forces_n.row(2).sum(), 7.0 * area_m2, 1e-12);
    EXPECT_NEAR(forces_n.row(2).dot(mesh.nodes_m.row(0)), 7.0 * area_m2 * 0.5 * (0.0123 + 0.0789), 1e-12);
    EXPECT_NEAR(forces_n.row(2).dot(mesh.nodes_m.row(2)), 7.0 * area_m2 * 0.5 * (0.0071 + 0.0233), 1e-12);
    Body pulled(mesh, Material{});
    pulled.add_force(from, to, {0, 0, 7.0 * area_m2});
    EXPECT_LT((pulled.external_forces_n() - forces_n).cwiseAbs().maxCoeff(), 1e-12);
    ASSERT_EQ(pulled.loads().size(), 1u);
    EXPECT_NEAR(pulled.loads()[0].area_m2, area_m2, 1e-12 * area_m2);
    EXPECT_EQ(pulled.loads()[0].force_n, Eigen::Vector3d(0, 0, 7.0 * area_m2));
  }
}

TEST(Body, HalfAFaceHasHalfOfTheLoad) {
  const TetMesh mesh = box_mesh({0, 0, 0}, {0.02, 0.02, 0.02}, {1, 1, 1});
  Body body(mesh, Material{});
  EXPECT_NEAR(body.add_traction({-1, 0.02 - 1e-6, -1}, {0.01, 1, 1}, {0, 1, 0}), 2e-4, 1e-15);
  EXPECT_NEAR(body.external_forces_n().sum(), 2e-4, 1e-15);
}

// The diagonals of faces are not mirrored.
TEST(Body, MirroredTractionsBalance) {
  const TetMesh mesh = box_mesh({-0.03, -0.012, 0}, {0.03, 0.012, 0.01}, {7, 3, 1});
  Body body(mesh, Material{});
  const double above = body.add_traction({-0.0113, 0.012 - 1e-6, -1}, {0.0049, 0.012 + 1e-6, 1}, {0, -100.0, 0}),
               below = body.add_traction({-0.0113, -0.012 - 1e-6, -1}, {0.0049, -0.012 + 1e-6, 1}, {0, 100.0, 0});
  EXPECT_NEAR(above, 0.0162 * 0.01, 1e-16);
  EXPECT_NEAR(above, below, 1e-12 * above);
  const Eigen::Matrix3Xd forces_n = body.external_forces_n();
  EXPECT_NEAR(forces_n.row(1).sum(), 0.0, 1e-14);
  EXPECT_NEAR(forces_n.row(1).dot(mesh.nodes_m.row(0)), 0.0, 1e-14);
}

TEST(Body, AThinBoxAroundAnEdgeLoadsTheEdge) {
  Body body(box_mesh({0, 0, 0}, {0.1, 0.02, 0.03}, {3, 2, 2}), Material{});
  body.add_force({0.1 - 1e-6, 0.02 - 1e-6, -1}, {1, 1, 1}, {0, 1, 0});
  EXPECT_EQ(body.loads()[0].area_m2, 0.0);
  EXPECT_NEAR(body.external_forces_n().row(1).sum(), 1.0, 1e-12);
  for (int node = 0; node < body.mesh().node_count(); ++node) {
    if (body.external_forces_n()(1, node) == 0.0) continue;
    EXPECT_LT((body.mesh().nodes_m.col(node).head<2>() - Eigen::Vector2d(0.1, 0.02)).norm(), 1e-12);
  }
}

// On top a parabola along x, which quadratic faces have exactly.
TEST(Body, ACurvedFaceIsCutWhereTheBoxCutsIt) {
  TetMesh mesh = box_mesh({-0.02, 0, 0}, {0.02, 0.01, 0.01}, {4, 2, 2});
  for (int node = 0; node < mesh.node_count(); ++node)
    mesh.nodes_m(2, node) += 10.0 * std::pow(mesh.nodes_m(0, node), 2);
  Body body(mesh, Material{});
  const auto length_m = [](double x) { return 0.5 * x * std::sqrt(1.0 + 400.0 * x * x) + std::asinh(20.0 * x) / 40.0; };
  const double along_m2 = 0.008 * (length_m(0.0177) - length_m(0.0031));
  EXPECT_NEAR(body.add_traction({0.0031, 0.001, 0.005}, {0.0177, 0.009, 1}, {1, 0, 0}), along_m2, 1e-6 * along_m2);
  const double high_m2 = 2.0 * 0.008 * (length_m(0.0199) - length_m(std::sqrt(1.7e-4)));
  EXPECT_NEAR(body.add_traction({-0.0199, 0.001, 0.0117}, {0.0199, 0.009, 1}, {1, 0, 0}), high_m2, 3e-3 * high_m2);
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

TEST_F(LocatorTest, ADiscTurnsWithTheMesh) {
  const Eigen::Vector3d centre(0.023, 0.0093, 0.0104), normal(0.9, 0.1, -0.2);
  const EmbeddedPoint disc = locator_.embed_disc(centre, normal, 0.003);
  TetMesh turned = mesh_;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).matrix();
  turned.nodes_m = turn * mesh_.nodes_m;
  const EmbeddedPoint there = MeshLocator(turned).embed_disc(turn * centre, turn * normal, 0.003);
  const auto weights = [&](const EmbeddedPoint& point) {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(mesh_.node_count());
    for (std::size_t k = 0; k < point.nodes.size(); ++k) all[point.nodes[k]] += point.weights[k];
    return all;
  };
  EXPECT_LT((weights(disc) - weights(there)).cwiseAbs().maxCoeff(), 1e-12);
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
