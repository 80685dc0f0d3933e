// SPDX-License-Identifier: BSD-3-Clause
// Where the time goes and how far from the machine's limit: the parts of a Newton iteration on bars of growing meshes,
// beside what dgemm and a copy of memory reach here. CPU time of one thread.
#include <algorithm>
#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>

#include "mechanics/linear_algebra/block_cholesky.h"
#include "mechanics/box_mesh.h"
#include "mechanics/elements/elements.h"
#include "smallest.h"

extern "C" void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc);

namespace soft_robot_lab {
namespace {

// Additions and multiplications of batch_gradient and batch_hessian for an element of 10 nodes and 4 points, counted by
// hand; gathering and scattering count as none.
constexpr double kGradientFlops = 2.6e3, kHessianFlops = 1.36e4;

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

void rate(benchmark::State& state, const char* name, double per_iteration) {
  state.counters[name] = benchmark::Counter(per_iteration, benchmark::Counter::kIsIterationInvariantRate);
}

void PeakOfDgemm(benchmark::State& state) {
  const int n = 512;
  const double one = 1.0;
  Eigen::MatrixXd a = Eigen::MatrixXd::Random(n, n), b = a, c = a;
  for (auto _ : state) dgemm_("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &one, c.data(), &n);
  rate(state, "flop_per_s", 2.0 * n * n * n);
}

void PeakOfMemory(benchmark::State& state) {
  const std::size_t bytes = static_cast<std::size_t>(state.range(0)) << 20;
  std::vector<char> from(bytes, 1), to(bytes, 2);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), bytes);
    benchmark::ClobberMemory();
  }
  rate(state, "byte_per_s", 2.0 * static_cast<double>(bytes));
}

// A bar of 100 x 20 x 20 mm, clamped, a little bent.
struct Bar {
  Body body;
  BlockMatrix matrix;
  BlockCholesky factor;
  Elements elements;
  Eigen::Matrix3Xd positions_m, forces_n;
  Eigen::VectorXd multipliers_pa;

  explicit Bar(int refinement)
      : body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, refinement * Eigen::Vector3i(4, 1, 1)),
             {264200.0, 0.4999, 1070.0}),
        matrix(body.mesh().node_count(), cliques(body.mesh())),
        factor(matrix),
        elements(body, matrix),
        positions_m(body.mesh().nodes_m),
        forces_n(Eigen::Matrix3Xd::Zero(3, body.mesh().node_count())),
        multipliers_pa(Eigen::VectorXd::Zero(body.mesh().tet_count())) {
    body.fix_nodes(Eigen::Vector3d::Constant(-1.0), {1e-6, 1, 1}, {true, true, true});
    positions_m.row(1).array() += 0.1 * positions_m.row(0).array().square();
    assemble();
  }

  static std::vector<std::vector<int>> cliques(const TetMesh& mesh) {
    std::vector<std::vector<int>> all;
    for (Eigen::Index e = 0; e < mesh.tets.cols(); ++e)
      all.emplace_back(mesh.tets.col(e).data(), mesh.tets.col(e).data() + mesh.tets.rows());
    return all;
  }

  void assemble() {
    matrix.set_zero();
    elements.add_hessian(positions_m, multipliers_pa, false, matrix);
    for (int node = 0; node < body.mesh().node_count(); ++node)
      matrix.add_to_diagonal(node, 3600.0 * body.node_masses_kg()[node]);
    matrix.hold(body.fixed());
  }
};

void report_size(benchmark::State& state, const Bar& bar) {
  state.counters["nodes"] = bar.body.mesh().node_count();
  state.counters["elements"] = bar.body.mesh().tet_count();
}

void Residual(benchmark::State& state) {
  Bar bar(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    bar.forces_n.setZero();
    benchmark::DoNotOptimize(bar.elements.add_gradient(bar.positions_m, bar.multipliers_pa, bar.forces_n));
  }
  report_size(state, bar);
  rate(state, "flop_per_s", kGradientFlops * bar.elements.count());
}

void Assembly(benchmark::State& state) {
  Bar bar(static_cast<int>(state.range(0)));
  for (auto _ : state) bar.assemble();
  report_size(state, bar);
  rate(state, "flop_per_s", kHessianFlops * bar.elements.count());
}

void Factorisation(benchmark::State& state) {
  Bar bar(static_cast<int>(state.range(0)));
  for (auto _ : state)
    if (!bar.factor.factorise(bar.matrix)) state.SkipWithError("not positive definite");
  report_size(state, bar);
  rate(state, "flop_per_s", bar.factor.flops());
}

// Reads the factor twice, so it is bound by memory.
void Solution(benchmark::State& state) {
  Bar bar(static_cast<int>(state.range(0)));
  bar.factor.factorise(bar.matrix);
  Eigen::MatrixXd x(bar.positions_m.size(), 1);
  for (auto _ : state) {
    x.setOnes();
    bar.factor.solve(x);
  }
  report_size(state, bar);
  rate(state, "byte_per_s", 16.0 * static_cast<double>(bar.factor.factor_size()));
}

void repeat(benchmark::internal::Benchmark* benchmark) {
  benchmark->Unit(benchmark::kMicrosecond)
      ->Repetitions(5)
      ->ComputeStatistics("min", smallest)
      ->ComputeStatistics("max", largest)
      ->DisplayAggregatesOnly();
}
void over_sizes(benchmark::internal::Benchmark* benchmark) { repeat(benchmark->DenseRange(1, 4)); }
BENCHMARK(PeakOfDgemm)->Apply(repeat);
BENCHMARK(PeakOfMemory)->Arg(2)->Arg(64)->Apply(repeat);
BENCHMARK(Residual)->Apply(over_sizes);
BENCHMARK(Assembly)->Apply(over_sizes);
BENCHMARK(Factorisation)->Apply(over_sizes);
BENCHMARK(Solution)->Apply(over_sizes);

}  // namespace
}  // namespace soft_robot_lab
