// SPDX-License-Identifier: BSD-3-Clause
// The silicones in a uniaxial pull, against the closed forms of incompressible material.
#include "soft_robot_lab/mechanics/material.h"

#include <gtest/gtest.h>

#include <cmath>

#include "box_mesh.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kSide = 0.01, kArea = kSide * kSide;

// Force over rest area at a stretch: 2 (l - 1/l^2) (dW/dI1 + dW/dI2 / l).
double nominal_stress_pa(const Material& material, double stretch) {
  const double phi = stretch * stretch + 2.0 / stretch - 3.0;
  const double slope = material.c10_pa() + 2.0 * material.c2_pa * phi + 3.0 * material.c3_pa * phi * phi;
  return 2.0 * (stretch - 1.0 / (stretch * stretch)) * (slope + material.c01_pa / stretch);
}

// A cube on three planes of symmetry, pulled at its fourth side.
Simulation cube(const Material& material, bool quadratic, double stress_pa, const SolverOptions& options) {
  Body body(box_mesh({0, 0, 0}, {kSide, kSide, kSide}, {1, 1, 1}, quadratic), material);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d max = Eigen::Vector3d::Ones();
    max[axis] = 1e-9;
    Eigen::Matrix<bool, 3, 1> held = Eigen::Matrix<bool, 3, 1>::Constant(false);
    held[axis] = true;
    body.fix_nodes({-1, -1, -1}, max, held);
  }
  body.add_traction({kSide - 1e-9, -1, -1}, {1, 1, 1}, {stress_pa, 0, 0});
  return Simulation(std::move(body), {}, {}, options);
}

double stretch_of(Simulation& simulation) {
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  return simulation.state().positions_m.row(0).maxCoeff() / kSide;
}

struct Named {
  const char* name;
  Material material;
};
const Named kSilicones[] = {{"neo_hookean", {62460.0, 0.4999, 1070.0}},
                            {"mooney_rivlin", Material::mooney_rivlin(7.0e3, 3.4e3, 0.4999, 1070.0)},
                            {"yeoh", Material::yeoh(10410.0, 267.0, 0.0, 0.4999, 1070.0)},
                            {"yeoh of three constants", Material::yeoh(10410.0, -600.0, 40.0, 0.4999, 1070.0)}};

TEST(Material, FollowsTheClosedFormOfAUniaxialPull) {
  for (const Named& silicone : kSilicones) {
    for (const bool quadratic : {true, false}) {
      for (const double stretch : {0.8, 1.5, 3.0}) {  // below 0.74 a cube under a dead load is unstable
        SCOPED_TRACE(std::string(silicone.name) + (quadratic ? " quadratic " : " linear ") + std::to_string(stretch));
        const double stress_pa = nominal_stress_pa(silicone.material, stretch);
        Simulation simulation = cube(silicone.material, quadratic, stress_pa, {});
        const double found = stretch_of(simulation);
        EXPECT_NEAR(nominal_stress_pa(silicone.material, found), stress_pa, 0.01 * std::abs(stress_pa)) << found;
      }
    }
  }
}

TEST(Material, StretchesAlikeWithEitherSolver) {
  SolverOptions local;
  local.method = SolverOptions::Method::xpbd;
  local.tolerance = 1e-4;
  local.time_step_s = 1.0 / 240.0;
  for (const Named& silicone : kSilicones) {
    SCOPED_TRACE(silicone.name);
    const double stress_pa = nominal_stress_pa(silicone.material, 1.5);
    Simulation newton = cube(silicone.material, true, stress_pa, {});
    Simulation swept = cube(silicone.material, true, stress_pa, local);
    EXPECT_NEAR(stretch_of(swept), stretch_of(newton), 1e-3);
  }
}

}  // namespace
}  // namespace soft_robot_lab
