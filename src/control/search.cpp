// SPDX-License-Identifier: BSD-3-Clause
#include "search.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

std::string describe(const ReachProblem& problem, const Eigen::VectorXd& commands) {
  std::ostringstream text;
  for (Eigen::Index i = 0; i < commands.size(); ++i) text << (i ? ", " : "") << problem.names[i] << " " << commands[i];
  return text.str();
}

bool usable(const Prediction& answer, const ReachProblem& problem, bool with_derivatives) {
  const Eigen::Index goals = static_cast<Eigen::Index>(problem.goals.size()), count = problem.start.size();
  if (answer.markers_m.cols() != goals || !answer.markers_m.allFinite() || !answer.tensions_n.allFinite()) return false;
  if (problem.max_tension_n.size() > 0 && answer.tensions_n.size() != count) return false;
  if (!with_derivatives) return true;
  if (answer.marker_jacobian.rows() != 3 * goals || answer.marker_jacobian.cols() != count) return false;
  if (problem.max_tension_n.size() > 0 && answer.tension_jacobian.rows() != count) return false;
  return answer.marker_jacobian.allFinite() && answer.tension_jacobian.allFinite();
}

}  // namespace

Search::Search(const ReachProblem& problem, const ProgressCallback& progress)
    : problem_(problem), progress_(progress), shares_(static_cast<Eigen::Index>(problem.goals.size())) {
  for (Eigen::Index i = 0; i < shares_.size(); ++i) shares_[i] = problem.goals[static_cast<size_t>(i)].weight;
  shares_ = (shares_ / shares_.sum()).cwiseSqrt();
}

// Fills in what follows from the prediction.
void Search::judge(Evaluation& here) const {
  const Eigen::Index goals = shares_.size(), count = here.commands.size();
  const bool effort = problem_.effort_m > 0.0, tension = problem_.max_tension_n.size() > 0;
  const bool derivatives = here.prediction.marker_jacobian.size() > 0;
  const Eigen::Index rows = 3 * goals + (effort ? count : 0) + (tension ? count : 0);
  here.residuals = Eigen::VectorXd::Zero(rows);
  if (derivatives) here.jacobian = Eigen::MatrixXd::Zero(rows, count);
  for (Eigen::Index k = 0; k < goals; ++k) {
    const Eigen::Vector3d& target_m = problem_.goals[static_cast<size_t>(k)].target_m;
    here.residuals.segment<3>(3 * k) = shares_[k] * (target_m - here.prediction.markers_m.col(k));
    if (derivatives)
      here.jacobian.middleRows<3>(3 * k) = -shares_[k] * here.prediction.marker_jacobian.middleRows<3>(3 * k);
  }
  here.distance_m = here.residuals.head(3 * goals).norm();
  Eigen::Index row = 3 * goals;
  if (effort) {
    here.residuals.segment(row, count) = problem_.effort_m * (here.commands - problem_.rest);
    if (derivatives) here.jacobian.middleRows(row, count).diagonal().setConstant(problem_.effort_m);
    row += count;
  }
  for (Eigen::Index i = 0; tension && i < count; ++i) {
    const double limit_n = problem_.max_tension_n[i], tension_n = here.prediction.tensions_n[i];
    if (tension_n > limit_n) here.allowed = false;
    if (!(tension_n > (1.0 - kTensionBand) * limit_n)) continue;
    const double price_m_n = kTensionPrice_m / (kTensionBand * limit_n);
    here.residuals[row + i] = price_m_n * (tension_n - (1.0 - kTensionBand) * limit_n);
    if (derivatives) here.jacobian.row(row + i) = price_m_n * here.prediction.tension_jacobian.row(i);
  }
}

const Evaluation* Search::evaluate(const Eigen::VectorXd& commands, bool with_jacobian) {
  return ask(commands, with_jacobian, false);
}

const Evaluation* Search::try_out(const Eigen::VectorXd& commands, bool with_jacobian) {
  return ask(commands, with_jacobian, static_cast<bool>(problem_.trial));
}

const Evaluation* Search::ask(const Eigen::VectorXd& commands, bool with_jacobian, bool trial) {
  bool known = false;
  for (const auto* remembered : {&last_, &best_}) {
    if (!*remembered || (*remembered)->commands != commands) continue;
    failure_.clear();
    if ((!with_jacobian || (*remembered)->jacobian.size() > 0) && (trial || !(*remembered)->rough))
      return &**remembered;
    known = true;
  }
  Evaluation now;
  now.commands = commands;
  now.rough = trial;
  if (!known) ++evaluations_;
  failure_.clear();
  try {
    now.prediction = (trial ? problem_.trial : problem_.model)(commands, with_jacobian);
    if (!usable(now.prediction, problem_, with_jacobian))
      throw ForwardModelError("the model's answer is not finite, or of the wrong size");
  } catch (const ForwardModelError& error) {
    failure_ = "no equilibrium at " + describe(problem_, commands) + ": " + error.what();
    return nullptr;
  }
  judge(now);
  const bool better = now.allowed && (!best_ || now.objective_m2() < best_->objective_m2());
  if (better || (best_ && best_->commands == commands)) best_ = now;
  last_ = std::move(now);
  return &*last_;
}

const Evaluation* Search::approach(const Eigen::VectorXd& from, const Eigen::VectorXd& to, bool with_jacobian) {
  constexpr int halvings = 8;
  Eigen::VectorXd there = to;
  for (int i = 0; i < halvings; ++i) {
    const Evaluation* found = evaluate(there, with_jacobian);
    if (!found || found->allowed) return found;
    there = 0.5 * (from + there);
  }
  return evaluate(from, with_jacobian);
}

bool Search::finish_iteration(const Eigen::VectorXd& commands, double distance_m) {
  ++iterations_;
  return !progress_ || progress_({iterations_, distance_m, commands});
}

Eigen::VectorXd difference_probe(const ReachProblem& problem, const Eigen::VectorXd& commands, Eigen::Index moved) {
  Eigen::VectorXd probe = commands;
  probe[moved] -= kDifference;
  if (probe[moved] < problem.min[moved]) probe[moved] = std::min(commands[moved] + kDifference, problem.max[moved]);
  return probe;
}

}  // namespace soft_robot_lab
