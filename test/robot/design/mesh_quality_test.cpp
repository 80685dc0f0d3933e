// SPDX-License-Identifier: BSD-3-Clause
#include "robot/design/mesh_quality.h"

#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

Eigen::Matrix3Xd regular() {
  Eigen::Matrix3Xd nodes(3, 4);
  nodes << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  return nodes;
}

const Eigen::MatrixXi kOne = Eigen::Vector4i(0, 1, 2, 3);

TEST(MeasureQuality, IsOneForARegularElementOfAnySizeAndPlace) {
  EXPECT_NEAR(measure_quality(regular(), kOne).min, 1, 1e-14);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  const Eigen::Matrix3Xd moved = (turn * regular() * 0.001).colwise() + Eigen::Vector3d(1, 0, 2);
  EXPECT_NEAR(measure_quality(moved, kOne).min, 1, 1e-10);
}

TEST(MeasureQuality, KnowsTheCornerOfACube) {
  Eigen::Matrix3Xd nodes(3, 4);
  nodes << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  // r = 1 / (3 + sqrt 3), R = sqrt(3) / 2.
  EXPECT_NEAR(measure_quality(nodes, kOne).min, 3 / (3 + std::sqrt(3.0)) / (std::sqrt(3.0) / 2), 1e-14);
}

TEST(VolumeLengthQualities, AreThoseOfRegularCubeCornerFlatAndInvertedElements) {
  Eigen::Matrix3Xd corner(3, 4);
  corner << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_NEAR(volume_length_qualities(0.01 * regular(), kOne).at(0), 1, 1e-14);
  // Volume 1/6, three edges of 1 and three of sqrt 2: rms edge sqrt(3/2).
  EXPECT_NEAR(volume_length_qualities(corner, kOne).at(0), std::sqrt(2.0) / std::pow(1.5, 1.5), 1e-14);
  EXPECT_NEAR(volume_length_qualities(regular(), Eigen::Vector4i(1, 0, 2, 3)).at(0), -1, 1e-14);
  EXPECT_EQ(volume_length_qualities(Eigen::Matrix3Xd::Zero(3, 4), kOne).at(0), 0.0);
}

TEST(MeasureQuality, IsZeroWhenFlatAndNegativeWhenInverted) {
  Eigen::Matrix3Xd flat = regular();
  flat.row(2).setZero();
  EXPECT_EQ(measure_quality(flat, kOne).min, 0.0);
  EXPECT_NEAR(measure_quality(regular(), Eigen::Vector4i(1, 0, 2, 3)).min, -1, 1e-14);
  EXPECT_EQ(measure_quality(Eigen::Matrix3Xd::Zero(3, 4), kOne).min, 0.0);
}

TEST(MeasureQuality, GivesTheWorstAndTheMean) {
  Eigen::MatrixXi tets(4, 2);
  tets << 0, 1, 1, 0, 2, 2, 3, 3;
  const MeshQuality quality = measure_quality(regular(), tets);
  EXPECT_NEAR(quality.min, -1, 1e-14);
  EXPECT_NEAR(quality.mean, 0, 1e-14);
  EXPECT_THROW(measure_quality(regular(), Eigen::MatrixXi(4, 0)), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
