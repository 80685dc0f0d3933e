// SPDX-License-Identifier: BSD-3-Clause
#include "path_length.h"

#include <cmath>

namespace soft_robot_lab {

PathLength::PathLength(std::vector<EmbeddedPoint> points, const Eigen::Matrix3Xd& rest_positions_m)
    : points_(std::move(points)) {
  for (std::size_t i = 1; i < points_.size(); ++i)
    closing_lengths_m_.push_back(0.1 * (points_[i].at(rest_positions_m) - points_[i - 1].at(rest_positions_m)).norm());
}

std::vector<Clique> PathLength::cliques() const {
  std::vector<Clique> neighbours;
  for (int i = 1; i < static_cast<int>(points_.size()); ++i) neighbours.push_back({~(i - 1), ~i});
  return neighbours;
}

std::vector<PathLength::Span> PathLength::spans(const Eigen::Matrix3Xd& positions_m) const {
  std::vector<Span> result;
  Eigen::Vector3d end = points_[0].at(positions_m);
  for (std::size_t i = 0; i < closing_lengths_m_.size(); ++i) {
    const Eigen::Vector3d start = end;
    end = points_[i + 1].at(positions_m);
    const Eigen::Vector3d vector = end - start;
    const double length = vector.norm(), closing = closing_lengths_m_[i];
    if (length > closing) {
      const Eigen::Vector3d unit = vector / length;
      result.push_back({length, unit, (Eigen::Matrix3d::Identity() - unit * unit.transpose()) / length});
    } else {
      result.push_back(
          {0.5 * (length * length / closing + closing), vector / closing, Eigen::Matrix3d::Identity() / closing});
    }
  }
  return result;
}

double PathLength::value(const Eigen::Matrix3Xd& positions_m) const {
  double sum = 0.0;
  for (const Span& span : spans(positions_m)) sum += span.length_m;
  return sum;
}

void PathLength::add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const {
  const std::vector<Span> all = spans(positions_m);
  const auto pull = [&](const EmbeddedPoint& point, const Eigen::Vector3d& direction) {
    for (std::size_t k = 0; k < point.nodes.size(); ++k) gradient.col(point.nodes[k]) += point.weights[k] * direction;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    pull(points_[i + 1], scale * all[i].direction);
    pull(points_[i], -scale * all[i].direction);
  }
}

void PathLength::add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const {
  const std::vector<Span> all = spans(positions_m);
  for (std::size_t i = 0; i < all.size(); ++i)
    hessian.add_outer(static_cast<int>(i), {-1.0, 1.0}, scale * all[i].curvature);
}

ConstraintLaw PathLength::law(double value, double /*multiplier*/) const {
  ConstraintLaw law = law_;
  if (!law.prescribed()) law.offset = value - length_m_;
  return law;
}

void PathLength::command_length(double length_m, double compliance_m_n, double length_per_command) {
  length_m_ = length_m;
  law_ = ConstraintLaw{};
  law_.compliance = compliance_m_n;
  law_.min_multiplier = 0.0;
  law_.offset_per_command = -length_per_command;
}

void PathLength::command_tension(double tension_n, double tension_per_command) {
  law_ = ConstraintLaw{};
  law_.min_multiplier = law_.max_multiplier = tension_n;
  law_.multiplier_per_command = tension_per_command;
}

}  // namespace soft_robot_lab
