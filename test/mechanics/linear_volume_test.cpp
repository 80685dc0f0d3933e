// SPDX-License-Identifier: BSD-3-Clause
// Linear elements with their volume averaged around vertices, on the cantilever of reference R1.
#include <gtest/gtest.h>

#include "box_mesh.h"
#include "mechanics/simulation/modal.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

Body cantilever(LinearVolume volume, double poissons_ratio, int cells) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5 * cells, cells, cells}, false),
            {264200.0, poissons_ratio, 1070.0});
  body.set_linear_volume(volume);
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_gravity({0, -9.81, 0});
  return body;
}

double sag_m(LinearVolume volume, double poissons_ratio, int cells) {
  Simulation simulation(cantilever(volume, poissons_ratio, cells), {}, {}, {});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  EXPECT_LE(report.iterations, 8);
  return -simulation.state().positions_m.row(1).minCoeff() - 0.01;  // of the lowest corner, a little above the tip's
}

TEST(LinearVolume, LocksLessWhereAveragedAndSoftensAsTheMeshIsRefined) {
  for (const double poissons_ratio : {0.45, 0.499, 0.4999}) {
    SCOPED_TRACE(poissons_ratio);
    const double own = sag_m(LinearVolume::element, poissons_ratio, 3);
    const double averaged = sag_m(LinearVolume::vertex_averaged, poissons_ratio, 3);
    EXPECT_GT(averaged, (poissons_ratio > 0.49 ? 5.0 : 1.2) * own);
    EXPECT_GT(averaged, 0.008);
    EXPECT_LT(averaged, 0.0147);
    const double finer = sag_m(LinearVolume::vertex_averaged, poissons_ratio, 5);
    EXPECT_GT(finer, averaged);
    EXPECT_LT(finer, 0.0147);
  }
}

TEST(LinearVolume, StepsInTimeAndRepeatsFromASavedState) {
  Simulation first(cantilever(LinearVolume::vertex_averaged, 0.499, 2), {}, {}, {});
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(first.step().converged);
  Simulation second(cantilever(LinearVolume::vertex_averaged, 0.499, 2), {}, {}, {});
  second.set_state(first.state());
  first.step();
  second.step();
  EXPECT_EQ((first.state().positions_m - second.state().positions_m).norm(), 0.0);
}

TEST(LinearVolume, VibratesLowerWhereAveraged) {
  const auto first_hz = [](LinearVolume volume) {
    return modal_analysis(cantilever(volume, 0.499, 3), 1).frequencies_hz[0];
  };
  EXPECT_LT(first_hz(LinearVolume::vertex_averaged), 0.6 * first_hz(LinearVolume::element));
}

TEST(LinearVolume, RefusesQuadraticElementsAndXpbd) {
  Body quadratic(box_mesh({0, 0, 0}, {0.01, 0.01, 0.01}, {1, 1, 1}, true), Material());
  EXPECT_THROW(quadratic.set_linear_volume(LinearVolume::vertex_averaged), std::invalid_argument);
  EXPECT_NO_THROW(quadratic.set_linear_volume(LinearVolume::element));
  SolverOptions options;
  options.method = SolverOptions::Method::xpbd;
  try {
    Simulation(cantilever(LinearVolume::vertex_averaged, 0.45, 1), {}, {}, options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("choose element, or method newton"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace soft_robot_lab
