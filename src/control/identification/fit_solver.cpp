// SPDX-License-Identifier: BSD-3-Clause
#include "fit_solver.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <ceres/ceres.h>

#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

// Where cables stick and slip the gap is not smooth: at its least no step gains, however short.
constexpr int kMostInVain = 4;

class Reporter : public ceres::IterationCallback {
 public:
  Reporter(const FitRequest& request, const std::function<double()>& gap_m) : request_(request), gap_m_(gap_m) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool gained = summary.iteration == 0 || summary.step_is_successful;
    if (gained) rms_gap_m_ = gap_m_();  // else the last one looked at failed
    in_vain_ = gained ? 0 : in_vain_ + 1;
    cancelled_ = request_.progress && !request_.progress(summary.iteration, rms_gap_m_);
    if (cancelled_ || in_vain_ == kMostInVain) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    return ceres::SOLVER_CONTINUE;
  }

  bool cancelled() const { return cancelled_; }
  bool in_vain() const { return in_vain_ == kMostInVain; }

 private:
  const FitRequest& request_;
  const std::function<double()>& gap_m_;
  double rms_gap_m_ = 0.0;
  int in_vain_ = 0;  // steps since the last that gained
  bool cancelled_ = false;
};

ceres::Solver::Options solver_options(const FitRequest& request) {
  ceres::Solver::Options options;
  options.max_num_iterations = request.max_iterations;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-4;  // with some hundred coordinates that is less than a fifth of a deviation
  // Steps in vain shall soon be shorter ones: Ceres' own region is so wide that the first ones all are the same.
  options.initial_trust_region_radius = 1e2;
  options.max_trust_region_radius = 1e4;
  options.parameter_tolerance = 1e-4;
  // A search along each step would ask for derivatives where no step ends: shorter steps are found without them.
  options.max_num_line_search_step_size_iterations = 0;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  return options;
}

// Of markers' residuals.
std::vector<double> residual_lengths(ceres::Problem& problem) {
  std::vector<double> residuals, lengths;
  problem.Evaluate({}, nullptr, &residuals, nullptr, nullptr);
  for (std::size_t i = 0; i + 2 < residuals.size(); i += 3)
    lengths.push_back(std::hypot(residuals[i], residuals[i + 1], residuals[i + 2]));
  return lengths;
}

// From the median of all; at least the one expected.
double typical_deviation(const std::vector<double>& lengths) {
  constexpr double median_of_length = 1.538;  // of three normal numbers of unit deviation
  return std::max(1.0, median(lengths) / median_of_length);
}

// Ceres' own words name its settings.
std::string words_of(ceres::TerminationType type, bool in_vain, bool cancelled) {
  if (cancelled) return "cancelled";
  if (in_vain) return "no step gains any more";
  if (type == ceres::CONVERGENCE) return "converged";
  return type == ceres::NO_CONVERGENCE ? "iteration limit" : "the model has no answer at what was tried";
}

}  // namespace

FitEnd solve_fit(ceres::Problem& problem, ceres::LossFunctionWrapper& loss, const FitRequest& request,
                 const std::function<double()>& gap_m) {
  FitEnd end;
  for (const bool robust : {false, true}) {
    if (robust) {
      const std::vector<double> lengths = residual_lengths(problem);
      const double outlier = request.outlier_deviations * typical_deviation(lengths);
      if (*std::max_element(lengths.begin(), lengths.end()) <= outlier) break;
      loss.Reset(new ceres::HuberLoss(outlier), ceres::TAKE_OWNERSHIP);
    }
    Reporter reporter(request, gap_m);
    ceres::Solver::Options options = solver_options(request);
    options.callbacks = {&reporter};
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    const bool in_vain = reporter.in_vain() && !reporter.cancelled();
    end.converged = summary.termination_type == ceres::CONVERGENCE || in_vain;
    end.message = words_of(summary.termination_type, in_vain, reporter.cancelled());
    end.iterations += static_cast<int>(summary.iterations.size());
    if (reporter.cancelled()) break;
  }
  return end;
}

}  // namespace soft_robot_lab
