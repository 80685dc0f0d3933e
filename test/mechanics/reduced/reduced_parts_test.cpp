// SPDX-License-Identifier: BSD-3-Clause
// The parts of a reduced model on modes at random, without any training.
#include <gtest/gtest.h>

#include <random>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/actuators/hollow_mesh.h"
#include "mechanics/actuators/test_bar.h"
#include "mechanics/elements/elements.h"
#include "mechanics/reduced/pod.h"
#include "mechanics/reduced/point_cubature.h"
#include "mechanics/reduced/reduced_constraints.h"
#include "mechanics/reduced/reduced_energy.h"

namespace soft_robot_lab {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix.data()[i] = generator() / 2147483648.0 - 1.0;
  return matrix;
}

// A box of a region for each material.
TetMesh layers(std::size_t materials) {
  TetMesh mesh = box_mesh({0, 0, 0}, {0.04, 0.02, 0.02}, {2, 1, 1});
  mesh.regions.assign(materials, {});
  for (int e = 0; e < mesh.tet_count(); ++e) mesh.tet_region.push_back(e % static_cast<int>(materials));
  return mesh;
}

const Material kMooney = Material::mooney_rivlin(30e3, 14e3, 0.47, 1070.0);
const Material kYeoh = Material::yeoh(10410.0, 2670.0, 900.0, 0.4999, 1070.0);

// A short bar of these materials, and smooth modes: polynomials of the rest position times random vectors.
struct ReducedParts : ::testing::TestWithParam<std::vector<Material>> {
  ReducedParts() : body(layers(GetParam().size()), GetParam()) {
    body.set_gravity({0, 0, -9.81});
    basis.pressures = random_matrix(body.mesh().tet_count(), 2, 1);
    basis.modes.resize(3 * body.mesh().node_count(), 4);
    const Eigen::MatrixXd factors = random_matrix(9, 4, 2);
    for (Eigen::Index k = 0; k < 4; ++k)
      for (Eigen::Index i = 0; i < body.mesh().node_count(); ++i) {
        const Eigen::Vector3d x = body.mesh().nodes_m.col(i) / 0.04;
        const Eigen::Matrix3d a = Eigen::Map<const Eigen::Matrix3d>(factors.col(k).data());
        basis.modes.col(k).segment<3>(3 * i) = 0.01 * (a * x + x.x() * x.y() * a.col(0));
      }
  }

  Body body;
  ReducedBasis basis;
  const Eigen::VectorXd q = Eigen::Vector4d(0.3, -0.4, 0.2, 0.5);
  const Eigen::VectorXd r = Eigen::Vector2d(900.0, -2000.0);
};

INSTANTIATE_TEST_SUITE_P(Materials, ReducedParts,
                         ::testing::Values(std::vector<Material>{Material{}}, std::vector<Material>{kMooney},
                                           std::vector<Material>{kYeoh},
                                           std::vector<Material>{Material{}, kMooney, kYeoh}));

// The full model's elements are the judge of energy and forces.
TEST_P(ReducedParts, ForcesAreThoseOfTheElements) {
  const ReducedEnergy::Sums at = ReducedEnergy(body, basis).sums(q, r);
  const Eigen::VectorXd moved = basis.modes * q;
  const Eigen::Matrix3Xd positions_m = body.mesh().nodes_m + moved.reshaped(3, moved.size() / 3);
  const Elements elements(body, BlockMatrix(body.mesh().node_count(), stiffness_cliques(body)));
  Eigen::Matrix3Xd forces_n = -body.external_forces_n();
  const ElementSums sums = elements.add_gradient(positions_m, basis.pressures * r, forces_n);
  const Eigen::VectorXd expected = basis.modes.transpose() * forces_n.reshaped();
  EXPECT_LT((at.force - expected).norm(), 1e-10 * expected.norm());
  const Eigen::VectorXd p_pa = basis.pressures * r, v_m3 = elements.rest_volumes_m3();
  const Eigen::VectorXd mismatch = sums.volumetric_strain - p_pa.cwiseQuotient(elements.lambda_pa());
  EXPECT_LT((at.mismatch - basis.pressures.transpose() * v_m3.cwiseProduct(mismatch)).norm(),
            1e-9 * at.mismatch.norm());
  const double volumetric_j =
      v_m3.dot(p_pa.cwiseProduct(sums.volumetric_strain - 0.5 * p_pa.cwiseQuotient(elements.lambda_pa())));
  const double loads_j = body.external_forces_n().cwiseProduct(positions_m - body.mesh().nodes_m).sum();
  EXPECT_NEAR(at.value, sums.elastic_energy + volumetric_j - loads_j, 1e-10 * std::abs(sums.elastic_energy));
}

TEST_P(ReducedParts, PolynomialsAreTheVolumesOfTheShape) {
  const std::vector<RestPoint> points = rest_points(body.mesh(), basis.modes);
  Eigen::Vector2d sums = Eigen::Vector2d::Zero();
  for (const RestPoint& point : points) {
    const double growth = (Eigen::Matrix3d::Identity() + point.displacement_gradient(q)).determinant() - 1.0;
    sums += point.weight_m3 * growth * basis.pressures.row(point.element).transpose();
  }
  const Eigen::VectorXd values = VolumePolynomials(points, basis.pressures).at(q, Eigen::Vector2d::Zero()).values;
  EXPECT_LT((values - sums).norm(), 1e-12 * sums.norm());
  EXPECT_GT(std::abs(sums[1]), 1e-8);
}

TEST_P(ReducedParts, ForcesAreTheSlopeOfTheEnergy) {
  const ReducedEnergy energy(body, basis);
  const ReducedEnergy::Sums at = energy.sums(q, r);
  const double d = 1e-5;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::VectorXd step = d * Eigen::VectorXd::Unit(4, i);
    const double slope = (energy.sums(q + step, r).value - energy.sums(q - step, r).value) / (2.0 * d);
    EXPECT_NEAR(at.force[i], slope, 1e-7 * at.force.norm());
  }
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Eigen::VectorXd step = Eigen::VectorXd::Unit(2, k);
    const double slope = (energy.sums(q, r + step).value - energy.sums(q, r - step).value) / 2.0;
    EXPECT_NEAR(at.mismatch[k], slope, 1e-7 * at.mismatch.norm());
  }
}

TEST_P(ReducedParts, VolumeGradientsAreTheSlopeOfTheForcesByThePressures) {
  const ReducedEnergy energy(body, basis);
  const Eigen::MatrixXd gradients = energy.volume_gradients(q);
  const Eigen::VectorXd force = energy.sums(q, r).force;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Eigen::VectorXd change = energy.sums(q, r + 1e4 * Eigen::VectorXd::Unit(2, k)).force - force;
    EXPECT_LT((1e4 * gradients.col(k) - change).norm(), 1e-9 * force.norm());
  }
}

TEST_P(ReducedParts, TheHessianIsTheSlopeOfTheForces) {
  ReducedEnergy energy(body, basis);
  energy.hyper_reduce(random_matrix(static_cast<Eigen::Index>(energy.points().size()), 1, 3), body);
  const Eigen::MatrixXd hessian = energy.hessian(q, r);
  const double d = 1e-5;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::VectorXd step = d * Eigen::VectorXd::Unit(4, i);
    const Eigen::VectorXd slope = (energy.sums(q + step, r).force - energy.sums(q - step, r).force) / (2.0 * d);
    EXPECT_LT((hessian.col(i) - slope).norm(), 1e-7 * hessian.norm());
  }
}

TEST_P(ReducedParts, PointForcesAndPolynomialsAddUpToTheForce) {
  ReducedEnergy all(body, basis), none(body, basis);
  none.hyper_reduce(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(none.points().size())), body);
  const Eigen::VectorXd points = all.point_forces(q).rowwise().sum();
  const Eigen::VectorXd force = all.sums(q, r).force;
  EXPECT_LT((none.sums(q, r).force + points - force).norm(), 1e-12 * force.norm());
}

// Of one constraint, against differences of its gradient.
void expect_hessian_of_slopes(const ReducedConstraints& constraints, const Eigen::VectorXd& q,
                              const Eigen::VectorXd& multiplier, const DriveStates& drives, double tolerance) {
  const Eigen::MatrixXd hessian = constraints.hessian(q, constraints.at(q, multiplier, drives), multiplier);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Eigen::VectorXd step = 1e-7 * Eigen::VectorXd::Unit(q.size(), i);
    const Eigen::MatrixXd change = (constraints.at(q + step, multiplier, drives).gradients -
                                    constraints.at(q - step, multiplier, drives).gradients) /
                                   2e-7;
    EXPECT_LT((hessian.col(i) - multiplier[0] * change.col(0)).norm(), tolerance * hessian.norm());
  }
}

TEST(ReducedConstraints, LengthsAndSlopesAreThoseOfTheFullModel) {
  const Simulation bar = hanging_bar("compliance_m_n: 1e-4");
  const Eigen::MatrixXd modes = random_matrix(3 * bar.body().mesh().node_count(), 3, 4);
  const ReducedConstraints cables(*bar.model(), modes);
  const Eigen::VectorXd q = Eigen::Vector3d(1e-3, -2e-3, 1.5e-3), tension = Eigen::VectorXd::Constant(1, 0.7);
  const DriveStates drives = bar.state().drives;
  const ReducedConstraints::Values values = cables.at(q, tension, drives);
  const Eigen::VectorXd moved = modes * q;
  const Eigen::Matrix3Xd positions =
      bar.body().mesh().nodes_m + Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, moved.size() / 3);
  const Constraint& length = *bar.actuators()[0]->constraints()[0];
  Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, positions.cols());
  length.add_gradient(positions, drives[0], 1.0, gradient);
  EXPECT_NEAR(values.laws[0].offset, length.law(length.value(positions, drives[0]), 0.7, drives[0]).offset, 1e-12);
  const Eigen::VectorXd expected = modes.transpose() * Eigen::Map<const Eigen::VectorXd>(gradient.data(), moved.size());
  EXPECT_LT((values.gradients.col(0) - expected).norm(), 1e-12 * expected.norm());
  expect_hessian_of_slopes(cables, q, tension, drives, 1e-5);
}

// A box with a hollow that is open at the top, which a cap closes.
TEST(ReducedConstraints, VolumesAndSlopesAreThoseOfTheFullModel) {
  Body body(open_box(), Material{});
  auto chamber = std::make_unique<Chamber>();
  chamber->initialise(YamlNode::parse("{name: air, surface: cavity, command: beta}", "test"), body,
                      MeshLocator(body.mesh()));
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::move(chamber));
  body.fix_nodes(Eigen::Vector3d::Constant(-1.0), {1.0, 1.0, -0.0099}, {true, true, true});
  const Model model(std::move(body), std::move(actuators), {}, {});
  const Eigen::MatrixXd modes = random_matrix(3 * model.body().mesh().node_count(), 3, 4);
  const ReducedConstraints chambers(model, modes);
  const Eigen::VectorXd q = Eigen::Vector3d(1e-4, -2e-4, 1.5e-4), pressure = Eigen::VectorXd::Constant(1, -900.0);
  DriveStates drives{model.actuators()[0]->rest_state()};
  model.actuators()[0]->set_command(1.2, drives[0]);
  const ReducedConstraints::Values values = chambers.at(q, pressure, drives);
  const Eigen::VectorXd moved = modes * q;
  const Eigen::Matrix3Xd positions =
      model.body().mesh().nodes_m + Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, moved.size() / 3);
  const Constraint& volume = *model.actuators()[0]->constraints()[0];
  const double volume_m3 = volume.value(positions, drives[0]);
  EXPECT_NEAR(values.laws[0].offset, volume.law(volume_m3, -900.0, drives[0]).offset, 1e-12 * volume_m3);
  Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, positions.cols());
  volume.add_gradient(positions, drives[0], 1.0, gradient);
  const Eigen::VectorXd expected = modes.transpose() * Eigen::Map<const Eigen::VectorXd>(gradient.data(), moved.size());
  EXPECT_LT((values.gradients.col(0) - expected).norm(), 1e-11 * expected.norm());
  expect_hessian_of_slopes(chambers, q, pressure, drives, 1e-6);
}

TEST(ReducedPod, FindsTheDirectionsOfItsSnapshotsAtRightAngles) {
  const Eigen::MatrixXd directions = random_matrix(30, 4, 5);
  const Eigen::MatrixXd snapshots = directions * random_matrix(4, 12, 6);
  const Eigen::VectorXd weights = random_matrix(30, 1, 7).array().abs() + 0.1;
  const Eigen::MatrixXd modes = pod(snapshots, weights, 9);
  ASSERT_EQ(modes.cols(), 4);
  const Eigen::MatrixXd products = modes.transpose() * weights.asDiagonal() * modes;
  EXPECT_LT((products - Eigen::MatrixXd::Identity(4, 4)).norm(), 1e-13);
  const Eigen::MatrixXd rest = snapshots - modes * (modes.transpose() * weights.asDiagonal() * snapshots);
  EXPECT_LT(rest.norm(), 1e-12 * snapshots.norm());
}

TEST(ReducedCubature, ReachesItsToleranceWithFewPositiveWeights) {
  const Eigen::MatrixXd contributions = random_matrix(6, 80, 8).array() + 0.3;
  const double tolerance = 1e-3 * contributions.rowwise().sum().norm();
  const Eigen::VectorXd weights = sparse_weights(contributions, tolerance);
  EXPECT_GE(weights.minCoeff(), 0.0);
  EXPECT_LE((weights.array() > 0.0).count(), 6);
  EXPECT_LE((contributions * weights - contributions.rowwise().sum()).norm(), tolerance);
}

}  // namespace
}  // namespace soft_robot_lab
