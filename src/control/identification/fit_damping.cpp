// SPDX-License-Identifier: BSD-3-Clause
#include "fit_damping.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/QR>
#include <ceres/ceres.h>

#include "fit_solver.h"
#include "fit_statistics.h"
#include "measured_weight.h"
#include "swing_choice.h"

namespace soft_robot_lab {
namespace {

const char* const kName = "damping.rayleigh_stiffness_s";
constexpr double kDifference = 1e-3;                        // of the logarithm
constexpr double kMostExtent = 3.0, kMostTempo = 1.2;       // or its inverse
constexpr double kDelaySize_s = 0.01, kPlaceSize_m = 1e-3;  // what counts as a change of about one

SceneOptions with_damping(SceneOptions options, double damping_s) {
  options.overrides.set({"body", "damping", "rayleigh_stiffness_s"}, damping_s);
  return options;
}

// The swings, and what they would be with a little more damping, where Ceres asks next.
class SwingPredictor : public ceres::EvaluationCallback {
 public:
  SwingPredictor(const std::string& scene, const SceneOptions& options, std::vector<MeasuredSwing> swings,
                 double start_s)
      : scene_(scene), options_(options), swings_(std::move(swings)), start_s_(start_s) {}

  void PrepareForEvaluation(bool derivatives, bool) override {
    if (now_.empty() || unknown != at_) {
      at_ = unknown;
      now_ = simulate(at_);
      more_.clear();
    }
    if (derivatives && more_.empty()) more_ = simulate(at_ + kDifference);
  }

  double damping_s() const { return start_s_ * std::exp(unknown); }
  const SimulatedSwing& now(std::size_t swing) const { return now_[swing]; }
  const SimulatedSwing& more(std::size_t swing) const { return more_[swing]; }

  double unknown = 0.0;  // logarithm of the damping over where it starts

 private:
  std::vector<SimulatedSwing> simulate(double at) const {
    const Scene scene = load_scene(scene_, with_damping(options_, start_s_ * std::exp(at)));
    return simulate_swings(*scene.simulation, swings_, kMostTempo * (kSwingWindow_s + 2.0 * kSwingDelayMargin_s));
  }

  const std::string& scene_;
  const SceneOptions& options_;
  std::vector<MeasuredSwing> swings_;
  double start_s_, at_ = 0.0;
  std::vector<SimulatedSwing> now_, more_;
};

// Of a marker in a swing: mean, drift from the middle to the end of the window, and what it slows down by (creep); in
// kPlaceSize_m.
using Place = Eigen::Matrix<double, 9, 1>;

// (extent * deflection at time - delay, as the cameras see it, + mean + drift + its change - measured) in standard
// deviations.
class SwingResidual : public ceres::SizedCostFunction<3, 1, 3, 9> {
 public:
  SwingResidual(const SwingPredictor& predictor, const SwingTrack& track, std::size_t sample,
                const Eigen::Matrix3d& turn, double model_error_m)
      : predictor_(predictor),
        track_(track),
        sample_(sample),
        turn_(turn),
        weight_(measured_weight(track.measured[sample], model_error_m)) {}

  Eigen::Vector3d miss_m(double const* const* parameters) const {
    const Eigen::Map<const Eigen::Vector3d> mean(parameters[2]), drift(parameters[2] + 3), change(parameters[2] + 6);
    return parameters[1][0] * (turn_ * predictor_.now(track_.swing).deflection_m(track_.marker, time_s(parameters))) +
           kPlaceSize_m * (mean + fraction() * (drift + fraction() * change)) - track_.measured[sample_].position_m;
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = weight_ * miss_m(parameters);
    if (!jacobians) return true;
    const SimulatedSwing &now = predictor_.now(track_.swing), &more = predictor_.more(track_.swing);
    const double extent = parameters[1][0], at_s = time_s(parameters);
    const Eigen::Matrix3d turned = weight_ * turn_;
    const Eigen::Vector3d here = now.deflection_m(track_.marker, at_s);
    if (jacobians[0])
      Eigen::Map<Eigen::Vector3d>(jacobians[0], 3) =
          extent / kDifference * (turned * (more.deflection_m(track_.marker, at_s) - here));
    if (jacobians[1]) {
      const Eigen::Vector3d velocity = extent * (turned * now.velocity_m_s(track_.marker, at_s));
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> swing(jacobians[1]);
      swing << turned * here, -kDelaySize_s * parameters[1][2] * velocity, since_free_s(parameters) * velocity;
    }
    if (jacobians[2]) {
      Eigen::Map<Eigen::Matrix<double, 3, 9, Eigen::RowMajor>> place(jacobians[2]);
      place << kPlaceSize_m * weight_, kPlaceSize_m * fraction() * weight_,
          kPlaceSize_m * fraction() * fraction() * weight_;
    }
    return true;
  }

 private:
  double since_free_s(double const* const* parameters) const {
    return track_.times_s[sample_] - kDelaySize_s * parameters[1][1] - track_.free_s;
  }
  double time_s(double const* const* parameters) const {
    return track_.free_s + parameters[1][2] * since_free_s(parameters);
  }
  double fraction() const { return track_.fraction(track_.times_s[sample_]); }

  const SwingPredictor& predictor_;
  const SwingTrack& track_;
  std::size_t sample_;
  Eigen::Matrix3d turn_, weight_;
};

// About one unknown, whatever the others are: inverse of its variance.
double information(ceres::Problem& problem, double* unknown, const std::vector<double*>& others) {
  ceres::Problem::EvaluateOptions in_order;
  in_order.parameter_blocks = {unknown};
  in_order.parameter_blocks.insert(in_order.parameter_blocks.end(), others.begin(), others.end());
  std::vector<double> residuals;
  ceres::CRSMatrix sparse;
  problem.Evaluate(in_order, nullptr, &residuals, nullptr, &sparse);
  const Eigen::MatrixXd jacobian = dense(sparse), beside = jacobian.rightCols(jacobian.cols() - 1);
  const Eigen::VectorXd own = jacobian.col(0) - beside * beside.colPivHouseholderQr().solve(jacobian.col(0));
  return own.squaredNorm() / residual_variance(residuals, jacobian.cols());
}

// The residuals of all swings, with what Ceres may change: the damping, of each swing its extent, delay and tempo, and
// of each track its place.
class SwingProblem {
 public:
  SwingProblem(SwingPredictor& predictor, const ChosenSwings& chosen, const Eigen::Matrix3d& turn, double model_error_m)
      : predictor_(predictor), problem_(options(predictor)), places_(chosen.tracks.size(), Place::Zero()) {
    for (const double delay_s : chosen.delays_s) swings_.emplace_back(1.0, delay_s / kDelaySize_s, 1.0);
    for (std::size_t t = 0; t < places_.size(); ++t) add_track(chosen.tracks[t], places_[t], turn, model_error_m);
  }

  void set_bounds(const FitNumber& number) {
    problem_.SetParameterLowerBound(&predictor_.unknown, 0, std::log(number.min / number.start));
    problem_.SetParameterUpperBound(&predictor_.unknown, 0, std::log(number.max / number.start));
    for (Eigen::Vector3d& swing : swings_) {
      for (const auto& [index, most] : {std::pair{0, kMostExtent}, std::pair{2, kMostTempo}}) {
        problem_.SetParameterLowerBound(swing.data(), index, 1.0 / most);
        problem_.SetParameterUpperBound(swing.data(), index, most);
      }
      problem_.SetParameterLowerBound(swing.data(), 1, swing[1] - kSwingDelayMargin_s / kDelaySize_s);
      problem_.SetParameterUpperBound(swing.data(), 1, swing[1] + kSwingDelayMargin_s / kDelaySize_s);
    }
  }

  double rms_m() const {
    double squares = 0.0;
    for (const Sample& sample : samples_) squares += sample.residual->miss_m(sample.unknowns).squaredNorm();
    return std::sqrt(squares / static_cast<double>(samples_.size()));
  }

  FitEnd solve(const FitRequest& request) {
    return solve_fit(problem_, loss_, request, [this] { return rms_m(); });
  }

  double information_of_damping() {
    std::vector<double*> others;
    for (Eigen::Vector3d& swing : swings_) others.push_back(swing.data());
    for (Place& place : places_) others.push_back(place.data());
    return information(problem_, &predictor_.unknown, others);
  }

 private:
  struct Sample {
    const SwingResidual* residual;
    const double* unknowns[3];
  };

  static ceres::Problem::Options options(SwingPredictor& predictor) {
    ceres::Problem::Options options;
    options.evaluation_callback = &predictor;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  void add_track(const SwingTrack& track, Place& place, const Eigen::Matrix3d& turn, double model_error_m) {
    for (const MeasuredMarker& one : track.measured)
      place.head<3>() += one.position_m / (kPlaceSize_m * static_cast<double>(track.measured.size()));
    for (std::size_t i = 0; i < track.times_s.size(); ++i) {
      auto* residual = new SwingResidual(predictor_, track, i, turn, model_error_m);
      double* swing = swings_[track.swing].data();
      problem_.AddResidualBlock(residual, &loss_, &predictor_.unknown, swing, place.data());
      samples_.push_back({residual, {&predictor_.unknown, swing, place.data()}});
    }
  }

  SwingPredictor& predictor_;
  ceres::LossFunctionWrapper loss_{nullptr, ceres::TAKE_OWNERSHIP};
  ceres::Problem problem_;
  std::vector<Eigen::Vector3d> swings_;  // extent, delay, tempo
  std::vector<Place> places_;
  std::vector<Sample> samples_;
};

void take_over(const FitEnd& end, FitResult& result) {
  if (result.values.empty()) {  // damping alone
    result.converged = end.converged;
    result.message = end.message;
  } else if (!end.converged) {
    result.converged = false;
    result.message = "damping: " + end.message;
  }
  result.iterations += end.iterations;
}

void warn_of(const FittedValue& value, const FitNumber& number, FitResult& result) {
  if (!value.identifiable) result.warnings.push_back("the data cannot identify damping");
  if (value.value < 1.01 * number.min || value.value > 0.99 * number.max)
    result.warnings.push_back("damping ended on its bound " + text_of(value.value) +
                              " s; at the lower one the scene's own time step damps as much as the robot does");
}

}  // namespace

void fit_damping(const std::string& scene, const SceneOptions& asked, const std::vector<MeasuredSwing>& swings,
                 const FitNumber& number, const FitRequest& request, FitResult& result) {
  SceneOptions options = asked;
  options.overrides = result.overrides;
  const Scene swinging = load_scene(scene, with_damping(options, number.start));
  const ChosenSwings chosen = choose_swings(*swinging.simulation, swings, request.model_error_m);
  if (chosen.swings.empty()) {
    result.warnings.push_back(
        "damping: the data cannot identify it, as nothing swings, measured and simulated; it stays as it is");
    return;
  }
  SwingPredictor predictor(scene, options, chosen.swings, number.start);
  SwingProblem problem(predictor, chosen, result.measured_from_base.linear(), request.model_error_m);
  problem.set_bounds(number);
  take_over(problem.solve(request), result);
  FitNumber named = number;
  named.name = kName;
  const double damping_s = predictor.damping_s();
  add_by_logarithms({named}, Eigen::VectorXd::Constant(1, damping_s),
                    Eigen::MatrixXd::Constant(1, 1, problem.information_of_damping()), result);
  warn_of(result.values.back(), number, result);
  if (result.values.back().identifiable) result.overrides = with_damping(options, damping_s).overrides;
  result.swings = static_cast<int>(chosen.swings.size());
  result.swing_rms_m = problem.rms_m();
}

}  // namespace soft_robot_lab
