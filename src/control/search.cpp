#include "control/search.h"

#include <sstream>

#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

std::string describe(const ReachProblem& problem, const Eigen::VectorXd& commands) {
  std::ostringstream text;
  for (Eigen::Index i = 0; i < commands.size(); ++i) text << (i ? ", " : "") << problem.names[i] << " " << commands[i];
  return text.str();
}

}  // namespace

Search::Search(const ReachProblem& problem, const ProgressCallback& progress, bool with_jacobian)
    : problem_(problem), progress_(progress), with_jacobian_(with_jacobian) {}

const Evaluation* Search::evaluate(const Eigen::VectorXd& commands) {
  if (last_ && last_->commands == commands) return &*last_;
  Evaluation now;
  now.commands = commands;
  ++evaluations_;
  failure_.clear();
  try {
    now.marker_m = problem_.marker(commands, with_jacobian_ ? &now.jacobian : nullptr);
    const bool sized = !with_jacobian_ || now.jacobian.cols() == commands.size();
    if (!sized || !now.marker_m.allFinite() || !now.jacobian.allFinite()) {
      throw ForwardModelError("the model's answer is not finite, or of the wrong size");
    }
  } catch (const ForwardModelError& error) {
    failure_ = "no equilibrium at " + describe(problem_, commands) + ": " + error.what();
    return nullptr;
  }
  now.distance_m = (problem_.target_m - now.marker_m).norm();
  if (!best_ || now.distance_m < best_->distance_m) best_ = now;
  last_ = std::move(now);
  return &*last_;
}

bool Search::finish_iteration(const Eigen::VectorXd& commands, double distance_m) {
  ++iterations_;
  return !progress_ || progress_({iterations_, distance_m, commands});
}

}  // namespace soft_robot_lab
