// SPDX-License-Identifier: BSD-3-Clause
#include "slip_rates.h"

#include <algorithm>
#include <vector>

#include <Eigen/LU>

#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

constexpr double kNoSlip = 1e-12;  // of the largest rate

std::vector<Eigen::Index> where(const std::vector<bool>& slips) {
  std::vector<Eigen::Index> chosen;
  for (std::size_t i = 0; i < slips.size(); ++i)
    if (slips[i]) chosen.push_back(static_cast<Eigen::Index>(i));
  return chosen;
}

}  // namespace

Eigen::MatrixXd slips_of_all(const Eigen::MatrixXd& coupling, const Eigen::MatrixXd& beyond) {
  return (Eigen::MatrixXd::Identity(coupling.rows(), coupling.cols()) - coupling).partialPivLu().solve(beyond);
}

// Block pivoting, and at last the one with the largest number alone, which ends (Murty 1974).
Eigen::VectorXd slip_rates(const Eigen::MatrixXd& coupling, const Eigen::VectorXd& beyond) {
  const Eigen::Index count = beyond.size();
  std::vector<bool> slips(static_cast<std::size_t>(count), true);
  Eigen::VectorXd rates = Eigen::VectorXd::Zero(count);
  for (Eigen::Index round = 0; round < constants::kBlockRounds + 10 * count; ++round) {
    const std::vector<Eigen::Index> chosen = where(slips);
    rates.setZero();
    rates(chosen) = slips_of_all(coupling(chosen, chosen), beyond(chosen));
    const Eigen::VectorXd excess = beyond + coupling * rates - rates;  // of those that stick
    const double none = kNoSlip * std::max(rates.cwiseAbs().maxCoeff(), beyond.cwiseAbs().maxCoeff());
    bool done = true;
    for (Eigen::Index i = count - 1; i >= 0 && (done || round < constants::kBlockRounds); --i) {
      const auto place = static_cast<std::size_t>(i);
      if (slips[place] ? rates[i] >= -none : excess[i] <= none) continue;
      slips[place] = !slips[place];
      done = false;
    }
    if (done) break;
  }
  return rates;
}

}  // namespace soft_robot_lab
