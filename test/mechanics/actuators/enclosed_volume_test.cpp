// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuators/enclosed_volume.h"

#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "dense_sink.h"
#include "hollow_mesh.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"

namespace soft_robot_lab {
namespace {

std::vector<int> named_faces(const TetMesh& mesh, int surface = 0) {
  std::vector<int> faces;
  for (std::size_t face = 0; face < mesh.face_surface.size(); ++face)
    if (mesh.face_surface[face] == surface) faces.push_back(static_cast<int>(face));
  return faces;
}

Eigen::Matrix3Xd disturbed(const TetMesh& mesh, double size_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> offset(-size_m, size_m);
  Eigen::Matrix3Xd result = mesh.nodes_m;
  for (Eigen::Index i = 0; i < result.size(); ++i) result.data()[i] += offset(random);
  return result;
}

struct Case {
  const char* name;
  TetMesh mesh;
  double volume_m3;
  std::size_t caps;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const bool quadratic : {true, false}) {
    all.push_back({quadratic ? "closed, quadratic" : "closed, linear", hollow_cube(1.0, quadratic), 1e-6, 0});
    all.push_back({quadratic ? "open, quadratic" : "open, linear", open_box(quadratic), 1.5e-6, 1});
  }
  return all;
}

TEST(EnclosedVolume, IsThatOfTheHollowAndItsCaps) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const EnclosedVolume volume(c.mesh, named_faces(c.mesh));
    EXPECT_EQ(volume.cap_centres().size(), c.caps);
    EXPECT_NEAR(volume.value_m3(c.mesh.nodes_m), c.volume_m3, 1e-15);
  }
}

TEST(EnclosedVolume, StaysExactOnCurvedFaces) {
  const TetMesh mesh = hollow_cube();
  const EnclosedVolume volume(mesh, named_faces(mesh));
  const EnclosedVolume skin(mesh, named_faces(mesh, -1));
  TetMesh bent = mesh;
  bent.nodes_m = disturbed(mesh, 0.0008);
  // The skin of the body turns outwards, so its volume is negative; what it encloses is body and hollow.
  EXPECT_NEAR(-skin.value_m3(bent.nodes_m) - volume.value_m3(bent.nodes_m), soft_robot_lab::volume(bent), 1e-16);
}

TEST(EnclosedVolume, DoesNotDependOnWhereTheBodyIs) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const EnclosedVolume volume(c.mesh, named_faces(c.mesh));
    const Eigen::Matrix3Xd bent = disturbed(c.mesh, 0.001);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    Eigen::Matrix3Xd moved = turn * bent;
    moved.colwise() += Eigen::Vector3d(0.5, -0.3, 0.2);
    EXPECT_NEAR(volume.value_m3(moved), volume.value_m3(bent), 1e-9 * c.volume_m3);
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, bent.cols());
    volume.add_gradient(moved, 1.0, gradient);
    EXPECT_LT(gradient.rowwise().sum().norm(), 1e-9 * gradient.norm());
  }
}

TEST(EnclosedVolume, GradientAgreesWithCentralDifferences) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const EnclosedVolume volume(c.mesh, named_faces(c.mesh));
    const Eigen::Matrix3Xd bent = disturbed(c.mesh, 0.001);
    Eigen::Matrix3Xd exact = Eigen::Matrix3Xd::Zero(3, bent.cols());
    volume.add_gradient(bent, 1.0, exact);
    const double h = 1e-5;  // the volume is cubic, so only its third derivative is seen
    for (Eigen::Index i = 0; i < bent.size(); ++i) {
      Eigen::Matrix3Xd plus = bent, minus = bent;
      plus.data()[i] += h;
      minus.data()[i] -= h;
      EXPECT_NEAR(exact.data()[i], (volume.value_m3(plus) - volume.value_m3(minus)) / (2 * h), 1e-7 * exact.norm());
    }
  }
}

// The volume of a chamber that nothing drives.
struct NoSupply : ChamberVolume::Supply {
  GasSupply supply(const DriveState& /*drive*/) const override { return {}; }
  std::optional<Eigen::Matrix3Xd> load_positions_m(const DriveState& /*drive*/) const override { return std::nullopt; }
};

TEST(EnclosedVolume, HessianAgreesWithCentralDifferences) {
  const NoSupply supply;
  const DriveState drive;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const ChamberVolume volume(EnclosedVolume(c.mesh, named_faces(c.mesh)), supply);
    const Eigen::Matrix3Xd bent = disturbed(c.mesh, 0.001);
    DenseSink exact(volume, bent.cols());
    volume.add_hessian(bent, drive, 2.0, exact);
    for (int direction = 0; direction < 5; ++direction) {
      const Eigen::Matrix3Xd along = Eigen::Matrix3Xd::Random(3, bent.cols());
      const double h = 1e-5;
      Eigen::Matrix3Xd change = Eigen::Matrix3Xd::Zero(3, bent.cols());
      volume.add_gradient(bent + h * along, drive, 2.0 / (2 * h), change);
      volume.add_gradient(bent - h * along, drive, -2.0 / (2 * h), change);
      const Eigen::Map<const Eigen::VectorXd> found(change.data(), change.size()), step(along.data(), along.size());
      EXPECT_LT((exact.hessian * step - found).norm(), 1e-8 * found.norm());
    }
  }
}

// What a cap adds does not depend on the size of the faces along the loop where the loop is plane.
TEST(EnclosedVolume, CapsATubeAtBothEnds) {
  const std::vector<double> across = mirrored({0.005, 0.010});
  const TetMesh tube =
      hollow_mesh({{across, across, {0.0, 0.002, 0.01, 0.03}}, {-0.005, -0.005, -1.0}, {0.005, 0.005, 1.0}, true, {}});
  const EnclosedVolume volume(tube, named_faces(tube));
  EXPECT_EQ(volume.cap_centres().size(), 2u);
  EXPECT_NEAR(volume.value_m3(tube.nodes_m), 0.01 * 0.01 * 0.03, 1e-15);
}

TEST(EnclosedVolume, RefusesAnEdgeThatCannotBeCapped) {
  const TetMesh mesh = hollow_cube();
  const auto refusal = [&](const std::vector<int>& faces) -> std::string {
    try {
      EnclosedVolume volume(mesh, faces);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  std::vector<int> thrice = named_faces(mesh);
  thrice.insert(thrice.end(), 2, thrice.front());
  EXPECT_NE(refusal(thrice).find("cannot be capped: faces turn against each other at ("), std::string::npos)
      << refusal(thrice);
  // Two triangles that share but one corner.
  const std::vector<int> all = named_faces(mesh);
  for (const int other : all) {
    int shared = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) shared += mesh.faces(i, all[0]) == mesh.faces(j, other) ? 1 : 0;
    if (shared != 1) continue;
    EXPECT_NE(refusal({all[0], other}).find("cannot be capped: two loops of its edge touch at ("), std::string::npos);
    return;
  }
  FAIL() << "no such triangles";
}

}  // namespace
}  // namespace soft_robot_lab
