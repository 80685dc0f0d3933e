// SPDX-License-Identifier: BSD-3-Clause
#include "multiplier_problem.h"
#include "mechanics/solver_constants.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace soft_robot_lab {
namespace {

// Which equation each multiplier and each flow obeys.
struct Statuses {
  std::vector<char> held;  // per constraint: the multiplier stays where it is
  std::vector<int> slip;   // per contact: 1, -1, 0 for sticking
};

// y and q of an assumed status: one linear system.
Multipliers solve_status(const MultiplierProblem& problem, const Statuses& status, const Eigen::VectorXd& bounds) {
  const int constraints = static_cast<int>(problem.laws.size()),
            friction_contacts = static_cast<int>(problem.friction_contacts.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(constraints + friction_contacts, constraints + friction_contacts);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(constraints + friction_contacts);
  for (int i = 0; i < constraints; ++i) {
    if (status.held[i]) {
      matrix(i, i) = 1.0;
      right[i] = bounds[i];
    } else {
      matrix.row(i).head(constraints) = problem.delassus.row(i);
      right[i] = problem.excess[i];
    }
  }
  for (int j = 0; j < friction_contacts; ++j) {
    const auto& [first, second, ratio] = problem.friction_contacts[j];
    const int row = constraints + j;
    if (!status.held[first]) matrix(first, row) += 1.0;
    if (!status.held[second]) matrix(second, row) -= 1.0;
    if (status.slip[j] == 0 || (status.held[first] && status.held[second])) {
      matrix(row, row) = 1.0;
    } else {
      matrix(row, first) = status.slip[j] > 0 ? 1.0 : -ratio;
      matrix(row, second) = status.slip[j] > 0 ? -ratio : 1.0;
    }
  }
  const Eigen::VectorXd solved = matrix.partialPivLu().solve(right);
  return {solved.allFinite(), solved.head(constraints), solved.tail(friction_contacts)};
}

// What is wrong with a solution of an assumed status, largest first wins; all errors in N.
class Corrections {
 public:
  Corrections(Statuses& status, bool all) : status_(status), all_(all) {}
  void hold(int constraint, int held, double error) { consider({false, constraint, held, error}); }
  void slip(int contact, int direction, double error) { consider({true, contact, direction, error}); }
  bool apply() {
    if (!all_ && worst_.error > 0.0) change(worst_);
    return worst_.error > 0.0;
  }

 private:
  struct Change {
    bool of_junction;
    int index, value;
    double error;
  };
  void consider(const Change& found) {
    if (all_) change(found);
    if (found.error > worst_.error) worst_ = found;
  }
  void change(const Change& found) {
    if (found.of_junction) {
      status_.slip[found.index] = found.value;
    } else {
      status_.held[found.index] = static_cast<char>(found.value);
    }
  }
  Statuses& status_;
  bool all_;
  Change worst_{false, 0, 0, 0.0};
};

// Puts one status, or all that are wrong, right; false where none is.
bool correct(const MultiplierProblem& problem, const Multipliers& at, bool all, Statuses& status,
             Eigen::VectorXd& bounds) {
  const double force = constants::kSlack * at.y.cwiseAbs().maxCoeff();
  Corrections corrections(status, all);
  Eigen::VectorXd gap = problem.delassus * at.y - problem.excess;
  for (std::size_t j = 0; j < problem.friction_contacts.size(); ++j) {
    const auto& [first, second, ratio] = problem.friction_contacts[j];
    const double q = at.slips_m[static_cast<Eigen::Index>(j)];
    gap[first] += q;
    gap[second] -= q;
    const double per_length = 1.0 / std::max(problem.delassus(first, first), problem.delassus(second, second));
    const double up = at.y[first] - ratio * at.y[second], down = at.y[second] - ratio * at.y[first];
    const bool both_held = status.held[first] && status.held[second];
    const int slip = both_held ? 0 : status.slip[j], wanted = up > down ? 1 : -1;
    if (slip == 0 && std::max(up, down) > force) {
      corrections.slip(static_cast<int>(j), wanted, std::max(up, down));
      if (both_held) corrections.hold(wanted > 0 ? second : first, 0, 2.0 * std::max(up, down));
    }
    if (slip * q * per_length < -force) corrections.slip(static_cast<int>(j), 0, -slip * q * per_length);
  }
  for (int i = 0; i < static_cast<int>(problem.laws.size()); ++i) {
    const ConstraintLaw& law = problem.laws[i];
    if (law.prescribed()) continue;
    const double y = at.y[i], stiffness = 1.0 / problem.delassus(i, i);
    if (!status.held[i]) {
      const double bound = std::clamp(y, law.min_multiplier, law.max_multiplier);
      if (std::abs(y - bound) <= force) continue;
      bounds[i] = bound;
      corrections.hold(i, 1, std::abs(y - bound));
    } else {
      const double wish = (y <= law.min_multiplier ? -gap[i] : gap[i]) * stiffness;
      if (wish > force) corrections.hold(i, 0, wish);
    }
  }
  return corrections.apply();
}

// A problem with bounds, of which some multipliers are held and the others open.
struct BoundedProblem {
  const Eigen::MatrixXd& s;
  const Eigen::VectorXd& b;
  const std::vector<ConstraintLaw>& laws;
  std::vector<char> held;
  Eigen::VectorXd y;
};

std::vector<int> open_ones(const BoundedProblem& problem) {
  std::vector<int> open;
  for (int i = 0; i < static_cast<int>(problem.held.size()); ++i)
    if (!problem.held[i]) open.push_back(i);
  return open;
}

Eigen::VectorXd solve_open(const BoundedProblem& problem, const std::vector<int>& open) {
  const int size = static_cast<int>(open.size()), count = static_cast<int>(problem.b.size());
  Eigen::MatrixXd sub(size, size);
  Eigen::VectorXd right(size);
  for (int i = 0; i < size; ++i) {
    right[i] = problem.b[open[i]];
    for (int k = 0; k < count; ++k)
      if (problem.held[k]) right[i] -= problem.s(open[i], k) * problem.y[k];
    for (int j = 0; j < size; ++j) sub(i, j) = problem.s(open[i], open[j]);
  }
  return size > 0 ? Eigen::VectorXd(sub.ldlt().solve(right)) : right;
}

// Moves the open ones there, within their bounds; which went beyond by most, or -1.
int worst_beyond(BoundedProblem& problem, const std::vector<int>& open, const Eigen::VectorXd& solved) {
  int worst = -1;
  double worst_by = 0.0;
  for (int i = 0; i < static_cast<int>(open.size()); ++i) {
    const ConstraintLaw& law = problem.laws[open[i]];
    const double beyond = std::max(law.min_multiplier - solved[i], solved[i] - law.max_multiplier);
    problem.y[open[i]] = std::clamp(solved[i], law.min_multiplier, law.max_multiplier);
    if (beyond > worst_by) {
      worst_by = beyond;
      worst = open[i];
    }
  }
  return worst;
}

// A held multiplier whose constraint would rather pull away from its bound, or -1.
int held_in_vain(const BoundedProblem& problem) {
  int found = -1;
  for (int i = 0; i < static_cast<int>(problem.b.size()); ++i) {
    const ConstraintLaw& law = problem.laws[i];
    if (!problem.held[i] || law.prescribed()) continue;
    const double pull = problem.b[i] - problem.s.row(i).dot(problem.y), small = 1e-12 * std::abs(problem.b[i]);
    if (problem.y[i] <= law.min_multiplier ? pull > small : pull < -small) found = i;
  }
  return found;
}

}  // namespace

// Solves S y = b with y between bounds, S positive definite: an active set that adds one constraint at a time (Nocedal
// & Wright 2006, 16.5, for the dual of a cable that can only pull).
Eigen::VectorXd solve_bounded(const Eigen::MatrixXd& s, const Eigen::VectorXd& b,
                              const std::vector<ConstraintLaw>& laws) {
  const int count = static_cast<int>(b.size());
  BoundedProblem problem{s, b, laws, std::vector<char>(count, 0), Eigen::VectorXd::Zero(count)};
  for (int i = 0; i < count; ++i) {
    if (!laws[i].prescribed()) continue;
    problem.held[i] = 1;
    problem.y[i] = laws[i].min_multiplier;
  }
  for (int round = 0; round < 4 * count + 4; ++round) {
    const std::vector<int> open = open_ones(problem);
    if (const int worst = worst_beyond(problem, open, solve_open(problem, open)); worst >= 0) {
      problem.held[worst] = 1;
      continue;
    }
    const int release = held_in_vain(problem);
    if (release < 0) break;
    problem.held[release] = 0;
  }
  return problem.y;
}

double violation(const ConstraintLaw& law, double y) {
  if (law.prescribed()) return 0.0;
  const double mismatch = law.offset - law.compliance * y;
  if (y <= law.min_multiplier) return std::max(0.0, mismatch);
  if (y >= law.max_multiplier) return std::min(0.0, mismatch);
  return mismatch;
}

double relative_violation(const ConstraintLaw& law, double y, double value) {
  return violation(law, y) / std::max(std::abs(value), 1e-300);
}

bool active(const ConstraintLaw& law, double y) { return y > law.min_multiplier && y < law.max_multiplier; }

int slipping(const FrictionContactBound& contact, const Eigen::VectorXd& y) {
  const double first = y[contact.first], second = y[contact.second];
  if (first >= (1.0 - constants::kOnBound) * contact.ratio * second) return 1;
  return second >= (1.0 - constants::kOnBound) * contact.ratio * first ? -1 : 0;
}

std::vector<int> slipping_groups(const MultiplierProblem& problem, const Eigen::VectorXd& y) {
  std::vector<int> group(problem.laws.size());
  std::iota(group.begin(), group.end(), 0);
  for (const FrictionContactBound& contact : problem.friction_contacts) {
    if (slipping(contact, y) == 0) continue;
    const int joining = group[contact.second], joined = group[contact.first];  // copies: replace() changes the group
    std::replace(group.begin(), group.end(), joining, joined);
  }
  return group;
}

std::vector<ConstraintLaw> after_flows(std::vector<ConstraintLaw> laws,
                                       const std::vector<FrictionContactBound>& friction_contacts,
                                       const Eigen::VectorXd& slips_m) {
  for (std::size_t j = 0; j < friction_contacts.size(); ++j) {
    const double q = slips_m[static_cast<Eigen::Index>(j)];
    laws[friction_contacts[j].first].offset -= q;
    laws[friction_contacts[j].second].offset += q;
  }
  return laws;
}

double friction_violation(const FrictionContactBound& contact, const Eigen::VectorXd& y, double flow_m, double least_n,
                          double length_m) {
  const double first = y[contact.first], second = y[contact.second];
  const double larger = std::max({std::abs(first), std::abs(second), least_n});
  const double up = (first - contact.ratio * second) / larger, down = (second - contact.ratio * first) / larger;
  const double beyond = std::max({0.0, up, down});
  const double unearned = std::min(std::abs(flow_m) / length_m, std::abs(flow_m > 0.0 ? up : down));
  return std::max(beyond, unearned);
}

Multipliers solve_multipliers(const MultiplierProblem& problem, const Eigen::VectorXd& guess) {
  const auto count = static_cast<Eigen::Index>(problem.laws.size());
  if (problem.friction_contacts.empty())
    return {true, solve_bounded(problem.delassus, problem.excess, problem.laws), Eigen::VectorXd()};
  Statuses status{std::vector<char>(problem.laws.size(), 0), {}};
  Eigen::VectorXd bounds(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ConstraintLaw& law = problem.laws[static_cast<std::size_t>(i)];
    bounds[i] = std::clamp(guess[i], law.min_multiplier, law.max_multiplier);
    status.held[static_cast<std::size_t>(i)] = law.prescribed();
  }
  for (const FrictionContactBound& contact : problem.friction_contacts) status.slip.push_back(slipping(contact, guess));
  for (int round = 0; round < 3 * constants::kBlockRounds; ++round) {
    Multipliers at = solve_status(problem, status, bounds);
    if (!at.found) break;
    if (!correct(problem, at, round < constants::kBlockRounds, status, bounds)) return at;
  }
  return solve_by_lemke(problem);
}

}  // namespace soft_robot_lab
