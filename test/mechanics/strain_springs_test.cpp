// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/elements/strain_springs.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

#include "box_mesh.h"
#include "mechanics/elements/elements.h"

namespace soft_robot_lab {
namespace {

Eigen::Matrix3Xd disturbed(const Eigen::Matrix3Xd& positions, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-size, size);
  Eigen::Matrix3Xd result = positions;
  for (Eigen::Index i = 0; i < result.size(); ++i) result.data()[i] += offset(random);
  return result;
}

class StrainSpringsTest : public ::testing::TestWithParam<bool> {
 protected:
  StrainSpringsTest()
      : body_(box_mesh({0, 0, 0}, {0.02, 0.01, 0.015}, {1, 1, 1}, GetParam()), {1.0e5, 0.45, 1000.0}),
        matrix_(body_.mesh().node_count(), stiffness_cliques(body_)),
        elements_(body_, matrix_),
        springs_(elements_.batches(), elements_.slots()),
        positions_(disturbed(body_.mesh().nodes_m, 0.0015, 7)),
        pull_{2.0e4, springs_.strains(disturbed(body_.mesh().nodes_m, 0.0015, 8))} {}

  double energy(const Eigen::Matrix3Xd& positions) const {
    Eigen::Matrix3Xd unused = Eigen::Matrix3Xd::Zero(3, positions.cols());
    return springs_.add_gradient(positions, pull_, unused);
  }
  Eigen::Matrix3Xd gradient(const Eigen::Matrix3Xd& positions, const StrainTarget& pull) const {
    Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, positions.cols());
    springs_.add_gradient(positions, pull, result);
    return result;
  }
  Eigen::MatrixXd hessian(bool convex) {
    matrix_.set_zero();
    springs_.add_hessian(positions_, pull_, convex, matrix_);
    Eigen::MatrixXd dense(positions_.size(), positions_.size());
    for (Eigen::Index i = 0; i < positions_.size(); ++i) {
      Eigen::Matrix3Xd unit = Eigen::Matrix3Xd::Zero(3, positions_.cols());
      unit.data()[i] = 1.0;
      const Eigen::Matrix3Xd column = matrix_.multiply(unit);
      dense.col(i) = Eigen::Map<const Eigen::VectorXd>(column.data(), column.size());
    }
    return dense;
  }

  Body body_;
  BlockMatrix matrix_;
  Elements elements_;
  StrainSprings springs_;
  Eigen::Matrix3Xd positions_;
  StrainTarget pull_;
};

TEST_P(StrainSpringsTest, GradientAndHessianAgreeWithCentralDifferences) {
  const Eigen::Matrix3Xd exact = gradient(positions_, pull_);
  const Eigen::MatrixXd second = hessian(false);
  const double h = 1e-7;
  for (Eigen::Index i = 0; i < positions_.size(); ++i) {
    Eigen::Matrix3Xd plus = positions_, minus = positions_;
    plus.data()[i] += h;
    minus.data()[i] -= h;
    EXPECT_NEAR(exact.data()[i], (energy(plus) - energy(minus)) / (2.0 * h), 1e-6 * exact.norm());
    const Eigen::Matrix3Xd change = (gradient(plus, pull_) - gradient(minus, pull_)) / (2.0 * h);
    const Eigen::Map<const Eigen::VectorXd> column(change.data(), change.size());
    EXPECT_LT((second.col(i) - column).norm(), 1e-6 * column.norm());
  }
}

TEST_P(StrainSpringsTest, ConvexHessianIsPositiveWhereTheExactOneIsNot) {
  EXPECT_LT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian(false)).eigenvalues()[0], -1.0);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(hessian(true)).eigenvalues()[0], -1e-6);
}

// Viscosity between any shape and the same one turned is nothing, and it turns and moves nothing either.
TEST_P(StrainSpringsTest, RigidMotionFeelsNothing) {
  const StrainTarget here{2.0e4, springs_.strains(positions_)};
  const Eigen::Affine3d motion =
      Eigen::Translation3d(0.3, -0.2, 0.1) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, 3).normalized());
  EXPECT_LT(gradient(motion * positions_, here).norm(), 1e-12 * gradient(positions_, pull_).norm());
  const Eigen::Matrix3Xd forces = gradient(positions_, pull_);
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < forces.cols(); ++i) moment += positions_.col(i).cross(forces.col(i));
  EXPECT_LT(forces.rowwise().sum().norm(), 1e-12 * forces.norm());
  EXPECT_LT(moment.norm(), 1e-12 * forces.norm());
}

INSTANTIATE_TEST_SUITE_P(Orders, StrainSpringsTest, ::testing::Values(true, false),
                         [](const auto& order) { return order.param ? "Quadratic" : "Linear"; });

}  // namespace
}  // namespace soft_robot_lab
