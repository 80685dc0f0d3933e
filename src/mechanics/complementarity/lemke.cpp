// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "multiplier_problem.h"

namespace soft_robot_lab {
namespace {

// w = M z + q with w, z >= 0 and w'z = 0. Complementary pivoting with the covering vector of ones (Lemke 1965); empty
// where it ends on a ray.
Eigen::VectorXd lemke(const Eigen::MatrixXd& m, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size(), artificial = 2 * n;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
  if (n == 0 || q.minCoeff() >= 0.0) return z;
  // Columns: w, z, artificial, right side. Basis: one variable per row.
  Eigen::MatrixXd table(n, 2 * n + 2);
  table << Eigen::MatrixXd::Identity(n, n), -m, Eigen::VectorXd::Constant(n, -1.0), q;
  std::vector<Eigen::Index> basis(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) basis[static_cast<std::size_t>(i)] = i;
  Eigen::Index row = 0, entering = artificial;
  q.minCoeff(&row);
  for (Eigen::Index pivots = 0; pivots < 50 * n; ++pivots) {
    const Eigen::Index leaving = basis[static_cast<std::size_t>(row)];
    table.row(row) /= table(row, entering);
    for (Eigen::Index i = 0; i < n; ++i)
      if (i != row && table(i, entering) != 0.0) table.row(i) -= table(i, entering) * table.row(row);
    basis[static_cast<std::size_t>(row)] = entering;
    if (leaving == artificial) {
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index variable = basis[static_cast<std::size_t>(i)];
        if (variable >= n) z[variable - n] = std::max(0.0, table(i, 2 * n + 1));
      }
      return z;
    }
    entering = leaving < n ? leaving + n : leaving - n;
    double least = std::numeric_limits<double>::infinity();
    row = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (table(i, entering) <= 1e-11) continue;
      const double ratio = table(i, 2 * n + 1) / table(i, entering);
      // Of equal ratios the artificial variable leaves, so that the method ends.
      const bool last = basis[static_cast<std::size_t>(i)] == artificial;
      if (ratio < least - 1e-13 || (last && ratio <= least + 1e-13)) {
        least = ratio;
        row = i;
      }
    }
    if (row < 0) return {};
  }
  return {};
}

// The complementarity problem in z: each bounded multiplier's distance from its bound, a pressure on the far bound of
// those that have two, and each contact's flow to either side. Lengths count per mean delassus, so that all is in N.
class Complementarity {
 public:
  explicit Complementarity(const MultiplierProblem& problem) : p_(problem) {
    scale_ = p_.delassus.diagonal().cwiseAbs().mean();
    for (int i = 0; i < static_cast<int>(p_.laws.size()); ++i) {
      const ConstraintLaw& law = p_.laws[static_cast<std::size_t>(i)];
      if (law.prescribed()) continue;
      const bool below = std::isfinite(law.min_multiplier), above = std::isfinite(law.max_multiplier);
      if (!below && !above) {
        free_.push_back(i);
        continue;
      }
      bounded_.push_back({i, below ? 1.0 : -1.0, below ? law.min_multiplier : law.max_multiplier});
      if (below && above) two_sided_.push_back({bounded_.size() - 1, law.max_multiplier - law.min_multiplier});
    }
    Eigen::MatrixXd sub(free_.size(), free_.size());
    for (Eigen::Index i = 0; i < sub.rows(); ++i)
      for (Eigen::Index j = 0; j < sub.cols(); ++j) sub(i, j) = p_.delassus(free_[i], free_[j]);
    free_softness_.compute(sub);
  }

  Eigen::Index size() const {
    return static_cast<Eigen::Index>(bounded_.size() + two_sided_.size() + 2 * p_.friction_contacts.size());
  }

  Multipliers at(const Eigen::VectorXd& z) const {
    const auto count = static_cast<Eigen::Index>(p_.friction_contacts.size());
    Multipliers result{true, Eigen::VectorXd::Zero(p_.excess.size()), {}};
    result.slips_m = scale_ * (z.segment(z.size() - 2 * count, count) - z.tail(count));
    for (Eigen::Index i = 0; i < result.y.size(); ++i)
      if (p_.laws[static_cast<std::size_t>(i)].prescribed())
        result.y[i] = p_.laws[static_cast<std::size_t>(i)].min_multiplier;
    for (std::size_t k = 0; k < bounded_.size(); ++k)
      result.y[bounded_[k].index] = bounded_[k].bound + bounded_[k].sign * z[static_cast<Eigen::Index>(k)];
    if (free_.empty()) return result;
    const Eigen::VectorXd gap = gaps(result);
    Eigen::VectorXd right(free_.size());
    for (Eigen::Index i = 0; i < right.size(); ++i) right[i] = -gap[free_[i]];
    const Eigen::VectorXd y = free_softness_.solve(right);
    for (Eigen::Index i = 0; i < right.size(); ++i) result.y[free_[i]] = y[i];
    return result;
  }

  // w of z.
  Eigen::VectorXd complement(const Eigen::VectorXd& z) const {
    const Multipliers here = at(z);
    const Eigen::VectorXd gap = gaps(here) / scale_;
    Eigen::VectorXd w(z.size());
    Eigen::Index next = 0;
    for (const Bounded& item : bounded_) w[next++] = item.sign * gap[item.index];
    for (const TwoSided& item : two_sided_) {
      w[static_cast<Eigen::Index>(item.place)] += z[next];
      w[next++] = item.range - z[static_cast<Eigen::Index>(item.place)];
    }
    for (const auto& [first, second, ratio] : p_.friction_contacts) w[next++] = ratio * here.y[second] - here.y[first];
    for (const auto& [first, second, ratio] : p_.friction_contacts) w[next++] = ratio * here.y[first] - here.y[second];
    return w;
  }

 private:
  struct Bounded {
    int index;
    double sign, bound;
  };
  struct TwoSided {
    std::size_t place;
    double range;
  };

  Eigen::VectorXd gaps(const Multipliers& here) const {
    Eigen::VectorXd gap = p_.delassus * here.y - p_.excess;
    for (std::size_t j = 0; j < p_.friction_contacts.size(); ++j) {
      gap[p_.friction_contacts[j].first] += here.slips_m[static_cast<Eigen::Index>(j)];
      gap[p_.friction_contacts[j].second] -= here.slips_m[static_cast<Eigen::Index>(j)];
    }
    return gap;
  }

  const MultiplierProblem& p_;
  double scale_;
  std::vector<int> free_;
  std::vector<Bounded> bounded_;
  std::vector<TwoSided> two_sided_;
  Eigen::PartialPivLU<Eigen::MatrixXd> free_softness_;
};

}  // namespace

Multipliers solve_by_lemke(const MultiplierProblem& problem) {
  const Complementarity complementarity(problem);
  const Eigen::Index size = complementarity.size();
  const Eigen::VectorXd q = complementarity.complement(Eigen::VectorXd::Zero(size));
  Eigen::MatrixXd m(size, size);
  for (Eigen::Index i = 0; i < size; ++i) m.col(i) = complementarity.complement(Eigen::VectorXd::Unit(size, i)) - q;
  const Eigen::VectorXd z = lemke(m, q);
  if (z.size() != size || !z.allFinite()) return {};
  return complementarity.at(z);
}

}  // namespace soft_robot_lab
