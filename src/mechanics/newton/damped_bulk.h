// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "mechanics/elements/elements.h"
#include "mechanics/elements/strain_springs.h"

namespace soft_robot_lab {

// As long as it lives elements have the stiffness of their volume together with its damping's; fibres have no damping.
class DampedBulk {
 public:
  DampedBulk(Elements& elements, const StrainTarget* damping) : elements_(elements) {
    if (!damping || damping->volume_ratio == 0.0) return;
    lambda_pa_ = elements.lambda_pa();
    Eigen::VectorXd damped_pa = (1.0 + damping->volume_ratio) * lambda_pa_;
    damped_pa.tail(elements.fibre_count()) = lambda_pa_.tail(elements.fibre_count());
    elements_.set_lambda_pa(damped_pa);
  }
  ~DampedBulk() {
    if (lambda_pa_.size() > 0) elements_.set_lambda_pa(lambda_pa_);
  }
  DampedBulk(const DampedBulk&) = delete;
  DampedBulk& operator=(const DampedBulk&) = delete;

 private:
  Elements& elements_;
  Eigen::VectorXd lambda_pa_;  // without; empty where there is none
};

}  // namespace soft_robot_lab
