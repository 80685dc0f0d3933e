// SPDX-License-Identifier: BSD-3-Clause
// Population methods, by pagmo2: CMA-ES and differential evolution on the objective over commands scaled to [0, 1].
#include <limits>

#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/types.hpp>

#include "search.h"

namespace soft_robot_lab {
namespace {

constexpr double kNoEquilibrium_m2 = 1.0e6;  // worse than any objective, and a number

// pagmo copies it freely; the search stays where it is.
struct CommandProblem {
  Search* search = nullptr;

  Eigen::VectorXd commands_at(const pagmo::vector_double& fraction) const {
    const ReachProblem& problem = search->problem();
    const Eigen::Map<const Eigen::VectorXd> fractions(fraction.data(), static_cast<Eigen::Index>(fraction.size()));
    const Eigen::VectorXd commands = problem.min + fractions.cwiseProduct(problem.max - problem.min);
    return commands.cwiseMax(problem.min).cwiseMin(problem.max);  // rounding may leave the bounds
  }
  pagmo::vector_double shares_of(const Eigen::VectorXd& commands) const {
    const ReachProblem& problem = search->problem();
    const Eigen::VectorXd fractions = (commands - problem.min).cwiseQuotient(problem.max - problem.min);
    return pagmo::vector_double(fractions.data(), fractions.data() + fractions.size());
  }

  pagmo::vector_double fitness(const pagmo::vector_double& fraction) const {
    const Evaluation* here = search->evaluate(commands_at(fraction), false);
    if (!here) return {kNoEquilibrium_m2};
    return {here->objective_m2() + (here->allowed ? 0.0 : 0.5 * kNoEquilibrium_m2)};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const size_t count = search ? search->problem().names.size() : 1;  // pagmo also makes one that is never asked
    return {pagmo::vector_double(count, 0.0), pagmo::vector_double(count, 1.0)};
  }
  pagmo::thread_safety get_thread_safety() const { return pagmo::thread_safety::none; }
};

// One generation at a time, so that it can be reported and cancelled; the first step size is a quarter of the range.
pagmo::algorithm make_method(const std::string& kind, unsigned int seed) {
  constexpr double own = -1.0, first_step = 0.25, precision = 1.0e-12;
  if (kind == "cma_es")
    return pagmo::algorithm(pagmo::cmaes(1u, own, own, own, own, first_step, precision, precision, true, true, seed));
  return pagmo::algorithm(pagmo::de(1u, 0.8, 0.9, 2u, precision, precision, seed));
}

// How far the population still spreads, as a share of the range.
double spread(const pagmo::population& members) {
  double widest = 0.0;
  for (size_t i = 0; i < members.get_x().front().size(); ++i) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const pagmo::vector_double& x : members.get_x()) {
      least = std::min(least, x[i]);
      most = std::max(most, x[i]);
    }
    widest = std::max(widest, most - least);
  }
  return widest;
}

}  // namespace

std::string search_by_population(Search& search, const std::string& kind, int max_iterations, int population,
                                 unsigned int seed, double tolerance_m) {
  constexpr double settled = 1.0e-6;
  const CommandProblem commands{&search};
  pagmo::population members(pagmo::problem(commands), 0u, seed);
  members.push_back(commands.shares_of(search.problem().start));
  while (members.size() < static_cast<size_t>(population)) members.push_back(members.random_decision_vector());
  const pagmo::algorithm method = make_method(kind, seed);
  for (int generation = 0; generation < max_iterations; ++generation) {
    members = method.evolve(members);
    const Evaluation& best = *search.best();
    if (!search.finish_iteration(best.commands, best.distance_m)) return kCancelled;
    if (best.distance_m < tolerance_m || spread(members) < settled) return kConverged;
  }
  return kIterationLimit;
}

}  // namespace soft_robot_lab
