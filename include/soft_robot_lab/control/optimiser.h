// Finds the actuation that brings a marker to a target: 1/2 |target - marker(commands)|^2 over bounded commands.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// A bounded reach problem. `marker` returns the marker's equilibrium position [m] for commands, and, where `jacobian`
// is given, its derivative (3 x commands). It throws ForwardModelError where no equilibrium was found.
struct ReachProblem {
  std::function<Eigen::Vector3d(const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian)> marker;
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();
  Eigen::VectorXd start;  // commands, within the bounds
  Eigen::VectorXd min;
  Eigen::VectorXd max;
  std::vector<std::string> names;  // of the commands, for messages

  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

struct OptimiserOptions {
  std::string method = "gauss_newton";  // or rmsprop
  int max_iterations = 0;               // 0: the method's own (gauss_newton 50, rmsprop 1000)
  // The target counts as reached within it; gauss_newton stops when a step gains less than a tenth of it.
  double tolerance_m = 1.0e-5;
  void validate() const;
};

struct OptimisationProgress {
  int iteration = 0;
  double distance_m = 0.0;
  Eigen::VectorXd commands;
};
// Called after each iteration; returning false cancels.
using ProgressCallback = std::function<bool(const OptimisationProgress&)>;

struct OptimisationSummary {
  bool usable = false;       // commands are within the bounds and no worse than the start
  std::string stop_reason;   // "converged", "iteration limit", "cancelled", or what failed
  Eigen::VectorXd commands;  // the best found
  Eigen::Vector3d marker_m = Eigen::Vector3d::Zero();
  double initial_distance_m = 0.0;
  double final_distance_m = 0.0;
  int iterations = 0;
  int evaluations = 0;  // equilibria solved
  double cpu_s = 0.0;
  double wall_s = 0.0;
  std::vector<std::string> active_limits;  // "left at its minimum 0.7"
  bool target_reached = false;             // final distance below the tolerance
};

// Throws std::invalid_argument for a bad problem or option; a failing model ends the search and is told in stop_reason.
OptimisationSummary optimise(const ReachProblem& problem, const OptimiserOptions& options,
                             const ProgressCallback& progress = {});

}  // namespace soft_robot_lab
