// SPDX-License-Identifier: BSD-3-Clause
// Several materials in one body and several bodies in one mesh, against closed forms.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "box_mesh.h"
#include "mechanics/elements/elements.h"
#include "mechanics/elements/strain_springs.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kFar = 10.0, kThin = 1e-6, kLength = 0.1, kStrain = 1e-4;
const Eigen::Matrix<bool, 3, 1> kAll = Eigen::Matrix<bool, 3, 1>::Constant(true);
const Material kSoft{1.0e5, 0.0, 1000.0}, kStiff{4.0e5, 0.0, 2500.0};

using IsInSecond = std::function<bool(const Eigen::Vector3d& middle_m)>;

TetMesh in_two_regions(TetMesh mesh, const IsInSecond& in_second) {
  mesh.regions = {{"first"}, {"second"}};
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 4; ++corner) middle_m += mesh.nodes_m.col(mesh.tets(corner, tet)) / 4.0;
    mesh.tet_region.push_back(in_second(middle_m) ? 1 : 0);
  }
  return mesh;
}

TetMesh bar(bool quadratic = true) {
  return box_mesh({0, -0.005, -0.005}, {kLength, 0.005, 0.005}, {10, 2, 1}, quadratic);
}

bool upper(const Eigen::Vector3d& middle_m) { return middle_m.y() > 0.0; }
bool outer(const Eigen::Vector3d& middle_m) { return middle_m.x() > 0.04; }

void clamp(Body& body) { body.fix_nodes({-kFar, -kFar, -kFar}, {kThin, kFar, kFar}, kAll); }

SolverOptions exact() {
  SolverOptions options;
  options.tolerance = 1e-9;
  return options;
}

Simulation at_rest(Body body, const SolverOptions& options = exact()) {
  Simulation simulation(std::move(body), {}, {}, options);
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  return simulation;
}

// Mean displacement of the bar's free end.
Eigen::Vector3d end_m(const Simulation& simulation) {
  const Eigen::Matrix3Xd& rest_m = simulation.body().mesh().nodes_m;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (int node = 0; node < rest_m.cols(); ++node) {
    if (rest_m(0, node) < kLength - kThin) continue;
    sum += simulation.state().positions_m.col(node) - rest_m.col(node);
    ++count;
  }
  return sum / count;
}

TEST(Regions, LayersOneAfterAnotherStretchAsSpringsInSeries) {
  for (const bool quadratic : {true, false}) {
    Body body(in_two_regions(bar(quadratic), outer), {kSoft, kStiff});
    clamp(body);
    const double stress_pa = kStrain * kSoft.youngs_modulus_pa;
    body.add_traction({kLength - kThin, -kFar, -kFar}, {kFar, kFar, kFar}, {stress_pa, 0, 0});
    const double stretch_m = stress_pa * (0.04 / kSoft.youngs_modulus_pa + 0.06 / kStiff.youngs_modulus_pa);
    EXPECT_NEAR(end_m(at_rest(std::move(body))).x(), stretch_m, 1e-3 * stretch_m);
  }
}

TEST(Regions, LayersSideBySideShareAForceAsSpringsInParallel) {
  Body body(in_two_regions(bar(), upper), {kSoft, kStiff});
  clamp(body);
  body.fix_nodes({kLength - kThin, -kFar, -kFar}, {kFar, kFar, kFar}, kAll, {{0.0}, {1.0, {kLength * kStrain, 0, 0}}},
                 "grip");
  const Simulation simulation = at_rest(std::move(body));
  Eigen::Vector3d pull_n = Eigen::Vector3d::Zero();
  for (const int node : simulation.body().holds().at(1).nodes) pull_n += simulation.reaction_forces_n().col(node);
  const double force_n = kStrain * 5e-5 * (kSoft.youngs_modulus_pa + kStiff.youngs_modulus_pa);
  EXPECT_NEAR(pull_n.x(), force_n, 1e-3 * force_n);
}

// Timoshenko's beam on the transformed section: the neutral axis lies at the layers' centres weighed by their moduli.
TEST(Regions, ABeamOfTwoLayersBendsByItsTransformedSection) {
  constexpr double kForce_n = 1e-4, kWidth = 0.01, kHeight = 0.005, kArea = kWidth * kHeight;
  Body body(in_two_regions(box_mesh({0, -0.005, -0.005}, {kLength, 0.005, 0.005}, {16, 4, 1}), upper), {kSoft, kStiff});
  clamp(body);
  body.add_force({kLength - kThin, -kFar, -kFar}, {kFar, kFar, kFar}, {0, -kForce_n, 0});
  const double soft_n = kSoft.youngs_modulus_pa * kArea, stiff_n = kStiff.youngs_modulus_pa * kArea;
  const double axis_m = 0.5 * kHeight * (stiff_n - soft_n) / (stiff_n + soft_n);
  const auto layer_nm2 = [&](double force_n, double center_m) {
    return force_n * (kHeight * kHeight / 12.0 + std::pow(center_m - axis_m, 2));
  };
  const double bending_nm2 = layer_nm2(soft_n, -0.5 * kHeight) + layer_nm2(stiff_n, 0.5 * kHeight);
  const double shear_n = 5.0 / 6.0 * 0.5 * (soft_n + stiff_n);  // G = E / 2
  const double sag_m = kForce_n * (std::pow(kLength, 3) / (3.0 * bending_nm2) + kLength / shear_n);
  EXPECT_NEAR(-end_m(at_rest(std::move(body), {})).y(), sag_m, 0.01 * sag_m);
}

TEST(Regions, MassIsEachVolumeTimesItsDensity) {
  const Body body(in_two_regions(bar(), outer), {kSoft, kStiff});
  EXPECT_NEAR(body.node_masses_kg().sum(), 1e-4 * (0.04 * 1000.0 + 0.06 * 2500.0), 1e-15);
}

// In time, with both kinds of viscosity.
TEST(Regions, OfOneMaterialAreAsOneRegion) {
  const Material material{2.6e5, 0.499, 1070.0};
  const auto run = [&](TetMesh mesh) {
    Body body(std::move(mesh), material);
    clamp(body);
    body.set_gravity({0, -9.81, 0});
    body.set_viscosity({0.5, 0.002, 0.2, 0.1});
    Simulation simulation(std::move(body), {}, {}, {});
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(simulation.step().converged);
    return simulation.state();
  };
  EXPECT_TRUE(run(bar()) == run(in_two_regions(bar(), upper)));
}

TEST(Regions, BothSolversFindTheSameShapeOfTwoMaterials) {
  SolverOptions swept;
  swept.method = SolverOptions::Method::xpbd;
  swept.tolerance = 1e-4;
  const auto sag_m = [&](const SolverOptions& options) {
    Body body(in_two_regions(box_mesh({0, -0.005, -0.005}, {0.04, 0.005, 0.005}, {4, 2, 1}), upper),
              {{1.0e5, 0.3, 1000.0}, {3.0e5, 0.45, 1000.0}});
    clamp(body);
    body.set_gravity({0, -9.81, 0});
    return (at_rest(std::move(body), options).state().positions_m).row(1).minCoeff();
  };
  EXPECT_NEAR(sag_m(swept), sag_m({}), 1e-5);
  EXPECT_LT(sag_m({}), -0.0055);
}

// Yeoh's silicone of one constant is neo-Hookean.
TEST(Regions, MayHaveDifferentLaws) {
  const Material silicone{2.6e5, 0.45, 1070.0}, same = Material::yeoh(0.5 * silicone.lame_mu_pa(), 0, 0, 0.45, 1070.0);
  const auto shape_m = [&](std::vector<Material> materials) {
    Body body(in_two_regions(bar(), upper), std::move(materials));
    clamp(body);
    body.set_gravity({0, -9.81, 0});
    return at_rest(std::move(body)).state().positions_m;
  };
  EXPECT_LT((shape_m({silicone, same}) - shape_m({silicone, silicone})).cwiseAbs().maxCoeff(), 1e-8);
}

// Two materials in one batch of four.
TEST(Regions, DerivativesAgreeWithCentralDifferences) {
  const auto odd = [](const Eigen::Vector3d& middle_m) { return middle_m.x() > middle_m.y(); };
  const Body body(in_two_regions(box_mesh({0, 0, 0}, {0.02, 0.02, 0.015}, {1, 1, 1}), odd),
                  {{1.0e5, 0.45, 1000.0}, Material::yeoh(8.0e4, -4.0e3, 2.0e3, 0.3, 1000.0)});
  BlockMatrix matrix(body.mesh().node_count(), stiffness_cliques(body));
  Elements elements(body, matrix);
  const StrainSprings springs(elements.batches(), elements.slots());
  const StrainTarget target{2.0e4, springs.strains(body.mesh().nodes_m)};
  const Eigen::VectorXd pressures = Eigen::VectorXd::LinSpaced(elements.multiplier_count(), -4.0e4, 3.0e4);
  Eigen::Matrix3Xd positions = body.mesh().nodes_m;
  for (Eigen::Index i = 0; i < positions.size(); ++i) positions.data()[i] += 1e-3 * std::sin(7.0 * i);
  const auto gradient = [&](const Eigen::Matrix3Xd& at, double& energy) -> Eigen::Matrix3Xd {
    Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, at.cols());
    const ElementSums sums = elements.add_gradient(at, pressures, forces);
    energy = sums.elastic_energy + pressures.cwiseProduct(sums.volumetric_strain).dot(elements.rest_volumes_m3()) +
             springs.add_gradient(at, target, forces);
    return forces;
  };
  double unused = 0.0;
  const Eigen::Matrix3Xd exact_n = gradient(positions, unused);
  elements.set_lambda_pa(Eigen::VectorXd::Zero(elements.multiplier_count()));
  elements.add_hessian(positions, pressures, false, matrix);
  springs.add_hessian(positions, target, false, matrix);
  constexpr double h = 1e-7;
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    Eigen::Matrix3Xd plus = positions, minus = positions, unit = Eigen::Matrix3Xd::Zero(3, positions.cols());
    plus.data()[i] += h;
    minus.data()[i] -= h;
    unit.data()[i] = 1.0;
    double energy_plus = 0.0, energy_minus = 0.0;
    const Eigen::Matrix3Xd change = (gradient(plus, energy_plus) - gradient(minus, energy_minus)) / (2.0 * h);
    EXPECT_NEAR(exact_n.data()[i], (energy_plus - energy_minus) / (2.0 * h), 1e-6 * exact_n.norm());
    const Eigen::Matrix3Xd column = matrix.multiply(unit);
    EXPECT_LT((column - change).norm(), 1e-6 * column.norm()) << i;
  }
}

TEST(Regions, WhatKnowsOneMaterialRefusesSeveral) {
  Body body(in_two_regions(bar(false), upper), {kSoft, kStiff});
  EXPECT_THROW(body.set_linear_volume(LinearVolume::vertex_averaged), std::invalid_argument);
  EXPECT_THROW(Body(in_two_regions(bar(), upper), std::vector<Material>{kSoft}), std::invalid_argument);
  EXPECT_EQ(body.material().youngs_modulus_pa, kSoft.youngs_modulus_pa);
}

TetMesh lifted_bar() {
  TetMesh mesh = bar();
  mesh.nodes_m.row(1).array() += 0.05;
  return mesh;
}

TEST(Bodies, InOneMeshRestAsEachAlone) {
  const auto rest = [](TetMesh mesh, std::vector<Material> materials) {
    Body body(std::move(mesh), std::move(materials));
    clamp(body);
    body.set_gravity({0, -9.81, 0});
    return at_rest(std::move(body)).state().positions_m;
  };
  TetMesh both = bar();
  add_body("plate", lifted_bar(), both);
  const Eigen::Matrix3Xd together = rest(both, {kSoft, kStiff}), first = rest(bar(), {kSoft}),
                         second = rest(lifted_bar(), {kStiff});
  EXPECT_LT((together.leftCols(first.cols()) - first).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((together.rightCols(second.cols()) - second).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(Bodies, BoxesAndPlacesMayBeOfOneBodyOnly) {
  TetMesh mesh = bar();
  mesh.surface_names = {"side"};
  TetMesh crossing = bar();
  crossing.surface_names = {"side"};
  add_body("plate", crossing, mesh);
  EXPECT_EQ(mesh.surface_names, (std::vector<std::string>{"side", "plate/side"}));
  Body body(mesh, std::vector<Material>(2, kSoft));
  const int count = body.fix_nodes({-kFar, -kFar, -kFar}, {kThin, kFar, kFar}, kAll, {}, "", 1);
  EXPECT_EQ(count, body.fixed_node_count());
  for (int node = 0; node < mesh.node_count(); ++node)
    EXPECT_FALSE(body.fixed().col(node).any() && body.body_of_node(node) == 0);
  EXPECT_NEAR(body.add_traction({kLength - kThin, -kFar, -kFar}, {kFar, kFar, kFar}, {1, 0, 0}, 1), 1e-4, 1e-12);
  for (const int owner : {0, 1}) {
    const MeshLocator locator(body.mesh(), owner);
    EXPECT_EQ(body.mesh().body_of(locator.locate({0.05, 0.001, 0}).tet), owner);
    EXPECT_EQ(body.mesh().body_of(locator.locate({0.05, 0.1, 0}).tet), owner);
  }
}

TEST(Bodies, ThatShareANodeOrANameAreRefused) {
  TetMesh mesh = bar();
  EXPECT_THROW(add_body("body", lifted_bar(), mesh), std::invalid_argument);
  EXPECT_THROW(add_body("plate", bar(false), mesh), std::invalid_argument);
  TetMesh torn = in_two_regions(bar(), outer);
  torn.bodies = {"body", "plate"};
  torn.regions[1].body = 1;
  EXPECT_THROW(check_mesh(torn), std::invalid_argument);
  TetMesh parts = bar();
  add_body("plate", lifted_bar(), parts);
  EXPECT_NO_THROW(check_mesh(parts));
  for (MeshRegion& region : parts.regions) region.body = 0;
  parts.bodies = {"body"};
  EXPECT_THROW(check_mesh(parts), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
