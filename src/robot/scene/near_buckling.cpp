// SPDX-License-Identifier: BSD-3-Clause
// Signs that a body is about to buckle, or has: then the side to which it goes hangs on what no mesh knows.
#include <algorithm>
#include <stdexcept>
#include <utility>

#include <Eigen/Eigenvalues>

#include "fidelity.h"

namespace soft_robot_lab {
namespace {

// Of the rest shape's stiffness: a straight column has 1 - load / load of buckling. What a mesh of 300 nodes gets wrong
// of a load of buckling is less.
constexpr double kHeldLittle = 0.2;

// The largest compliance of the markers to forces at them [m/N]; none where nothing says it.
std::optional<double> compliance_m_n(Simulation& simulation) {
  Eigen::MatrixXd motions;
  try {
    motions = simulation.marker_compliances();
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
  const Eigen::Matrix3Xd& positions_m = simulation.state().positions_m;
  Eigen::MatrixXd compliance(motions.cols(), motions.cols());
  for (Eigen::Index column = 0; column < motions.cols(); ++column) {
    const Eigen::Map<const Eigen::Matrix3Xd> motion(motions.col(column).data(), 3, positions_m.cols());
    for (std::size_t m = 0; m < simulation.markers().size(); ++m)
      compliance.block<3, 1>(3 * static_cast<Eigen::Index>(m), column) =
          simulation.markers()[m].velocity(positions_m, motion);
  }
  const Eigen::MatrixXd symmetric = 0.5 * (compliance + compliance.transpose());
  const double largest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
  if (!(largest > 0.0)) return std::nullopt;
  return largest;
}

}  // namespace

void keep_worse(const NearBuckling& sign, std::optional<NearBuckling>& worst) {
  const auto rank = [](const NearBuckling& of) { return std::pair(std::max(of.snapped_m, of.apart_m), -of.stiffness); };
  if (!worst || rank(sign) > rank(*worst)) worst = sign;
}

double snapped_m(const std::vector<SolveWarning>& warnings) {
  double most_m = 0.0;
  for (const SolveWarning& warning : warnings)
    if (warning.kind == "snapped") most_m = std::max(most_m, warning.size);
  return most_m;
}

std::optional<NearBuckling> snap_of(const JudgedRests& rests, int nodes) {
  std::optional<NearBuckling> worst;
  for (std::size_t i = 0; i < rests.numbers.size(); ++i) {
    if (rests.snapped_m[i] > 0.0) keep_worse({rests.numbers[i], nodes, rests.snapped_m[i], 0.0, 1.0}, worst);
  }
  return worst;
}

std::optional<NearBuckling> held_little(const JudgedRests& rests, const std::vector<std::size_t>& which,
                                        Simulation& simulation, Judgement& judgement) {
  const SolveCost cost = solve_cost(*simulation.model());
  const double once_s =
      cost.factorisation_s + static_cast<double>(simulation.markers().size()) * cost.iteration_s;  // three columns each
  simulation.reset();
  const std::optional<double> at_rest_m_n = compliance_m_n(simulation);
  judgement.cost_s += once_s;
  std::optional<NearBuckling> worst;
  for (const std::size_t i : which) {
    if (!at_rest_m_n) break;
    simulation.set_state(rests.states[i]);
    const std::optional<double> here_m_n = compliance_m_n(simulation);
    judgement.cost_s += once_s;
    const NearBuckling sign{rests.numbers[i], simulation.body().mesh().node_count(), 0.0, 0.0,
                            here_m_n ? *at_rest_m_n / *here_m_n : 0.0};
    if (sign.stiffness < kHeldLittle) keep_worse(sign, worst);
  }
  return worst;
}

}  // namespace soft_robot_lab
