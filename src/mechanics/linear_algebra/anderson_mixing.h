// SPDX-License-Identifier: BSD-3-Clause
// Anderson's acceleration of a fixed-point iteration (Anderson 1965; Walker & Ni 2011): from the last few iterates z
// with residuals r and steps d, the next is z + d less the combination of differences that makes the linear model of r
// least. With steps of an old factor it is a preconditioned GMRES that needs no new matrix.
#pragma once

#include <deque>

#include <Eigen/Core>
#include <Eigen/QR>

namespace soft_robot_lab {

class AndersonMixing {
 public:
  explicit AndersonMixing(std::size_t depth) : depth_(depth) {}

  void clear() { past_.clear(); }
  std::size_t size() const { return past_.size(); }

  Eigen::VectorXd next(Eigen::VectorXd at, Eigen::VectorXd step, Eigen::VectorXd residual) {
    Eigen::VectorXd result = at + step;
    if (!past_.empty()) {
      Eigen::MatrixXd change(residual.size(), past_.size());
      for (std::size_t i = 0; i < past_.size(); ++i)
        change.col(static_cast<Eigen::Index>(i)) = residual - past_[i].residual;
      const Eigen::VectorXd fraction = change.colPivHouseholderQr().solve(residual);
      for (std::size_t i = 0; i < past_.size(); ++i)
        result -= fraction[static_cast<Eigen::Index>(i)] * (at - past_[i].at + step - past_[i].step);
    }
    past_.push_back({std::move(at), std::move(step), std::move(residual)});
    if (past_.size() > depth_) past_.pop_front();
    return result;
  }

 private:
  struct Iterate {
    Eigen::VectorXd at, step, residual;
  };
  std::size_t depth_;
  std::deque<Iterate> past_;
};

}  // namespace soft_robot_lab
