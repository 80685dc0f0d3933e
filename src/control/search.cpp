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

Search::Search(const ReachProblem& problem, const ProgressCallback& progress)
    : problem_(problem), progress_(progress) {}

const Evaluation* Search::evaluate(const Eigen::VectorXd& commands, bool with_jacobian) {
  bool known = false;
  for (const auto* remembered : {&last_, &best_}) {
    if (!*remembered || (*remembered)->commands != commands) continue;
    if (!with_jacobian || (*remembered)->jacobian.cols() > 0) return &**remembered;
    known = true;
  }
  Evaluation now;
  now.commands = commands;
  if (!known) ++evaluations_;
  failure_.clear();
  try {
    now.marker_m = problem_.marker(commands, with_jacobian ? &now.jacobian : nullptr);
    const bool sized = !with_jacobian || now.jacobian.cols() == commands.size();
    if (!sized || !now.marker_m.allFinite() || !now.jacobian.allFinite()) {
      throw ForwardModelError("the model's answer is not finite, or of the wrong size");
    }
  } catch (const ForwardModelError& error) {
    failure_ = "no equilibrium at " + describe(problem_, commands) + ": " + error.what();
    return nullptr;
  }
  now.distance_m = (problem_.target_m - now.marker_m).norm();
  if (!best_ || best_->commands == commands || now.distance_m < best_->distance_m) best_ = now;
  last_ = std::move(now);
  return &*last_;
}

bool Search::finish_iteration(const Eigen::VectorXd& commands, double distance_m) {
  ++iterations_;
  return !progress_ || progress_({iterations_, distance_m, commands});
}

}  // namespace soft_robot_lab
