// SPDX-License-Identifier: BSD-3-Clause
#include "sight_fit.h"

#include <stdexcept>
#include <utility>

#include <ceres/cost_function.h>

#include "fit_solver.h"
#include "fit_statistics.h"

namespace soft_robot_lab {
namespace {

class SightResidual : public ceres::CostFunction {
 public:
  SightResidual(const FitPredictor& predictor, std::vector<SeenAt> parts, Eigen::VectorXd shares,
                Eigen::Vector3d measured_m, const Eigen::Matrix3d& weight, int unknowns)
      : predictor_(predictor),
        parts_(std::move(parts)),
        shares_(std::move(shares)),
        measured_m_(std::move(measured_m)),
        weight_(weight) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->push_back(unknowns);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    if (!predictor_.good()) return false;
    Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < parts_.size(); ++i)
      sum_m += shares_[static_cast<Eigen::Index>(i)] * predictor_.measured(parts_[i].sight, parts_[i].marker);
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = weight_ * (sum_m - measured_m_);
    if (!jacobians || !jacobians[0]) return true;
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, parameter_block_sizes()[0]);
    for (std::size_t i = 0; i < parts_.size(); ++i)
      sum += shares_[static_cast<Eigen::Index>(i)] * predictor_.jacobian(parts_[i].sight, parts_[i].marker);
    Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>(jacobians[0], 3, sum.cols()) = weight_ * sum;
    return true;
  }

 private:
  const FitPredictor& predictor_;
  std::vector<SeenAt> parts_;
  Eigen::VectorXd shares_;
  Eigen::Vector3d measured_m_;
  Eigen::Matrix3d weight_;
};

ceres::Problem::Options problem_options(FitPredictor& predictor) {
  ceres::Problem::Options options;
  options.evaluation_callback = &predictor;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

// Of residuals, with the loss over without it.
Eigen::VectorXd shares_of(ceres::Problem& problem, const std::vector<double>& robust) {
  ceres::Problem::EvaluateOptions plainly;
  plainly.apply_loss_function = false;
  std::vector<double> plain;
  problem.Evaluate(plainly, nullptr, &plain, nullptr, nullptr);
  Eigen::VectorXd shares(static_cast<Eigen::Index>(robust.size()));
  for (Eigen::Index i = 0; i < shares.size(); i += 3) {
    const auto norm_of = [i](const std::vector<double>& all) {
      return Eigen::Map<const Eigen::Vector3d>(&all[static_cast<std::size_t>(i)]).norm();
    };
    const double norm = norm_of(plain);
    shares.segment<3>(i).setConstant(norm > 0.0 ? norm_of(robust) / norm : 1.0);
  }
  return shares;
}

void require_enough(int residuals, int unknowns) {
  if (residuals == 0)
    throw std::invalid_argument(
        "poses: the robot is nowhere at rest with markers seen; allowed: at least one such pose");
  if (residuals <= unknowns)
    throw std::invalid_argument("poses: " + std::to_string(residuals) + " coordinates cannot identify " +
                                std::to_string(unknowns) + " parameters");
}

}  // namespace

SightFit::SightFit(const FitParameters& parameters, std::vector<FitNumber> numbers, FitPredictor::Predict predict,
                   std::vector<double>& unknowns)
    : numbers_(std::move(numbers)),
      unknowns_(unknowns),
      predictor_(parameters, numbers_, std::move(predict), unknowns),
      problem_(problem_options(predictor_)) {}

void SightFit::add(std::vector<SeenAt> parts, Eigen::VectorXd shares, const Eigen::Vector3d& measured_m,
                   const Eigen::Matrix3d& weight) {
  problem_.AddResidualBlock(new SightResidual(predictor_, std::move(parts), std::move(shares), measured_m, weight,
                                              static_cast<int>(unknowns_.size())),
                            &loss_, unknowns_.data());
}

FitResult SightFit::solve(const std::vector<MeasuredPose>& poses, const FitRequest& request) {
  const int unknowns = static_cast<int>(unknowns_.size());
  require_enough(problem_.NumResiduals(), unknowns);
  for (int i = 0; i < unknowns; ++i) {
    const FitNumber& number = numbers_[static_cast<std::size_t>(i)];
    problem_.SetParameterLowerBound(unknowns_.data(), i, (number.min - number.start) / number.size);
    problem_.SetParameterUpperBound(unknowns_.data(), i, (number.max - number.start) / number.size);
  }
  const MarkerPlace modelled = [&](std::size_t pose, Eigen::Index marker) { return predictor_.measured(pose, marker); };
  FitResult result;
  predictor_.require_good("the scene as it is has no equilibrium: ");
  result.before = gap_of(poses, modelled);
  const std::vector<double> before_m = pose_gaps_m(poses, modelled);
  const FitEnd end = solve_fit(problem_, loss_, request, [&] { return gap_of(poses, modelled).rms_m; });
  result.converged = end.converged;
  result.message = end.message;
  result.iterations = end.iterations;

  predictor_.PrepareForEvaluation(true, true);
  if (!predictor_.good()) unknowns_ = predictor_.last_good();
  predictor_.require_good("the fitted scene has no equilibrium: ");
  ceres::CRSMatrix sparse;
  problem_.Evaluate({}, nullptr, &residuals_, nullptr, &sparse);
  jacobian_ = dense(sparse);
  robust_shares_ = shares_of(problem_, residuals_);
  result.after = gap_of(poses, modelled);
  add_configurations(poses, before_m, pose_gaps_m(poses, modelled), request, result);
  return result;
}

}  // namespace soft_robot_lab
