// SPDX-License-Identifier: BSD-3-Clause
#include "volume_polynomials.h"

#include <utility>

#include "polynomial_kernels.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kPointsOfElement = 4;

Eigen::MatrixXd all_crosses(const PointGradient& d) {
  const Eigen::Index n = d.cols();
  Eigen::MatrixXd crosses(9, n * (n + 1) / 2);
  for (Eigen::Index i = 0, p = 0; i < n; ++i)
    for (Eigen::Index j = i; j < n; ++j, ++p) crosses.col(p) = tensor_cross(d.col(i), d.col(j));
  return crosses;
}

// Calls f(position among the monomials, i, pair (j, l), factor) for all triples; the factor is the number of their
// different orders over six.
template <class F>
void for_triples(Eigen::Index n, const F& f) {
  const Eigen::Index pairs = n * (n + 1) / 2;
  Eigen::Index place = n + pairs;
  for (Eigen::Index i = 0, first = 0; i < n; first += n - i, ++i)
    for (Eigen::Index j = i, pair = first; j < n; ++j)
      for (Eigen::Index l = j; l < n; ++l, ++pair, ++place)
        f(place, i, pair, i == l ? 1.0 / 6.0 : (i == j || j == l ? 0.5 : 1.0));
}

Eigen::Index pair_count(Eigen::Index n) { return n * (n + 1) / 2; }
Eigen::Index monomial_count(Eigen::Index n) { return n + n * (n + 1) / 2 + n * (n + 1) * (n + 2) / 6; }

// Coefficients of a sum of w (det(M + A) - det M).
class DeterminantCoefficients {
 public:
  explicit DeterminantCoefficients(Eigen::Index n)
      : linear_(Eigen::VectorXd::Zero(n)),
        quadratic_(Eigen::VectorXd::Zero(pair_count(n))),
        cubic_(Eigen::MatrixXd::Zero(n, pair_count(n))) {}

  void add(double weight, const FlatMatrix& at_rest, const PointGradient& d) {
    const Eigen::MatrixXd crosses = all_crosses(d);
    linear_ += d.transpose() * (0.5 * weight * tensor_cross(at_rest, at_rest));
    quadratic_ += crosses.transpose() * (weight * at_rest);
    cubic_ += weight * (d.transpose() * crosses);
  }

  Eigen::VectorXd in_order() const {
    const Eigen::Index n = linear_.size();
    Eigen::VectorXd all = Eigen::VectorXd::Zero(monomial_count(n));
    all.head(n) = linear_;
    for (Eigen::Index i = 0, pair = 0; i < n; ++i)
      for (Eigen::Index j = i; j < n; ++j, ++pair) all[n + pair] = (i == j ? 0.5 : 1.0) * quadratic_[pair];
    for_triples(n, [&](Eigen::Index place, Eigen::Index i, Eigen::Index pair, double factor) {
      all[place] += factor * cubic_(i, pair);
    });
    return all;
  }

 private:
  Eigen::VectorXd linear_, quadratic_;
  Eigen::MatrixXd cubic_;
};

double* numbers(Batches& batches) { return reinterpret_cast<double*>(batches.data()); }
const double* numbers(const Batches& batches) { return reinterpret_cast<const double*>(batches.data()); }

}  // namespace

// A row of batches for each polynomial.
struct VolumePolynomials::Coefficients {
  Coefficients(Eigen::Index modes, Eigen::Index polynomials)
      : row(blocks_for(static_cast<std::size_t>(monomial_count(modes)))),
        all(row * static_cast<std::size_t>(polynomials), Batch{}) {}

  void add(Eigen::Index polynomial, const Eigen::VectorXd& in_order) {
    Batch* first = all.data() + row * static_cast<std::size_t>(polynomial);
    Eigen::Map<Eigen::VectorXd>(reinterpret_cast<double*>(first), in_order.size()) += in_order;
  }
  const double* numbers_of(Eigen::Index polynomial) const {
    return numbers(all) + kLanes * row * static_cast<std::size_t>(polynomial);
  }
  Batches monomials(const Eigen::VectorXd& q) const {
    Batches at(row, Batch{});
    fill_monomials(q.data(), q.size(), numbers(at));
    return at;
  }

  std::size_t row;
  Batches all;
};

VolumePolynomials::VolumePolynomials(const std::vector<RestPoint>& points, const Eigen::MatrixXd& shares)
    : modes_(points.front().gradient.cols()), count_(shares.cols()) {
  auto coefficients = std::make_shared<Coefficients>(modes_, count_);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const Eigen::Map<const FlatMatrix> identity(one.data());
  for (std::size_t first = 0; first < points.size(); first += kPointsOfElement) {
    DeterminantCoefficients element(modes_);
    for (std::size_t i = first; i < first + kPointsOfElement; ++i)
      element.add(points[i].weight_m3, identity, points[i].gradient);
    const Eigen::VectorXd in_order = element.in_order();
    for (Eigen::Index k = 0; k < count_; ++k) coefficients->add(k, shares(points[first].element, k) * in_order);
  }
  coefficients_ = std::move(coefficients);
}

VolumePolynomials::VolumePolynomials(const std::vector<DeterminantSum>& sums)
    : modes_(sums.front().front().gradient.cols()), count_(static_cast<Eigen::Index>(sums.size())) {
  auto coefficients = std::make_shared<Coefficients>(modes_, count_);
  for (Eigen::Index k = 0; k < count_; ++k) {
    DeterminantCoefficients sum(modes_);
    for (const DeterminantTerm& term : sums[static_cast<std::size_t>(k)])
      sum.add(term.weight, Eigen::Map<const FlatMatrix>(term.at_rest.data()), term.gradient);
    coefficients->add(k, sum.in_order());
  }
  coefficients_ = std::move(coefficients);
}

VolumePolynomials::Values VolumePolynomials::at(const Eigen::VectorXd& q, const Eigen::VectorXd& scales) const {
  const std::size_t row = coefficients_->row;
  const Batches at = coefficients_->monomials(q);
  Batches sum(row, Batch{});
  Values result{Eigen::VectorXd(count()), Eigen::VectorXd(modes_)};
  evaluate_polynomials(coefficients_->all.data(), row, count_, at.data(), scales.data(), result.values.data(),
                       sum.data());
  Eigen::VectorXd slopes(pair_count(modes_));
  polynomial_gradient({numbers(sum), numbers(at), q.data(), modes_}, slopes.data(), result.gradient.data());
  return result;
}

Eigen::MatrixXd VolumePolynomials::gradients(const Eigen::VectorXd& q) const {
  const Batches at = coefficients_->monomials(q);
  Eigen::MatrixXd result(modes_, count());
  Eigen::VectorXd slopes(pair_count(modes_));
  for (Eigen::Index k = 0; k < count(); ++k)
    polynomial_gradient({coefficients_->numbers_of(k), numbers(at), q.data(), modes_}, slopes.data(),
                        result.col(k).data());
  return result;
}

Eigen::MatrixXd VolumePolynomials::hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& scales) const {
  const Batches at = coefficients_->monomials(q);
  Batches sum(coefficients_->row, Batch{});
  add_polynomials(coefficients_->all.data(), coefficients_->row, count_, scales.data(), sum.data());
  Eigen::VectorXd slopes(pair_count(modes_)), gradient(modes_);
  const CubicAt polynomial{numbers(sum), numbers(at), q.data(), modes_};
  polynomial_gradient(polynomial, slopes.data(), gradient.data());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(modes_, modes_);
  add_polynomial_hessian(polynomial, slopes.data(), result.data());
  return result + result.transpose();
}

}  // namespace soft_robot_lab
