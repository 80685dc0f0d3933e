// SPDX-License-Identifier: BSD-3-Clause
// What every search method shares: evaluating the problem, remembering the best commands, reporting the progress.
#pragma once

#include <optional>
#include <string>

#include "soft_robot_lab/control/optimiser.h"

namespace soft_robot_lab {

// Residuals, whose squares the objective halves and sums [m]: weighted target - marker, three rows a goal; effort; and
// what keeps tensions from their limits.
struct Evaluation {
  Eigen::VectorXd commands;
  Prediction prediction;
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;  // of the residuals; empty where no derivatives were asked for
  double distance_m = 0.0;   // markers from targets
  bool allowed = true;       // no tension is beyond its limit
  bool rough = false;        // by a model for trials
  double objective_m2() const { return 0.5 * residuals.squaredNorm(); }
};

// A tension is let into the last part of its limit at a price that grows to a distance's order of magnitude.
inline constexpr double kTensionBand = 0.02;    // of the limit
inline constexpr double kTensionPrice_m = 0.1;  // at the limit

class Search {
 public:
  Search(const ReachProblem& problem, const ProgressCallback& progress);

  const ReachProblem& problem() const { return problem_; }

  // Null where the model found no equilibrium; failure() then says why. The last and the best success are remembered;
  // asking for one's Jacobian later starts from a solved equilibrium.
  const Evaluation* evaluate(const Eigen::VectorXd& commands, bool with_jacobian);

  // The same by the problem's model for trials, where it has one: what it found may be rough, until it is evaluated.
  const Evaluation* try_out(const Eigen::VectorXd& commands, bool with_jacobian);

  // The same on the way to `to`, which is cut in halves until no tension is beyond its limit; null also where that
  // leads nowhere.
  const Evaluation* approach(const Eigen::VectorXd& from, const Eigen::VectorXd& to, bool with_jacobian);

  // Counts an iteration that ended at `commands`; false when the caller cancels.
  bool finish_iteration(const Eigen::VectorXd& commands, double distance_m);

  const std::optional<Evaluation>& best() const { return best_; }  // of what is allowed, by the objective
  const std::string& failure() const { return failure_; }          // of the last evaluation; empty when it succeeded
  int iterations() const { return iterations_; }
  int evaluations() const { return evaluations_; }

 private:
  const Evaluation* ask(const Eigen::VectorXd& commands, bool with_jacobian, bool trial);
  void judge(Evaluation& here) const;

  const ReachProblem& problem_;
  const ProgressCallback& progress_;
  Eigen::VectorXd shares_;  // square roots of the goals' weights, whose sum is 1
  std::optional<Evaluation> last_;
  std::optional<Evaluation> best_;
  std::string failure_;
  int iterations_ = 0;
  int evaluations_ = 0;
};

// A method starts at problem().start, which has been evaluated, and returns why it stopped.
std::string search_gauss_newton(Search& search, int max_iterations, double tolerance_m);
std::string search_rmsprop(Search& search, int max_iterations, double gradient_tolerance_m2);
std::string search_pid(Search& search, int max_iterations);
std::string search_pid_projected(Search& search, int max_iterations, double tolerance_m);
// `kind`: cma_es or differential_evolution; an iteration is a generation.
std::string search_by_population(Search& search, const std::string& kind, int max_iterations, int population,
                                 unsigned int seed, double tolerance_m);

inline constexpr double kDifference = 1.0e-3;  // [command], of methods that know no derivatives
// These commands with one of them moved by a difference: back, or forward where back would leave the bounds.
Eigen::VectorXd difference_probe(const ReachProblem& problem, const Eigen::VectorXd& commands, Eigen::Index moved);

inline constexpr const char* kConverged = "converged";
inline constexpr const char* kIterationLimit = "iteration limit";
inline constexpr const char* kCancelled = "cancelled";

}  // namespace soft_robot_lab
