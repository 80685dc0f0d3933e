// SPDX-License-Identifier: BSD-3-Clause
#include "contact_matrix.h"

#include <algorithm>

#include <Eigen/Core>

namespace soft_robot_lab {
namespace {

constexpr double kDear = 1.5;  // times the body's own factorisation

}  // namespace

ContactPattern::ContactPattern(const BlockPattern& body, const FactorPattern& body_factor, std::vector<FacePair> pairs,
                               const std::vector<std::vector<int>>& cliques)
    : pairs_(std::move(pairs)),
      matrix_(std::make_shared<const BlockPattern>(body, cliques, BlockPattern::Order::kept)),
      factor_(std::make_shared<const FactorPattern>(*matrix_)) {
  if (factor_->flops() > kDear * body_factor.flops()) {
    auto other = std::make_shared<const BlockPattern>(body, cliques, BlockPattern::Order::anew);
    auto other_factor = std::make_shared<const FactorPattern>(*other);
    if (other_factor->flops() < factor_->flops()) {
      matrix_ = std::move(other);
      factor_ = std::move(other_factor);
    }
  }
  places_ = std::make_unique<const CliquePlaces>(*matrix_, cliques);
  for (int column = 0; column < body.node_count(); ++column) {
    const int at_column = matrix_->position(body.node(column));
    for (int s = body.column_start()[column]; s < body.column_start()[column + 1]; ++s) {
      const int at_row = matrix_->position(body.node(body.rows()[s]));
      of_body_.push_back({matrix_->slot(std::max(at_row, at_column), std::min(at_row, at_column)), at_row < at_column});
    }
  }
}

int ContactPattern::index_of(const FacePair& pair) const {
  const auto found = std::lower_bound(pairs_.begin(), pairs_.end(), pair);
  return found != pairs_.end() && *found == pair ? static_cast<int>(found - pairs_.begin()) : -1;
}

void ContactMatrix::follow(const std::shared_ptr<const ContactPattern>& pattern) {
  if (pattern == pattern_) return;
  pattern_ = pattern;
  matrix.follow(pattern->matrix());
  factor.follow(pattern->factor());
}

void ContactPattern::copy(const BlockMatrix& body, BlockMatrix& matrix) const {
  matrix.set_zero();
  for (std::size_t s = 0; s < of_body_.size(); ++s) {
    const Eigen::Map<const Eigen::Matrix3d> from(body.block(static_cast<int>(s)));
    Eigen::Map<Eigen::Matrix3d> to(matrix.block(of_body_[s].slot));
    if (of_body_[s].transposed)
      to = from.transpose();
    else
      to = from;
  }
}

}  // namespace soft_robot_lab
