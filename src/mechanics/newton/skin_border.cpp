// SPDX-License-Identifier: BSD-3-Clause
#include "skin_border.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

constexpr double kAlike = 0.1;  // of its length: how far a gradient may be from that of its column

bool alike(const SkinGradient& a, const SkinGradient& b) {
  return a.face == b.face && (a.at_nodes - b.at_nodes).squaredNorm() <= kAlike * kAlike * b.at_nodes.squaredNorm();
}

}  // namespace

std::shared_ptr<const SkinColumn> find_column(const SkinColumns& columns, const SkinGradient& gradient) {
  for (const auto& column : columns)
    if (column->gradient.pair == gradient.pair) return alike(gradient, column->gradient) ? column : nullptr;
  return nullptr;
}

void keep_column(std::shared_ptr<const SkinColumn> column, SkinColumns& columns) {
  const auto same = std::find_if(columns.begin(), columns.end(),
                                 [&](const auto& other) { return other->gradient.pair == column->gradient.pair; });
  if (same != columns.end())
    *same = std::move(column);
  else
    columns.push_back(std::move(column));
}

void add_skin(const SkinColumns& columns, const std::vector<ConstraintLaw>& laws, const Eigen::MatrixXd& own_solved,
              const Eigen::VectorXd& motion, const Eigen::VectorXd& multipliers, MultiplierProblem& problem) {
  const Eigen::Index own = own_solved.cols(), more = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd delassus = Eigen::MatrixXd::Zero(own + more, own + more);
  Eigen::VectorXd excess(own + more);
  for (Eigen::Index k = 0; k < more; ++k) {
    const SkinGradient& gradient = columns[static_cast<std::size_t>(k)]->gradient;
    for (Eigen::Index i = 0; i < own; ++i) delassus(own + k, i) = gradient.dot(&own_solved(0, i));
    for (Eigen::Index l = 0; l <= k; ++l)
      delassus(own + k, own + l) = gradient.dot(columns[static_cast<std::size_t>(l)]->solved.data());
    delassus.col(own + k).head(own + k) = delassus.row(own + k).head(own + k).transpose();
    excess[own + k] = gradient.dot(motion.data());
  }
  excess.tail(more) += delassus.bottomRows(more) * multipliers;
  if (own > 0) {
    excess.head(own) = problem.excess + delassus.topRightCorner(own, more) * multipliers.tail(more);
    delassus.topLeftCorner(own, own) = problem.delassus;
  }
  problem.delassus = std::move(delassus);
  problem.excess = std::move(excess);
  for (Eigen::Index k = 0; k < more; ++k) {
    const ConstraintLaw& law = laws[static_cast<std::size_t>(k)];
    problem.delassus(own + k, own + k) += law.compliance;
    problem.excess[own + k] += law.offset;
    problem.laws.push_back(law);
  }
}

}  // namespace soft_robot_lab
