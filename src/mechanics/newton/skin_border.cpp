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

std::vector<SkinGradient> NewtonSolver::without_column(const std::vector<ContactTouch>& touches) const {
  std::vector<SkinGradient> missing;
  for (const ContactTouch& touch : touches) {
    SkinGradient gradient = released_gradient(touch);
    if (!find_column(skin_columns_, gradient)) missing.push_back(std::move(gradient));
  }
  return missing;
}

Eigen::MatrixXd NewtonSolver::solve_with(Eigen::MatrixXd loads, std::vector<SkinGradient> missing) {
  const Eigen::Index own = loads.cols(), more = static_cast<Eigen::Index>(missing.size());
  if (more == 0) return solve(loads);
  loads.conservativeResize(3 * layout_.node_count, own + more);
  loads.rightCols(more).setZero();
  for (Eigen::Index k = 0; k < more; ++k) {
    const SkinGradient& gradient = missing[static_cast<std::size_t>(k)];
    for (std::size_t a = 0; a < gradient.nodes.size(); ++a)
      loads.col(own + k).segment<3>(3 * gradient.nodes[a]) += gradient.at_nodes.col(static_cast<Eigen::Index>(a));
  }
  const Eigen::MatrixXd solved = solve(loads);
  for (Eigen::Index k = 0; k < more; ++k)
    keep_column(std::make_shared<const SkinColumn>(
                    SkinColumn{std::move(missing[static_cast<std::size_t>(k)]), solved.col(own + k)}),
                skin_columns_);
  return solved.leftCols(own);
}

SkinColumns NewtonSolver::columns_of(const std::vector<ContactTouch>& touches) {
  if (touches.empty()) return {};
  std::vector<SkinGradient> missing = without_column(touches);
  const bool any_missing = !missing.empty();
  if (any_missing) solve_with(Eigen::MatrixXd(3 * layout_.node_count, 0), std::move(missing));
  SkinColumns found;
  for (const ContactTouch& touch : touches) found.push_back(find_column(skin_columns_, released_gradient(touch)));
  if (any_missing && skin_columns_.size() > 4 * kMostInBorder) skin_columns_ = found;
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
