// SPDX-License-Identifier: BSD-3-Clause
#include "path_length.h"

#include <cmath>

namespace soft_robot_lab {

Eigen::Matrix<double, 6, 6> Path::Span::hessian() const {
  if (around) return around->hessian;
  Eigen::Matrix<double, 6, 6> both;
  both << curvature, -curvature, -curvature, curvature;
  return both;
}

Path::Path(std::vector<EmbeddedPoint> points, const Eigen::Matrix3Xd& rest_positions_m, std::vector<SpanString> strings)
    : points_(std::move(points)), strings_(std::move(strings)) {
  for (std::size_t i = 1; i < points_.size(); ++i)
    closing_lengths_m_.push_back(0.1 * (points_[i].at(rest_positions_m) - points_[i - 1].at(rest_positions_m)).norm());
}

Eigen::Matrix3Xd Path::places(const Eigen::Matrix3Xd& positions_m) const {
  Eigen::Matrix3Xd places_m(3, static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i)
    places_m.col(static_cast<Eigen::Index>(i)) = points_[i].at(positions_m);
  return places_m;
}

std::vector<Path::Span> Path::spans_between(const Eigen::Matrix3Xd& places_m) const {
  std::vector<Span> result;
  for (std::size_t i = 0; i < closing_lengths_m_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!strings_.empty() && strings_[i]) {
      auto around = strings_[i]->between(places_m.col(k), places_m.col(k + 1));
      result.push_back({around->length_m, around->last, around->hessian.bottomRightCorner<3, 3>(), around});
      continue;
    }
    const Eigen::Vector3d vector = places_m.col(k + 1) - places_m.col(k);
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

std::vector<Clique> PathLength::cliques() const {
  std::vector<Clique> neighbours;
  for (int i = 1; i < static_cast<int>(path_.points().size()); ++i) neighbours.push_back({~(i - 1), ~i});
  return neighbours;
}

double Path::length_m(const Eigen::Matrix3Xd& positions_m) const {
  double sum = 0.0;
  for (const Span& span : spans(positions_m)) sum += span.length_m;
  return sum;
}

std::vector<Eigen::Vector3d> Path::polyline_m(const Eigen::Matrix3Xd& positions_m) const {
  const Eigen::Matrix3Xd places_m = places(positions_m);
  std::vector<Eigen::Vector3d> all{places_m.col(0)};
  const std::vector<Span> of_all = spans_between(places_m);
  for (std::size_t i = 0; i < of_all.size(); ++i) {
    if (of_all[i].around)
      for (Eigen::Index joint = 1; joint + 1 < of_all[i].around->way_m.cols(); ++joint)
        all.emplace_back(of_all[i].around->way_m.col(joint));
    all.emplace_back(places_m.col(static_cast<Eigen::Index>(i) + 1));
  }
  return all;
}

double PathLength::value(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/) const {
  return path_.length_m(positions_m);
}

void PathLength::add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/, double scale,
                              Eigen::Matrix3Xd& gradient) const {
  const std::vector<Path::Span> all = path_.spans(positions_m);
  const auto pull = [&](const EmbeddedPoint& point, const Eigen::Vector3d& direction) {
    for (std::size_t k = 0; k < point.nodes.size(); ++k) gradient.col(point.nodes[k]) += point.weights[k] * direction;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    pull(path_.points()[i + 1], scale * all[i].direction);
    pull(path_.points()[i], scale * all[i].by_first());
  }
}

void PathLength::add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/, double scale,
                             CliqueSink& hessian) const {
  const std::vector<Path::Span> all = path_.spans(positions_m);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].around) {
      hessian.add_dense(static_cast<int>(i), scale * all[i].around->hessian);
    } else {
      hessian.add_outer(static_cast<int>(i), {-1.0, 1.0}, scale * all[i].curvature);
    }
  }
}

ConstraintLaw PathLength::law(double value, double /*multiplier*/, const DriveState& drive) const {
  return law_of_length(law_(drive), value);
}

ConstraintLaw law_of_length(const CableLaw& at, double length_m) {
  ConstraintLaw law;
  if (at.by_tension) {
    law.min_multiplier = law.max_multiplier = at.tension_n;
    law.multiplier_per_command = at.per_command;
    return law;
  }
  law.offset = length_m - at.length_m;
  law.compliance = at.compliance_m_n;
  law.min_multiplier = 0.0;
  law.offset_per_command = -at.per_command;
  return law;
}

}  // namespace soft_robot_lab
