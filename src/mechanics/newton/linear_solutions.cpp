// SPDX-License-Identifier: BSD-3-Clause
// Solutions with the last factor: exact ones, and those of skin that is a constraint of Newton's steps.
#include <algorithm>
#include <tuple>

#include "linear_system.h"
#include "mechanics/contact/contact_response.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {

LinearSystem::ExactMotions LinearSystem::exact_forces_n(const ExactMotions& motions) const {
  const Eigen::Index rows = motions.motions_m.rows(), free_rows = motions.free.rows();
  ExactMotions forces{Eigen::MatrixXd(rows, motions.motions_m.cols()), Eigen::MatrixXd(free_rows, motions.free.cols())};
  Eigen::Matrix3Xd all = Eigen::Matrix3Xd::Zero(3, tables_.layout.node_count + tables_.layout.point_count);
  for (Eigen::Index column = 0; column < motions.motions_m.cols(); ++column) {
    all.leftCols(tables_.layout.node_count) =
        Eigen::Map<const Eigen::Matrix3Xd>(motions.motions_m.col(column).data(), 3, tables_.layout.node_count);
    for (int point = 0; point < tables_.layout.point_count; ++point) {
      const auto& [nodes, weights] = std::tie(tables_.layout.ties[point], tables_.layout.tie_coefficients[point]);
      auto place = all.col(tables_.layout.node_count + point);
      place.setZero();
      for (std::size_t k = 0; k + 1 < nodes.size(); ++k) place += weights[k] * all.col(nodes[k]);
    }
    const Eigen::Matrix3Xd pulls_n = whole_matrix().multiply(all);
    Eigen::Matrix3Xd nodal_n = pulls_n.leftCols(tables_.layout.node_count);
    for (int point = 0; point < tables_.layout.point_count; ++point)
      for (std::size_t k = 0; k + 1 < tables_.layout.ties[point].size(); ++k)
        nodal_n.col(tables_.layout.ties[point][k]) +=
            tables_.layout.tie_coefficients[point][k] * pulls_n.col(tables_.layout.node_count + point);
    FreeColumns free = FreeColumns::Zero(3, free_rows / 3);
    add_turned_ties(energies_.contact, touching_.points, touching_.rigid, all.leftCols(tables_.layout.node_count),
                    motions.free.col(column).reshaped(3, free_rows / 3), nodal_n, free);
    tables_.release(nodal_n);
    forces.motions_m.col(column) = as_vector(nodal_n);
    forces.free.col(column) = free.reshaped();
  }
  return forces;
}

LinearSystem::ExactMotions LinearSystem::solve_exactly(const Eigen::MatrixXd& loads_n,
                                                       const Eigen::MatrixXd& free_loads) const {
  const bool free = !free_border_.empty();
  Eigen::MatrixXd on_free = free_loads;
  if (on_free.size() == 0) on_free.setZero(6 * (free ? energies_.contact.free().count() : 0), loads_n.cols());
  const auto solved = [&](const Eigen::MatrixXd& of_nodes, const Eigen::MatrixXd& of_free) {
    ExactMotions motions{solve(of_nodes), of_free};
    if (!free) return motions;
    motions.motions_m += free_border_.nodal_motions(of_free);
    motions.free = free_border_.motions(of_free, of_nodes);
    return motions;
  };
  ExactMotions motions = solved(loads_n, on_free);
  if (tables_.layout.point_count == 0 && !any_turns(touching_.points, touching_.rigid)) return motions;
  double left_before = loads_n.norm() + on_free.norm();
  Eigen::MatrixXd free_sum = on_free;
  for (int i = 0; i < constants::kRefinements; ++i) {
    const ExactMotions forces = exact_forces_n(motions);
    Eigen::MatrixXd left = loads_n - forces.motions_m;
    if (free) left -= free_border_.nodal_forces(motions.free);
    const Eigen::MatrixXd free_left = on_free - free_sum - forces.free;
    const double norm = left.norm() + free_left.norm();
    if (!(norm < left_before)) break;
    left_before = norm;
    const ExactMotions more = solved(left, free_left);
    motions.motions_m += more.motions_m;
    motions.free += more.free;
    free_sum += free_left;
  }
  return motions;
}

SkinGradient LinearSystem::released_gradient(const ContactTouch& touch) const {
  SkinGradient gradient = gradient_of(energies_.contact.skin(), touch);
  for (std::size_t a = 0; a < gradient.nodes.size(); ++a) {
    const int node = gradient.nodes[a];
    auto at_node = gradient.at_nodes.col(static_cast<Eigen::Index>(a));
    at_node = tables_.body.fixed().col(node).select(0.0, at_node).eval();
    if (turns_.cols() > 0) at_node = (turns_.middleCols<3>(3 * node).transpose() * at_node).eval();
  }
  return gradient;
}

std::vector<SkinGradient> LinearSystem::without_column(const std::vector<ContactTouch>& touches) const {
  std::vector<SkinGradient> missing;
  for (const ContactTouch& touch : touches) {
    SkinGradient gradient = released_gradient(touch);
    if (!find_column(skin_columns_, gradient)) missing.push_back(std::move(gradient));
  }
  return missing;
}

Eigen::MatrixXd LinearSystem::solve_and_keep(Eigen::MatrixXd loads, std::vector<SkinGradient> missing) {
  const Eigen::Index own = loads.cols(), more = static_cast<Eigen::Index>(missing.size());
  if (more == 0) return solve(loads);
  loads.conservativeResize(3 * tables_.layout.node_count, own + more);
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

Eigen::MatrixXd LinearSystem::solve_with(Eigen::MatrixXd loads, const std::vector<ContactTouch>& touches) {
  return solve_and_keep(std::move(loads), without_column(touches));
}

SkinColumns LinearSystem::columns_of(const std::vector<ContactTouch>& touches) {
  if (touches.empty()) return {};
  std::vector<SkinGradient> missing = without_column(touches);
  const bool any_missing = !missing.empty();
  if (any_missing) solve_and_keep(Eigen::MatrixXd(3 * tables_.layout.node_count, 0), std::move(missing));
  SkinColumns found;
  for (const ContactTouch& touch : touches) found.push_back(find_column(skin_columns_, released_gradient(touch)));
  if (any_missing && skin_columns_.size() > 4 * kMostInBorder) skin_columns_ = found;
  keep_skin_columns();
  return found;
}

// With the factor that they are of.
void LinearSystem::keep_skin_columns() {
  if (!linearisation_ || linearisation_ != factorised_ || linearisation_->skin_columns == skin_columns_) return;
  auto kept = std::make_shared<Linearisation>(*linearisation_);
  kept->skin_columns = skin_columns_;
  linearisation_ = factorised_ = std::move(kept);
}

}  // namespace soft_robot_lab
