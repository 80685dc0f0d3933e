// SPDX-License-Identifier: BSD-3-Clause
#include "skin_border.h"

#include <algorithm>

#include "newton_solver.h"

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

SkinGradient NewtonSolver::released_gradient(const ContactTouch& touch) const {
  SkinGradient gradient = contact_.skin().gradient(touch);
  for (std::size_t a = 0; a < gradient.nodes.size(); ++a) {
    const int node = gradient.nodes[a];
    auto at_node = gradient.at_nodes.col(static_cast<Eigen::Index>(a));
    at_node = body_.fixed().col(node).select(0.0, at_node).eval();
    if (turns_.cols() > 0) at_node = (turns_.middleCols<3>(3 * node).transpose() * at_node).eval();
  }
  return gradient;
}

SkinColumns NewtonSolver::columns_of(const std::vector<ContactTouch>& touches) {
  SkinColumns found;
  std::vector<SkinGradient> missing;
  for (const ContactTouch& touch : touches) {
    SkinGradient gradient = released_gradient(touch);
    found.push_back(find_column(skin_columns_, gradient));
    if (!found.back()) missing.push_back(std::move(gradient));
  }
  if (missing.empty()) return found;
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(3 * layout_.node_count, static_cast<Eigen::Index>(missing.size()));
  for (std::size_t k = 0; k < missing.size(); ++k)
    for (std::size_t a = 0; a < missing[k].nodes.size(); ++a)
      loads.col(static_cast<Eigen::Index>(k)).segment<3>(3 * missing[k].nodes[a]) +=
          missing[k].at_nodes.col(static_cast<Eigen::Index>(a));
  const Eigen::MatrixXd solved = solve(loads);
  std::size_t next = 0;
  for (auto& column : found) {
    if (column) continue;
    const auto k = static_cast<Eigen::Index>(next);
    column = std::make_shared<const SkinColumn>(SkinColumn{std::move(missing[next++]), solved.col(k)});
    keep_column(column, skin_columns_);
  }
  if (skin_columns_.size() > 4 * kMostInBorder) skin_columns_ = found;
  keep_skin_columns();
  return found;
}

// With the factor that they are of.
void NewtonSolver::keep_skin_columns() {
  if (!linearisation_ || linearisation_ != factorised_ || linearisation_->skin_columns == skin_columns_) return;
  auto kept = std::make_shared<Linearisation>(*linearisation_);
  kept->skin_columns = skin_columns_;
  linearisation_ = factorised_ = std::move(kept);
}

}  // namespace soft_robot_lab
