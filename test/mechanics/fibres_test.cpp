// SPDX-License-Identifier: BSD-3-Clause
// Threads in silicone, against closed forms of composite bars, on several meshes and turned.
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "box_mesh.h"
#include "mechanics/elements/elements.h"
#include "mechanics/elements/volume_patches.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kModulus_pa = 1e5, kLength_m = 0.1, kWidth_m = 0.01;
const Eigen::Matrix<bool, 3, 1> kAllAxes = Eigen::Matrix<bool, 3, 1>::Constant(true);

// Along x, held at x = 0, all of it turned about the origin.
Body bar(const Eigen::Vector3i& cells, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity(),
         double poissons_ratio = 0.49) {
  TetMesh mesh = box_mesh({0, -kWidth_m / 2, -kWidth_m / 2}, {kLength_m, kWidth_m / 2, kWidth_m / 2}, cells);
  Body straight(mesh, {kModulus_pa, poissons_ratio, 1070.0});
  mesh.nodes_m = turn * mesh.nodes_m;
  Body body(mesh, {kModulus_pa, poissons_ratio, 1070.0});
  for (Eigen::Index node = 0; node < straight.mesh().node_count(); ++node) {
    if (straight.mesh().nodes_m(0, node) > 1e-9) continue;
    const Eigen::Vector3d at_m = body.mesh().nodes_m.col(node);
    body.fix_nodes(at_m.array() - 1e-9, at_m.array() + 1e-9, kAllAxes);
  }
  return body;
}

Fibre along_bar(double y_m, double z_m, double stiffness_n, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity(),
                bool only_tension = false) {
  return {"along",
          {{turn * Eigen::Vector3d(0, y_m, z_m), turn * Eigen::Vector3d(kLength_m, y_m, z_m)}},
          stiffness_n,
          only_tension};
}

void pull_end(Body& body, const Eigen::Vector3d& force_n, const Eigen::Matrix3d& turn) {
  std::vector<EmbeddedPoint> points;  // evenly over the end
  const MeshLocator locator(body.mesh());
  constexpr int kPoints = 8;
  for (int i = 0; i < kPoints; ++i)
    for (int j = 0; j < kPoints; ++j)
      body.add_force(locator.embed(turn * Eigen::Vector3d(kLength_m, kWidth_m * ((i + 0.5) / kPoints - 0.5),
                                                          kWidth_m * ((j + 0.5) / kPoints - 0.5))),
                     turn * force_n / (kPoints * kPoints));
}

Eigen::Vector3d end_motion_m(Body body, const Eigen::Matrix3d& turn, SolveReport* report = nullptr) {
  const EmbeddedPoint end = MeshLocator(body.mesh()).embed(turn * Eigen::Vector3d(kLength_m, 0, 0));
  Simulation simulation(std::move(body), {}, {}, SolverOptions());
  const SolveReport solved = simulation.solve_equilibrium();
  EXPECT_TRUE(solved.converged) << solved.message;
  if (report) *report = solved;
  return turn.transpose() * end.at(simulation.state().positions_m - simulation.body().mesh().nodes_m);
}

Eigen::Matrix3d some_turn() { return Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()).matrix(); }

Eigen::Matrix3Xd shaken(const Body& body, double by_m) {
  srand(1);
  return body.mesh().nodes_m + by_m * Eigen::Matrix3Xd::Random(3, body.mesh().node_count());
}

Eigen::VectorXd tensions_of(const Elements& elements, const Eigen::Matrix3Xd& at_m) {
  Eigen::Matrix3Xd unused = 0.0 * at_m;
  const Eigen::VectorXd strain =
      elements.add_gradient(at_m, Eigen::VectorXd::Zero(elements.multiplier_count()), unused).volumetric_strain;
  return elements.lambda_pa().cwiseProduct(strain);
}

double energy_j(const Elements& elements, const Eigen::Matrix3Xd& at_m) {
  Eigen::Matrix3Xd unused = 0.0 * at_m;
  const ElementSums sums = elements.add_gradient(at_m, Eigen::VectorXd::Zero(elements.multiplier_count()), unused);
  return sums.elastic_energy + 0.5 * elements.sum_of_squares(elements.lambda_pa(), sums.volumetric_strain);
}

Eigen::Matrix3Xd gradient_n(const Elements& elements, const Eigen::Matrix3Xd& at_m) {
  Eigen::Matrix3Xd gradient = 0.0 * at_m;
  elements.add_gradient(at_m, tensions_of(elements, at_m), gradient);
  return gradient;
}

TEST(Fibres, GradientAndHessianAreDerivativesOfTheEnergy) {
  Body body = bar({2, 1, 1});
  body.add_fibre({"slanting", {{{0.01, -0.003, 0.002}, {0.06, 0.004, -0.001}, {0.09, 0, 0}}}, 5.0, false});
  body.add_fibre(along_bar(0.002, 0.003, 2.0, Eigen::Matrix3d::Identity(), true));
  BlockMatrix matrix(body.mesh().node_count(), stiffness_cliques(body));
  Elements elements(body, matrix);
  ASSERT_GT(elements.fibre_count(), 5);
  const Eigen::Matrix3Xd at_m = shaken(body, 5e-4), gradient = gradient_n(elements, at_m);
  matrix.set_zero();
  elements.add_hessian(at_m, tensions_of(elements, at_m), false, matrix);
  constexpr double kStep_m = 1e-7;
  for (Eigen::Index i = 0; i < at_m.size(); i += 5) {
    Eigen::Matrix3Xd more = at_m, less = at_m, way = 0.0 * at_m;
    more.data()[i] += kStep_m;
    less.data()[i] -= kStep_m;
    way.data()[i] = 1.0;
    EXPECT_NEAR((energy_j(elements, more) - energy_j(elements, less)) / (2 * kStep_m), gradient.data()[i],
                1e-5 * gradient.norm());
    const Eigen::Matrix3Xd change = (gradient_n(elements, more) - gradient_n(elements, less)) / (2 * kStep_m);
    EXPECT_LT((matrix.multiply(way) - change).norm(), 1e-5 * change.norm());
  }
}

TEST(Fibres, AThreadThatCannotPushDoesNothingWhereItIsPushed) {
  const auto end_m = [](double stiffness_n, bool only_tension, double force_n) {
    Body body = bar({8, 2, 2});
    for (const double y_m : {-0.0025, 0.0025})
      body.add_fibre(along_bar(y_m, 0.0, stiffness_n, Eigen::Matrix3d::Identity(), only_tension));
    pull_end(body, {force_n, 0, 0}, Eigen::Matrix3d::Identity());
    return end_motion_m(std::move(body), Eigen::Matrix3d::Identity()).x();
  };
  const double silicone_n = kModulus_pa * kWidth_m * kWidth_m, push_n = -5e-4 * silicone_n;
  const double alone_m = end_m(1e-9, false, push_n);
  EXPECT_NEAR(end_m(100.0 * silicone_n, true, push_n), alone_m, 1e-6 * std::abs(alone_m));
  EXPECT_LT(std::abs(end_m(100.0 * silicone_n, false, push_n)), 0.1 * std::abs(alone_m));
  EXPECT_NEAR(end_m(100.0 * silicone_n, true, -push_n), end_m(100.0 * silicone_n, false, -push_n),
              1e-4 * std::abs(alone_m));
}

TEST(Fibres, ABarIsAsStiffAsSiliconeAndThreadsTogether) {
  for (const Eigen::Matrix3d& turn : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), some_turn()}) {
    for (const Eigen::Vector3i& cells : {Eigen::Vector3i(10, 2, 2), Eigen::Vector3i(7, 1, 1)}) {
      for (const double ratio : {0.5, 20.0, 5000.0}) {
        const double silicone_n = kModulus_pa * kWidth_m * kWidth_m, each_n = ratio * silicone_n / 4.0;
        Body body = bar(cells, turn);
        for (const double y_m : {-0.0025, 0.0025})
          for (const double z_m : {-0.0025, 0.0025}) body.add_fibre(along_bar(y_m, z_m, each_n, turn));
        const double strain = 1e-3;
        pull_end(body, {strain * silicone_n * (1.0 + ratio), 0, 0}, turn);
        const double together = end_motion_m(std::move(body), turn).x() / kLength_m;
        // Silicone between the threads gives way at the end where it is pulled.
        const double at_end = 0.5 * kWidth_m / kLength_m * strain * ratio;
        EXPECT_NEAR(together, strain, 0.02 * strain + at_end) << ratio;
      }
    }
  }
}

// A force across at the end: w = F l^3 / 3 EI + shear, EI of both about the neutral axis of both.
double composite_sag_m(double force_n, double stiffness_n, double z_m) {
  const double area = kModulus_pa * kWidth_m * kWidth_m, own = area * kWidth_m * kWidth_m / 12.0;
  const double axis_m = stiffness_n * z_m / (area + stiffness_n);
  const double bending = own + area * axis_m * axis_m + stiffness_n * std::pow(z_m - axis_m, 2);
  const double shear = 5.0 / 6.0 * area / (2.0 * 1.49);
  return force_n * std::pow(kLength_m, 3) / (3.0 * bending) + force_n * kLength_m / shear;
}

TEST(Fibres, ABeamDoesNotLockHoweverStiffItsThreadIs) {
  constexpr double kHeight_m = 0.003, kForce_n = 2e-4;
  const double silicone_n = kModulus_pa * kWidth_m * kWidth_m;
  for (const Eigen::Vector3i& cells : {Eigen::Vector3i(12, 2, 2), Eigen::Vector3i(20, 3, 3)})
    for (const double ratio : {0.3, 10.0, 1e3, 1e4}) {
      Body body = bar(cells);
      body.add_fibre(along_bar(0.0, kHeight_m, ratio * silicone_n));
      pull_end(body, {0, 0, kForce_n}, Eigen::Matrix3d::Identity());
      SolveReport report;
      const double sag_m = end_motion_m(std::move(body), Eigen::Matrix3d::Identity(), &report).z();
      EXPECT_NEAR(sag_m / composite_sag_m(kForce_n, ratio * silicone_n, kHeight_m), 1.0, 0.02)
          << ratio << " " << cells.transpose() << ", iterations " << report.iterations;
    }
}

TEST(Fibres, RefuseWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Body body = bar({5, 1, 1});
  EXPECT_THROW(body.add_fibre({"outside", {{{0, 0, 0}, {0.12, 0, 0}}}, 1.0, true}), std::invalid_argument);
  EXPECT_THROW(body.add_fibre({"soft", {{{0, 0, 0}, {0.1, 0, 0}}}, 0.0, true}), std::invalid_argument);
  EXPECT_THROW(body.add_fibre({"point", {{{0, 0, 0}}}, 1.0, true}), std::invalid_argument);
  EXPECT_THROW(body.add_fibre({"nothing", {}, 1.0, true}), std::invalid_argument);
  EXPECT_THROW(body.add_fibre({"nan", {{{0, 0, 0}, {nan, 0, 0}}}, 1.0, true}), std::invalid_argument);
  EXPECT_THROW(body.add_fibre({"nan", {{{0, 0, 0}, {0.1, 0, 0}}}, nan, true}), std::invalid_argument);
  EXPECT_TRUE(body.fibre_groups().empty());
  Body linear(box_mesh({0, 0, 0}, {0.1, 0.01, 0.01}, {5, 1, 1}, false), {kModulus_pa, 0.3, 1070.0});
  EXPECT_THROW(linear.add_fibre({"locks", {{{0, 0.005, 0.005}, {0.1, 0.005, 0.005}}}, 1.0, true}),
               std::invalid_argument);
}

TEST(Fibres, OnAFaceOfElementsCountOnce) {
  Body body = bar({5, 2, 2});
  body.add_fibre(along_bar(0.0, 0.0, 3.0));
  body.add_fibre(along_bar(kWidth_m / 2, kWidth_m / 2, 3.0));  // an edge of the body
  double lengths_m[2] = {0.0, 0.0};
  for (const FibreGroup& group : body.fibre_groups()) lengths_m[group.fibre] += group.rest_length_m;
  EXPECT_NEAR(lengths_m[0], kLength_m, 1e-12);
  EXPECT_NEAR(lengths_m[1], kLength_m, 1e-12);
}

}  // namespace
}  // namespace soft_robot_lab
