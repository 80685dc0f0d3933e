// Levenberg-Marquardt in a trust region with bounds (Ceres), on the residual target - marker and its exact Jacobian.
#include "control/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <ceres/ceres.h>

namespace soft_robot_lab {
namespace {

// Beside a target out of reach the steps shrink by a constant factor each, about two on a bending robot: stopping at
// the tolerance itself would leave about as much again to gain.
constexpr double kSettled = 0.1;

// The first step is damped by 1 / radius of each column's own weight. Two cables that pull against each other have
// almost opposite columns: an undamped step throws both to their limits, where the way back leads along the slack
// cable's kink.
constexpr double kFirstRadius = 0.5;

// Residual (target - marker) / tolerance: dimensionless, so that Ceres' own small constants mean the same for any
// robot. Each command is a parameter block of its own, so that single ones can be held.
class ReachCost : public ceres::CostFunction {
 public:
  ReachCost(Search& search, double tolerance_m) : search_(search), tolerance_m_(tolerance_m) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->assign(search.problem().start.size(), 1);
  }

  // False, where there is no equilibrium, makes Ceres take the step back and shrink the trust region.
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::VectorXd commands(search_.problem().start.size());
    for (Eigen::Index i = 0; i < commands.size(); ++i) commands[i] = *parameters[i];
    const Evaluation* here = search_.evaluate(commands, jacobians != nullptr);
    if (!here) return false;
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = (search_.problem().target_m - here->marker_m) / tolerance_m_;
    for (Eigen::Index i = 0; jacobians && i < commands.size(); ++i) {
      if (jacobians[i]) Eigen::Map<Eigen::Vector3d>(jacobians[i], 3) = -here->jacobian.col(i) / tolerance_m_;
    }
    return true;
  }

 private:
  Search& search_;
  double tolerance_m_;
};

// Tells the progress, and stops once a step changes the distance by far less than the tolerance, or the target is
// reached.
class Watch : public ceres::IterationCallback {
 public:
  Watch(Search& search, const Eigen::VectorXd& commands, double tolerance_m)
      : search_(search), commands_(commands), tolerance_m_(tolerance_m) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const double distance_m = std::sqrt(2.0 * summary.cost) * tolerance_m_;
    const bool settled = summary.step_is_successful && std::abs(distance_m_ - distance_m) < kSettled * tolerance_m_;
    const bool first = summary.iteration == 0;
    distance_m_ = distance_m;
    if (!first && !search_.finish_iteration(commands_, distance_m)) return ceres::SOLVER_ABORT;
    if (distance_m < tolerance_m_ || (settled && !first)) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    return ceres::SOLVER_CONTINUE;
  }

 private:
  Search& search_;
  const Eigen::VectorXd& commands_;
  double tolerance_m_;
  double distance_m_ = 0.0;
};

ceres::Solver::Options solver_options(int max_iterations) {
  ceres::Solver::Options options;
  options.max_num_iterations = max_iterations;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;  // Watch reads the commands
  options.function_tolerance = 0.0;             // Watch decides
  options.parameter_tolerance = 1.0e-10;
  options.line_search_interpolation_type = ceres::QUADRATIC;  // CUBIC would want the Jacobian of every trial
  options.initial_trust_region_radius = kFirstRadius;
  options.num_threads = 1;
  return options;
}

// The commands at a limit beyond which the target lies.
std::vector<bool> blocked_commands(const ReachProblem& problem, const Evaluation& here) {
  const Eigen::VectorXd downhill = here.jacobian.transpose() * (problem.target_m - here.marker_m);
  std::vector<bool> blocked(downhill.size());
  for (Eigen::Index i = 0; i < downhill.size(); ++i) {
    blocked[i] = (downhill[i] <= 0.0 && here.commands[i] <= problem.min[i]) ||
                 (downhill[i] >= 0.0 && here.commands[i] >= problem.max[i]);
  }
  return blocked;
}

// Moves the commands that are not held; returns why it stopped.
std::string solve_free_commands(Search& search, const std::vector<bool>& held, int max_iterations, double tolerance_m,
                                Eigen::VectorXd& commands) {
  std::vector<double*> blocks;
  for (Eigen::Index i = 0; i < commands.size(); ++i) blocks.push_back(&commands[i]);
  ceres::Problem problem;
  problem.AddResidualBlock(new ReachCost(search, tolerance_m), nullptr, blocks);
  for (size_t i = 0; i < blocks.size(); ++i) {
    problem.SetParameterLowerBound(blocks[i], 0, search.problem().min[static_cast<Eigen::Index>(i)]);
    problem.SetParameterUpperBound(blocks[i], 0, search.problem().max[static_cast<Eigen::Index>(i)]);
    if (held[i]) problem.SetParameterBlockConstant(blocks[i]);
  }
  Watch watch(search, commands, tolerance_m);
  ceres::Solver::Options options = solver_options(max_iterations);
  options.callbacks.push_back(&watch);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type == ceres::USER_FAILURE) return kCancelled;
  if (summary.termination_type == ceres::NO_CONVERGENCE) return kIterationLimit;
  if (!search.failure().empty()) return search.failure();
  return summary.IsSolutionUsable() ? kConverged : summary.message;
}

// Ceres projects its steps on the bounds, which creeps where one command is at a limit and another has to make up for
// it. So the blocked commands are held while the others move, until nothing is to be held or freed any more.
std::string descend(Search& search, int max_iterations, double tolerance_m, Eigen::VectorXd& commands) {
  std::vector<bool> held;
  double distance_m = std::numeric_limits<double>::infinity();
  for (;;) {
    const Evaluation* here = search.evaluate(commands, true);
    if (!here) return search.failure();
    const std::vector<bool> blocked = blocked_commands(search.problem(), *here);
    const bool all_blocked = std::find(blocked.begin(), blocked.end(), false) == blocked.end();
    if (all_blocked || blocked == held || distance_m - here->distance_m < tolerance_m) return kConverged;
    if (search.iterations() == max_iterations) return kIterationLimit;
    held = blocked;
    distance_m = here->distance_m;
    const std::string reason =
        solve_free_commands(search, held, max_iterations - search.iterations(), tolerance_m, commands);
    if (reason != kConverged) return reason;
  }
}

bool idle(const Evaluation& here, Eigen::Index command) { return here.jacobian.col(command).isZero(0.0); }

// Moves a command that is idle at `rest`, further and further to either side, until the marker answers; true where that
// way leads nearer, otherwise the command is as it was. The marker stays at rest up to the point where the command
// begins to act, so that the rest's distance from the target is the one to compare with.
bool wake(Search& search, const Evaluation& rest, Eigen::Index command, Eigen::VectorXd& commands) {
  const ReachProblem& problem = search.problem();
  const double from = commands[command];
  for (const double share : {1.0 / 64.0, 1.0 / 16.0, 1.0 / 4.0, 1.0}) {
    for (const double limit : {problem.min[command], problem.max[command]}) {
      if (limit == from) continue;
      commands[command] = from + share * (limit - from);
      const Evaluation* here = search.evaluate(commands, true);
      if (!here || idle(*here, command)) continue;
      const double along = here->jacobian.col(command).dot(problem.target_m - rest.marker_m) * (limit - from);
      if (along <= 0.0) commands[command] = from;
      return along > 0.0;
    }
  }
  commands[command] = from;
  return false;
}

}  // namespace

// The command of a slack cable has no derivative, nor has one at its rest length, though the way to the target may lead
// over pulling it. So a descent is followed by another from where such commands do something, as long as that promises
// to come nearer, and does.
std::string search_gauss_newton(Search& search, int max_iterations, double tolerance_m) {
  Eigen::VectorXd commands = search.problem().start;
  double distance_m = std::numeric_limits<double>::infinity();
  for (;;) {
    const std::string reason = descend(search, max_iterations, tolerance_m, commands);
    const Evaluation* found = search.evaluate(search.best()->commands, true);
    if (!found) return search.failure();
    const Evaluation best = *found;
    const bool nearer = distance_m - best.distance_m >= tolerance_m;
    if (reason != kConverged || best.distance_m < tolerance_m || !nearer) return reason;
    distance_m = best.distance_m;
    commands = best.commands;
    bool woken = false;
    for (Eigen::Index i = 0; i < commands.size(); ++i)
      woken = (idle(best, i) && wake(search, best, i, commands)) || woken;
    if (!woken) return reason;
  }
}

}  // namespace soft_robot_lab
