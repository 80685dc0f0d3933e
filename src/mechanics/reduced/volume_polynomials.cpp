// SPDX-License-Identifier: BSD-3-Clause
#include "volume_polynomials.h"

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr std::size_t kPointsOfElement = 4;

Eigen::MatrixXd all_crosses(const PointGradient& d) {
  const Eigen::Index n = d.cols();
  Eigen::MatrixXd crosses(9, n * (n + 1) / 2);
  for (Eigen::Index i = 0, p = 0; i < n; ++i)
    for (Eigen::Index j = i; j < n; ++j, ++p) crosses.col(p) = (i == j ? 0.5 : 1.0) * tensor_cross(d.col(i), d.col(j));
  return crosses;
}

PointGradient transposed(const PointGradient& d) {
  PointGradient result(9, d.cols());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result.row(3 * i + j) = d.row(3 * j + i);
  return result;
}

Eigen::VectorXd products(const Eigen::VectorXd& q) {
  Eigen::VectorXd m(q.size() * (q.size() + 1) / 2);
  for (Eigen::Index i = 0, p = 0; i < q.size(); ++i)
    for (Eigen::Index j = i; j < q.size(); ++j) m[p++] = q[i] * q[j];
  return m;
}

}  // namespace

VolumePolynomials::VolumePolynomials(const std::vector<RestPoint>& points, const Eigen::MatrixXd& shares)
    : modes_(points.front().gradient.cols()) {
  const Eigen::Index polynomials = shares.cols() + 1;
  linear_.setZero(modes_, polynomials);
  quadratic_.assign(static_cast<std::size_t>(polynomials), Eigen::MatrixXd::Zero(modes_, modes_));
  cubic_.setZero(modes_ * polynomials, modes_ * (modes_ + 1) / 2);
  for (std::size_t first = 0; first < points.size(); first += kPointsOfElement) {
    Eigen::RowVectorXd all(polynomials);
    all << shares.row(points[first].element), 1.0;
    add_element(points, first, all);
  }
}

void VolumePolynomials::add_element(const std::vector<RestPoint>& points, std::size_t first,
                                    const Eigen::RowVectorXd& shares) {
  Eigen::VectorXd linear = Eigen::VectorXd::Zero(modes_);
  Eigen::MatrixXd quadratic = Eigen::MatrixXd::Zero(modes_, modes_);
  Eigen::MatrixXd cubic = Eigen::MatrixXd::Zero(modes_, cubic_.cols());
  for (std::size_t i = first; i < first + kPointsOfElement; ++i) {
    const PointGradient& d = points[i].gradient;
    const Eigen::VectorXd trace = traces(d);
    const double w = points[i].weight_m3;
    linear += w * trace;
    quadratic += w * (trace * trace.transpose() - d.transpose() * transposed(d));
    cubic += w * (d.transpose() * all_crosses(d));
  }
  for (Eigen::Index k = 0; k < shares.size(); ++k) {
    linear_.col(k) += shares[k] * linear;
    quadratic_[static_cast<std::size_t>(k)] += shares[k] * quadratic;
    cubic_.middleRows(k * modes_, modes_) += shares[k] * cubic;
  }
}

VolumePolynomials::Values VolumePolynomials::at(const Eigen::VectorXd& q) const {
  const Eigen::VectorXd cubes = cubic_ * products(q);
  Values result{Eigen::VectorXd(count()), linear_};
  for (Eigen::Index k = 0; k < count(); ++k) {
    const Eigen::VectorXd squares = quadratic_[static_cast<std::size_t>(k)] * q;
    const auto cube = cubes.segment(k * modes_, modes_);
    result.values[k] = q.dot(linear_.col(k) + squares / 2.0 + cube / 3.0);
    result.gradients.col(k) += squares + cube;
  }
  return result;
}

Eigen::MatrixXd VolumePolynomials::hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& scales) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(modes_, modes_);
  for (Eigen::Index k = 0; k < count(); ++k) result += scales[k] * quadratic_[static_cast<std::size_t>(k)];
  for (Eigen::Index i = 0, p = 0; i < modes_; ++i)
    for (Eigen::Index j = i; j < modes_; ++j, ++p) {
      const Eigen::VectorXd column = Eigen::Map<const Eigen::MatrixXd>(cubic_.col(p).data(), modes_, count()) * scales;
      result.col(i) += q[j] * column;
      result.col(j) += q[i] * column;  // twice where i = j
    }
  return result;
}

}  // namespace soft_robot_lab
