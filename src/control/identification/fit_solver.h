// SPDX-License-Identifier: BSD-3-Clause
// Ceres as every fit uses it.
#pragma once

#include <functional>
#include <string>

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

struct FitEnd {
  bool converged = false;
  std::string message;
  int iterations = 0;
};

// Least squares first, then with `loss`, which all residual blocks of three have, made robust: far from the solution
// everything would count as an outlier. Asks request.progress after each iteration, with gap_m() of the point it then
// stands at.
FitEnd solve_fit(ceres::Problem& problem, ceres::LossFunctionWrapper& loss, const FitRequest& request,
                 const std::function<double()>& gap_m);

}  // namespace soft_robot_lab
