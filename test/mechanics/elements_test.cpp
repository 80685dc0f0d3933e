// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/elements/elements.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

#include "mechanics/linear_algebra/block_cholesky.h"
#include "box_mesh.h"

namespace soft_robot_lab {
namespace {

Eigen::MatrixXd dense(const BlockMatrix& matrix) {
  const Eigen::Index size = 3 * matrix.node_count();
  Eigen::MatrixXd result(size, size);
  for (Eigen::Index column = 0; column < size; ++column) {
    Eigen::Matrix3Xd unit = Eigen::Matrix3Xd::Zero(3, matrix.node_count());
    unit.data()[column] = 1.0;
    const Eigen::Matrix3Xd image = matrix.multiply(unit);
    result.col(column) = Eigen::Map<const Eigen::VectorXd>(image.data(), size);
  }
  return result;
}

Eigen::Matrix3Xd disturbed(const Eigen::Matrix3Xd& positions, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> offset(-size, size);
  Eigen::Matrix3Xd result = positions;
  for (Eigen::Index i = 0; i < result.size(); ++i) result.data()[i] += offset(random);
  return result;
}

struct Silicone {
  const char* name;
  bool quadratic;
  Material material;
  LinearVolume linear_volume = LinearVolume::element;
};

// All with E = 1e5 Pa, nu = 0.45 and so mu = 34483 Pa; c1 = 17241 Pa of yeoh.
const Material kNeoHookean{1.0e5, 0.45, 1000.0};
const Material kMooneyRivlin{1.0e5, 0.45, 1000.0, MaterialModel::mooney_rivlin, 7.0e3};
const Material kYeoh{1.0e5, 0.45, 1000.0, MaterialModel::yeoh, 0.0, -4.0e3, 2.0e3};

// Six elements (so that the last batch of four is not full) of a small, strongly disturbed block.
class ElementsTest : public ::testing::TestWithParam<Silicone> {
 protected:
  ElementsTest()
      : body_(make_body(GetParam())),
        matrix_(body_.mesh().node_count(), stiffness_cliques(body_)),
        elements_(body_, matrix_),
        positions_(disturbed(body_.mesh().nodes_m, 0.0015, 7)),
        multipliers_(Eigen::VectorXd::LinSpaced(elements_.multiplier_count(), -4.0e4, 3.0e4)) {}

  static Body make_body(const Silicone& silicone) {
    Body body(box_mesh({0, 0, 0}, {0.02, 0.01, 0.015}, {1, 1, 1}, silicone.quadratic), silicone.material);
    body.set_linear_volume(silicone.linear_volume);
    return body;
  }

  // Elastic energy plus p (V0 Jbar - V0): what add_gradient differentiates.
  double energy(const Eigen::Matrix3Xd& positions) const {
    Eigen::Matrix3Xd unused = Eigen::Matrix3Xd::Zero(3, positions.cols());
    const ElementSums sums = elements_.add_gradient(positions, multipliers_, unused);
    return sums.elastic_energy + multipliers_.cwiseProduct(sums.volumetric_strain).dot(elements_.rest_volumes_m3());
  }

  Eigen::Matrix3Xd gradient(const Eigen::Matrix3Xd& positions, const Eigen::VectorXd& multipliers) const {
    Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, positions.cols());
    elements_.add_gradient(positions, multipliers, result);
    return result;
  }

  Body body_;
  BlockMatrix matrix_;
  Elements elements_;
  Eigen::Matrix3Xd positions_;
  Eigen::VectorXd multipliers_;
};

TEST_P(ElementsTest, GradientAgreesWithCentralDifferences) {
  const Eigen::Matrix3Xd exact = gradient(positions_, multipliers_);
  const double h = 1e-7;
  for (Eigen::Index i = 0; i < positions_.size(); ++i) {
    Eigen::Matrix3Xd plus = positions_, minus = positions_;
    plus.data()[i] += h;
    minus.data()[i] -= h;
    EXPECT_NEAR(exact.data()[i], (energy(plus) - energy(minus)) / (2.0 * h), 1e-6 * exact.norm());
  }
}

TEST_P(ElementsTest, CondensedHessianAgreesWithCentralDifferences) {
  elements_.add_hessian(positions_, multipliers_, false, matrix_);
  const Eigen::MatrixXd exact = dense(matrix_);

  // lambda / V0 g g' of every element, with g = d(V0 Jbar)/dx from the multipliers' own gradient.
  const Eigen::Matrix3Xd base = gradient(positions_, Eigen::VectorXd::Zero(elements_.multiplier_count()));
  Eigen::MatrixXd volumetric = Eigen::MatrixXd::Zero(exact.rows(), exact.cols());
  for (int e = 0; e < elements_.multiplier_count(); ++e) {
    const Eigen::Matrix3Xd g = gradient(positions_, Eigen::VectorXd::Unit(elements_.multiplier_count(), e)) - base;
    const Eigen::Map<const Eigen::VectorXd> column(g.data(), g.size());
    volumetric += elements_.lambda_pa()[e] / elements_.rest_volumes_m3()[e] * column * column.transpose();
  }

  const double h = 1e-7;
  for (Eigen::Index i = 0; i < positions_.size(); ++i) {
    Eigen::Matrix3Xd plus = positions_, minus = positions_;
    plus.data()[i] += h;
    minus.data()[i] -= h;
    const Eigen::Matrix3Xd change = (gradient(plus, multipliers_) - gradient(minus, multipliers_)) / (2.0 * h);
    const Eigen::VectorXd column = Eigen::Map<const Eigen::VectorXd>(change.data(), change.size()) + volumetric.col(i);
    EXPECT_LT((exact.col(i) - column).norm(), 1e-6 * exact.col(i).norm()) << "column " << i;
  }
}

TEST_P(ElementsTest, MismatchForcesPutTheVolumesPressureInThePlaceOfTheMultipliers) {
  elements_.add_hessian(positions_, multipliers_, false, matrix_);
  Eigen::Matrix3Xd condensed = Eigen::Matrix3Xd::Zero(3, positions_.cols());
  const ElementSums sums = elements_.add_gradient(positions_, multipliers_, condensed);
  elements_.add_mismatch_forces(elements_.mismatch(sums.volumetric_strain, multipliers_), condensed);
  const Eigen::Matrix3Xd expected = gradient(positions_, elements_.lambda_pa().cwiseProduct(sums.volumetric_strain));
  EXPECT_LT((condensed - expected).norm(), 1e-10 * expected.norm());
}

TEST_P(ElementsTest, ConvexHessianIsPositiveWhereTheExactOneIsNot) {
  const Eigen::Matrix3Xd crushed = disturbed(body_.mesh().nodes_m, 0.006, 3);
  const double lowest[2] = {[&] {
                              matrix_.set_zero();
                              elements_.add_hessian(crushed, multipliers_, false, matrix_);
                              return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(matrix_)).eigenvalues()[0];
                            }(),
                            [&] {
                              matrix_.set_zero();
                              elements_.add_hessian(crushed, multipliers_, true, matrix_);
                              return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(matrix_)).eigenvalues()[0];
                            }()};
  EXPECT_LT(lowest[0], -1.0);
  EXPECT_GT(lowest[1], -1e-6);
}

TEST_P(ElementsTest, RigidMotionCostsNothing) {
  const Eigen::Affine3d motion =
      Eigen::Translation3d(0.3, -0.2, 0.1) * Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, 3).normalized());
  const Eigen::Matrix3Xd moved = motion * body_.mesh().nodes_m;
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, moved.cols());
  const ElementSums sums = elements_.add_gradient(moved, Eigen::VectorXd::Zero(elements_.multiplier_count()), forces);
  EXPECT_NEAR(sums.elastic_energy, 0.0, 1e-14);
  EXPECT_LT(forces.norm(), 1e-10);
  EXPECT_LT(sums.volumetric_strain.norm(), 1e-12);
}

TEST_P(ElementsTest, ForcesSumToZeroAndTurnNothing) {
  const Eigen::Matrix3Xd forces = gradient(positions_, multipliers_);
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < forces.cols(); ++i) moment += positions_.col(i).cross(forces.col(i));
  EXPECT_LT(forces.rowwise().sum().norm(), 1e-12 * forces.norm());
  EXPECT_LT(moment.norm(), 1e-12 * forces.norm());
}

TEST_P(ElementsTest, SmallStrainsFollowHooke) {
  // Uniaxial stretch by a small strain with the lateral contraction of the material: stress E * strain, none across.
  const double strain = 1e-5;
  const Eigen::DiagonalMatrix<double, 3> f(1.0 + strain, 1.0 - 0.45 * strain, 1.0 - 0.45 * strain);
  const Eigen::Matrix3Xd stretched = f * body_.mesh().nodes_m;
  const Eigen::VectorXd pressures = elements_.lambda_pa() * (f.diagonal().prod() - 1.0);
  const Eigen::Matrix3Xd forces = gradient(stretched, pressures);
  double pull = 0.0, across = 0.0;
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    if (body_.mesh().nodes_m(0, i) > 0.02 - 1e-9) pull += forces(0, i);
    if (body_.mesh().nodes_m(1, i) > 0.01 - 1e-9) across += forces(1, i);
  }
  EXPECT_NEAR(pull, 1.0e5 * strain * 0.01 * 0.015, 1e-4 * 1.0e5 * strain * 0.01 * 0.015);
  EXPECT_NEAR(across, 0.0, 1e-4 * 1.0e5 * strain * 0.02 * 0.015);
}

TEST_P(ElementsTest, InvertedAndCollapsedElementsHaveAFiniteEnergyAndForce) {
  for (const double scale : {-1.0, 0.0, -0.3}) {
    Eigen::Matrix3Xd squashed = body_.mesh().nodes_m;
    squashed.row(1) *= scale;
    const Eigen::Matrix3Xd forces = gradient(squashed, multipliers_);
    EXPECT_TRUE(forces.allFinite());
    EXPECT_TRUE(std::isfinite(energy(squashed)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Silicones, ElementsTest,
    ::testing::Values(Silicone{"NeoHookeanQuadratic", true, kNeoHookean},
                      Silicone{"NeoHookeanLinear", false, kNeoHookean},
                      Silicone{"VertexAveragedLinear", false, kNeoHookean, LinearVolume::vertex_averaged},
                      Silicone{"MooneyRivlinQuadratic", true, kMooneyRivlin},
                      Silicone{"MooneyRivlinLinear", false, kMooneyRivlin}, Silicone{"YeohQuadratic", true, kYeoh},
                      Silicone{"YeohLinear", false, kYeoh}),
    [](const auto& silicone) { return silicone.param.name; });

TEST(BlockCholesky, SolvesWhatADenseFactorSolves) {
  const TetMesh mesh = box_mesh({0, 0, 0}, {0.05, 0.02, 0.02}, {4, 2, 2});
  const Body body(mesh, {1.0e5, 0.4, 1000.0});
  BlockMatrix matrix(body.mesh().node_count(), stiffness_cliques(body));
  Elements elements(body, matrix);
  elements.add_hessian(body.mesh().nodes_m, Eigen::VectorXd::Zero(elements.count()), false, matrix);
  FixedAxes fixed = FixedAxes::Constant(3, body.mesh().node_count(), false);
  for (int node = 0; node < body.mesh().node_count(); ++node)
    if (body.mesh().nodes_m(0, node) < 1e-9) fixed.col(node).setConstant(true);
  matrix.hold(fixed);
  BlockCholesky factor(matrix);
  ASSERT_TRUE(factor.factorise(matrix));
  const Eigen::MatrixXd full = dense(matrix);
  const Eigen::MatrixXd right = disturbed(Eigen::Matrix3Xd::Zero(3, full.rows()), 1.0, 5).transpose();
  Eigen::MatrixXd solved = right;
  factor.solve(solved);
  EXPECT_LT((full * solved - right).norm(), 1e-9 * right.norm());
  EXPECT_LT((full - full.transpose()).norm(), 1e-12 * full.norm());
}

TEST(BlockCholesky, SolvesAndCountsWhatIsIndefinite) {
  const TetMesh mesh = box_mesh({0, 0, 0}, {0.05, 0.02, 0.02}, {4, 2, 2});
  const Body body(mesh, {1.0e5, 0.4, 1000.0});
  BlockMatrix matrix(mesh.node_count(), stiffness_cliques(body));
  Elements elements(body, matrix);
  elements.add_hessian(disturbed(mesh.nodes_m, 0.003, 11), Eigen::VectorXd::Zero(elements.count()), false, matrix);
  for (int node = 0; node < mesh.node_count(); ++node) matrix.add_to_diagonal(node, 3.0);
  const Eigen::MatrixXd full = dense(matrix);
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(full).eigenvalues();
  BlockCholesky factor(matrix);
  ASSERT_TRUE(factor.factorise(matrix));
  EXPECT_GT(factor.negative_pivots(), 0);
  EXPECT_EQ(factor.negative_pivots(), (eigenvalues.array() < 0.0).count());
  const Eigen::MatrixXd right = disturbed(Eigen::Matrix3Xd::Zero(3, full.rows()), 1.0, 5).transpose();
  Eigen::MatrixXd solved = right;
  factor.solve(solved);
  EXPECT_LT((full * solved - right).norm(), 1e-6 * right.norm());
}

// Nodes coupled at random, as those of no mesh are: the matrix is small, its factor all but full.
TEST(BlockCholesky, RefusesAFactorBeyondItsMemoryBeforeItIsTaken) {
  constexpr int nodes = 40000;
  std::mt19937 random(1);
  std::vector<std::vector<int>> cliques;
  for (int i = 0; i < nodes; ++i)
    cliques.push_back({i, static_cast<int>(random() % nodes), static_cast<int>(random() % nodes)});
  const BlockMatrix matrix(nodes, cliques);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  try {
    BlockCholesky factor(matrix);
    ADD_FAILURE() << "took " << factor.factor_size() << " numbers";
  } catch (const std::invalid_argument& error) {
    for (const char* words : {"GB to factorise, at most 6 are taken", "body.element_size_m", "body.element: linear"})
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 1500000) << "kB";
}

TEST(BlockCholesky, RefusesWhatIsSingularOrNotANumber) {
  BlockMatrix matrix(3, {{0, 1}, {1, 2}});
  BlockCholesky factor(matrix);
  EXPECT_FALSE(factor.factorise(matrix));
  for (int node = 0; node < 3; ++node) matrix.add_to_diagonal(node, std::nan(""));
  EXPECT_FALSE(factor.factorise(matrix));
}

}  // namespace
}  // namespace soft_robot_lab
