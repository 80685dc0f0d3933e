// What every search method shares: evaluating the problem, remembering the best commands, telling the progress.
#pragma once

#include <optional>
#include <string>

#include "soft_robot_lab/control/optimiser.h"

namespace soft_robot_lab {

struct Evaluation {
  Eigen::VectorXd commands;
  Eigen::Vector3d marker_m;
  Eigen::Matrix3Xd jacobian;  // 3 x commands [m per command]; empty where none was asked for
  double distance_m = 0.0;    // from the target
  double objective_m2() const { return 0.5 * distance_m * distance_m; }
};

class Search {
 public:
  Search(const ReachProblem& problem, const ProgressCallback& progress);

  const ReachProblem& problem() const { return problem_; }

  // Null where the model found no equilibrium; failure() then says why. The last and the best success are remembered;
  // asking for one's Jacobian later starts from a solved equilibrium.
  const Evaluation* evaluate(const Eigen::VectorXd& commands, bool with_jacobian);

  // Counts an iteration that ended at `commands`; false when the caller cancels.
  bool finish_iteration(const Eigen::VectorXd& commands, double distance_m);

  const std::optional<Evaluation>& best() const { return best_; }
  const std::string& failure() const { return failure_; }  // of the last evaluation; empty when it succeeded
  int iterations() const { return iterations_; }
  int evaluations() const { return evaluations_; }

 private:
  const ReachProblem& problem_;
  const ProgressCallback& progress_;
  std::optional<Evaluation> last_;
  std::optional<Evaluation> best_;
  std::string failure_;
  int iterations_ = 0;
  int evaluations_ = 0;
};

// A method starts at problem().start, which has been evaluated, and returns why it stopped.
std::string search_gauss_newton(Search& search, int max_iterations, double tolerance_m);
std::string search_rmsprop(Search& search, int max_iterations);

inline constexpr const char* kConverged = "converged";
inline constexpr const char* kIterationLimit = "iteration limit";
inline constexpr const char* kCancelled = "cancelled";

}  // namespace soft_robot_lab
