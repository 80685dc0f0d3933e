// SPDX-License-Identifier: BSD-3-Clause
// What one pass over all elements of the cantilever (100 x 20 x 20 mm) costs, without any linear solve. CPU time of one
// thread, comparable between versions on one machine.
#include <benchmark/benchmark.h>

#include "mechanics/box_mesh.h"
#include "mechanics/elements/elements.h"

namespace soft_robot_lab {
namespace {

struct Pass {
  Pass(bool quadratic, bool yeoh)
      : body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {20, 4, 4}, quadratic),
             yeoh ? Material::yeoh(1.0e4, 200.0, 0.0, 0.4999, 1070.0) : Material()),
        matrix(body.mesh().node_count(), stiffness_cliques(body)),
        elements(body, matrix),
        positions(body.mesh().nodes_m),
        multipliers(Eigen::VectorXd::Constant(elements.count(), 1.0e3)) {
    for (Eigen::Index i = 0; i < positions.size(); ++i)
      positions.data()[i] += 2e-4 * std::sin(1.3 * static_cast<double>(i));
  }

  Body body;
  BlockMatrix matrix;
  Elements elements;
  Eigen::Matrix3Xd positions;
  Eigen::VectorXd multipliers;
};

void Gradient(benchmark::State& state) {
  Pass pass(state.range(0) == 1, state.range(1) == 1);
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, pass.positions.cols());
  for (auto _ : state) benchmark::DoNotOptimize(pass.elements.add_gradient(pass.positions, pass.multipliers, forces));
  state.SetItemsProcessed(state.iterations() * pass.elements.count());
}
void Hessian(benchmark::State& state) {
  Pass pass(state.range(0) == 1, state.range(1) == 1);
  for (auto _ : state) pass.elements.add_hessian(pass.positions, pass.multipliers, false, pass.matrix);
  state.SetItemsProcessed(state.iterations() * pass.elements.count());
}
BENCHMARK(Gradient)->ArgNames({"quadratic", "yeoh"})->ArgsProduct({{1, 0}, {0, 1}});
BENCHMARK(Hessian)->ArgNames({"quadratic", "yeoh"})->ArgsProduct({{1, 0}, {0, 1}});

}  // namespace
}  // namespace soft_robot_lab
