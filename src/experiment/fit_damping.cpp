#include "experiment/fit_damping.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>

#include <Eigen/QR>
#include <ceres/ceres.h>

#include "experiment/fit_parameters.h"
#include "experiment/fit_solver.h"
#include "experiment/fit_statistics.h"
#include "experiment/measured_weight.h"
#include "experiment/swing_model.h"

namespace soft_robot_lab {
namespace {

const char* const kName = "damping.rayleigh_stiffness_s";
constexpr double kStart_s = 2e-3, kMin_s = 1e-5, kMax_s = 0.1;  // unless the scene says otherwise
constexpr double kDifference = 1e-3;                            // of the logarithm
// Of drives and cameras behind the commands.
constexpr double kLeastDelay_s = -0.1, kMostDelay_s = 0.2, kDelaySize_s = 0.01;
constexpr double kLeastExtent = 0.05, kMostExtent = 20.0;
constexpr double kPlaceSize_m = 1e-3;
constexpr double kWindow_s = 3.0;       // of a swing no more counts
constexpr std::size_t kMostSwings = 6;  // the largest; each is simulated some twenty times
constexpr std::size_t kSamples = 8;     // of a marker in a swing, at least
constexpr double kMotion = 5.0;         // in deviations of its noise: a marker swings

// A marker in a swing, after the drives arrived.
struct Track {
  std::size_t swing = 0;
  int marker = 0;  // in the scene
  std::vector<double> times_s;
  std::vector<MeasuredMarker> measured;
  double middle_s = 0.0;  // of the window
  // Unknown: mean and drift from the middle to the end of the window, both in kPlaceSize_m.
  Eigen::Matrix<double, 6, 1> place = Eigen::Matrix<double, 6, 1>::Zero();

  double share(double time_s) const { return (time_s - middle_s) / (0.5 * kWindow_s); }
};

// Root mean square of what a straight line in time leaves of the places.
double motion_m(const Track& track, const std::function<Eigen::Vector3d(std::size_t)>& place_m) {
  const auto count = static_cast<Eigen::Index>(track.times_s.size());
  Eigen::MatrixX2d line(count, 2);
  Eigen::MatrixX3d places(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    line.row(i) << 1.0, track.share(track.times_s[static_cast<std::size_t>(i)]);
    places.row(i) = place_m(static_cast<std::size_t>(i)).transpose();
  }
  const Eigen::MatrixX3d left = places - line * line.colPivHouseholderQr().solve(places);
  return std::sqrt(left.squaredNorm() / static_cast<double>(count));
}

double deviation_m(const Track& track, double model_error_m) {
  double variance = 0.0;
  for (const MeasuredMarker& one : track.measured) variance += one.covariance_m2.trace();
  return std::sqrt(variance / static_cast<double>(track.measured.size()) + 3.0 * model_error_m * model_error_m);
}

std::vector<Track> tracks_of(const MeasuredSwing& swing, std::size_t index, const SimulatedSwing& simulated,
                             const Simulation& simulation) {
  const double start_s = simulated.free_s() + kMostDelay_s;
  std::map<std::string, Track> by_marker;
  for (const MarkersAt& at : swing.seen) {
    if (at.time_s < start_s || at.time_s > start_s + kWindow_s) continue;
    for (const MeasuredMarker& marker : at.markers) {
      Track& track = by_marker[marker.name];
      track.times_s.push_back(at.time_s);
      track.measured.push_back(marker);
    }
  }
  std::vector<Track> tracks;
  for (auto& [name, track] : by_marker) {
    if (track.times_s.size() < kSamples) continue;
    track.swing = index;
    track.marker = simulation.marker_index(name);
    track.middle_s = start_s + 0.5 * kWindow_s;
    for (const MeasuredMarker& one : track.measured) track.place.head<3>() += one.position_m;
    track.place.head<3>() /= kPlaceSize_m * static_cast<double>(track.measured.size());
    tracks.push_back(std::move(track));
  }
  return tracks;
}

// Of the marker that swings farthest, measured and simulated: the lesser of both, in deviations of its noise.
double motion_of(const std::vector<Track>& tracks, const SimulatedSwing& simulated, double model_error_m) {
  double largest = 0.0;
  for (const Track& track : tracks) {
    const double seen = motion_m(track, [&](std::size_t i) { return track.measured[i].position_m; });
    const double expected =
        motion_m(track, [&](std::size_t i) { return simulated.deflection_m(track.marker, track.times_s[i]); });
    largest = std::max(largest, std::min(seen, expected) / deviation_m(track, model_error_m));
  }
  return largest;
}

std::string changes_of(double damping_s) {
  return "body: {damping: {rayleigh_stiffness_s: " + text_of(damping_s) + "}}\n";
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
    return simulate_swings(scene_, options_, lay_over(options_.changes, changes_of(start_s_ * std::exp(at))), swings_,
                           -kLeastDelay_s);
  }

  const std::string& scene_;
  const SceneOptions& options_;
  std::vector<MeasuredSwing> swings_;
  double start_s_, at_ = 0.0;
  std::vector<SimulatedSwing> now_, more_;
};

// (extent * deflection at time - delay, as the cameras see it, + mean + drift - measured) in standard deviations.
class SwingResidual : public ceres::SizedCostFunction<3, 1, 2, 6> {
 public:
  SwingResidual(const SwingPredictor& predictor, const Track& track, std::size_t sample, const Eigen::Matrix3d& turn,
                double model_error_m)
      : predictor_(predictor),
        track_(track),
        sample_(sample),
        turn_(turn),
        weight_(measured_weight(track.measured[sample], model_error_m)) {}

  Eigen::Vector3d miss_m(double const* const* parameters) const {
    const Eigen::Map<const Eigen::Vector3d> mean(parameters[2]), drift(parameters[2] + 3);
    return parameters[1][0] * (turn_ * predictor_.now(track_.swing).deflection_m(track_.marker, time_s(parameters))) +
           kPlaceSize_m * (mean + share() * drift) - track_.measured[sample_].position_m;
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
      Eigen::Map<Eigen::Matrix<double, 3, 2, Eigen::RowMajor>> swing(jacobians[1]);
      swing.col(0) = turned * here;
      swing.col(1) = -kDelaySize_s * extent * (turned * now.velocity_m_s(track_.marker, at_s));
    }
    if (jacobians[2]) {
      Eigen::Map<Eigen::Matrix<double, 3, 6, Eigen::RowMajor>> place(jacobians[2]);
      place << kPlaceSize_m * weight_, kPlaceSize_m * share() * weight_;
    }
    return true;
  }

 private:
  double time_s(double const* const* parameters) const {
    return track_.times_s[sample_] - kDelaySize_s * parameters[1][1];
  }
  double share() const { return track_.share(track_.times_s[sample_]); }

  const SwingPredictor& predictor_;
  const Track& track_;
  std::size_t sample_;
  Eigen::Matrix3d turn_, weight_;
};

struct ChosenSwings {
  std::vector<MeasuredSwing> swings;
  std::vector<Track> tracks;
};

// Those that swing farthest, in deviations, were there hardly any damping.
ChosenSwings choose(const std::string& scene, const SceneOptions& options, const std::vector<MeasuredSwing>& swings,
                    double damping_s, double model_error_m) {
  std::vector<MeasuredSwing> seen;
  for (const MeasuredSwing& swing : swings)
    if (!swing.commands.empty() && swing.seen.size() >= kSamples) seen.push_back(swing);
  if (seen.empty()) return {};
  const std::vector<SimulatedSwing> simulated =
      simulate_swings(scene, options, lay_over(options.changes, changes_of(damping_s)), seen, -kLeastDelay_s);
  const Scene loaded = load_scene(scene, options);
  std::multimap<double, std::size_t, std::greater<>> by_motion;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::vector<Track> tracks = tracks_of(seen[i], i, simulated[i], *loaded.simulation);
    const double motion = motion_of(tracks, simulated[i], model_error_m);
    if (motion >= kMotion) by_motion.emplace(motion, i);
  }
  ChosenSwings chosen;
  for (const auto& [motion, i] : by_motion) {
    if (chosen.swings.size() == kMostSwings) break;
    for (Track& track : tracks_of(seen[i], chosen.swings.size(), simulated[i], *loaded.simulation))
      chosen.tracks.push_back(std::move(track));
    chosen.swings.push_back(seen[i]);
  }
  return chosen;
}

// The bounds count as weak knowledge, as of the other parameters (fit_statistics.cpp), but of the logarithm.
FittedValue with_confidence(const DampingNumber& number, double value_s, double information) {
  constexpr double of_95_percent = 1.96, untold = 0.5;
  const double width = std::log(number.max / number.min) / (2.0 * of_95_percent);
  const double spread = 1.0 / std::sqrt(information + 1.0 / (width * width));
  FittedValue fitted;
  fitted.name = kName;
  fitted.start = number.start;
  fitted.value = value_s;
  fitted.min = number.min;
  fitted.max = number.max;
  fitted.deviation = spread * value_s;
  fitted.low = std::max(number.min, value_s * std::exp(-of_95_percent * spread));
  fitted.high = std::min(number.max, value_s * std::exp(of_95_percent * spread));
  fitted.told = spread * spread < untold * width * width;
  return fitted;
}

void append(FittedValue value, FitResult& result) {
  const auto count = static_cast<Eigen::Index>(result.values.size());
  Eigen::MatrixXd correlations = Eigen::MatrixXd::Identity(count + 1, count + 1);
  correlations.topLeftCorner(count, count) = result.correlations;
  result.correlations = correlations;
  result.values.push_back(std::move(value));
}

}  // namespace

DampingNumber damping_number(const std::string& scene, const SceneOptions& options, const FitParameter& asked) {
  const double present = load_scene(scene, options).simulation->body().viscosity().rayleigh_stiffness_s;
  DampingNumber number;
  number.min = asked.min.value_or(kMin_s);
  number.max = asked.max.value_or(kMax_s);
  number.start = asked.start.value_or(std::clamp(present > 0.0 ? present : kStart_s, number.min, number.max));
  if (!(number.min > 0.0 && number.min < number.max && std::isfinite(number.max)))
    throw std::invalid_argument("parameters: damping: bounds " + text_of(number.min) + ", " + text_of(number.max) +
                                " [s] must rise from above 0");
  if (!(number.start >= number.min && number.start <= number.max))
    throw std::invalid_argument("parameters: damping: start " + text_of(number.start) + " is not in [" +
                                text_of(number.min) + ", " + text_of(number.max) + "]");
  return number;
}

void fit_damping(const std::string& scene, const SceneOptions& asked, const std::vector<MeasuredSwing>& swings,
                 const DampingNumber& number, const FitRequest& request, FitResult& result) {
  SceneOptions options = asked;
  options.changes = result.changes;
  ChosenSwings chosen = choose(scene, options, swings, number.min, request.model_error_m);
  if (chosen.swings.empty()) {
    result.warnings.push_back(
        "damping: the data cannot tell it, as nothing swings, measured and simulated; it stays as it is");
    return;
  }
  SwingPredictor predictor(scene, options, chosen.swings, number.start);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &predictor;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  ceres::LossFunctionWrapper loss(nullptr, ceres::TAKE_OWNERSHIP);
  std::vector<Eigen::Vector2d> extent_and_delay(chosen.swings.size(), {1.0, 0.0});
  struct Sample {
    const SwingResidual* residual;
    const double* unknowns[3];
  };
  std::vector<Sample> samples;
  for (Track& track : chosen.tracks) {
    for (std::size_t i = 0; i < track.times_s.size(); ++i) {
      auto* residual =
          new SwingResidual(predictor, track, i, result.measured_from_base.linear(), request.model_error_m);
      double *swing = extent_and_delay[track.swing].data(), *place = track.place.data();
      problem.AddResidualBlock(residual, &loss, &predictor.unknown, swing, place);
      samples.push_back({residual, {&predictor.unknown, swing, place}});
    }
  }
  problem.SetParameterLowerBound(&predictor.unknown, 0, std::log(number.min / number.start));
  problem.SetParameterUpperBound(&predictor.unknown, 0, std::log(number.max / number.start));
  for (Eigen::Vector2d& swing : extent_and_delay) {
    problem.SetParameterLowerBound(swing.data(), 0, kLeastExtent);
    problem.SetParameterUpperBound(swing.data(), 0, kMostExtent);
    problem.SetParameterLowerBound(swing.data(), 1, kLeastDelay_s / kDelaySize_s);
    problem.SetParameterUpperBound(swing.data(), 1, kMostDelay_s / kDelaySize_s);
  }
  const auto rms_m = [&] {
    double squares = 0.0;
    for (const Sample& sample : samples) squares += sample.residual->miss_m(sample.unknowns).squaredNorm();
    return std::sqrt(squares / static_cast<double>(samples.size()));
  };
  const FitEnd end = solve_fit(problem, loss, request, rms_m);
  if (result.values.empty()) {  // damping alone
    result.converged = end.converged;
    result.message = end.message;
  } else if (!end.converged) {
    result.converged = false;
    result.message = "damping: " + end.message;
  }
  result.iterations += end.iterations;

  ceres::Problem::EvaluateOptions in_order;
  in_order.parameter_blocks = {&predictor.unknown};
  for (Eigen::Vector2d& swing : extent_and_delay) in_order.parameter_blocks.push_back(swing.data());
  for (Track& track : chosen.tracks) in_order.parameter_blocks.push_back(track.place.data());
  std::vector<double> residuals;
  ceres::CRSMatrix sparse;
  problem.Evaluate(in_order, nullptr, &residuals, nullptr, &sparse);
  const Eigen::MatrixXd jacobian = dense(sparse);
  const Eigen::MatrixXd others = jacobian.rightCols(jacobian.cols() - 1);
  const Eigen::VectorXd own = jacobian.col(0) - others * others.colPivHouseholderQr().solve(jacobian.col(0));
  const double squares =
      Eigen::Map<const Eigen::VectorXd>(residuals.data(), static_cast<Eigen::Index>(residuals.size())).squaredNorm();
  const double variance =
      std::max(1.0, squares / static_cast<double>(std::max<Eigen::Index>(1, jacobian.rows() - jacobian.cols())));
  const FittedValue value = with_confidence(number, predictor.damping_s(), own.squaredNorm() / variance);
  if (!value.told) result.warnings.push_back("the data cannot tell damping");
  if (value.value < 1.01 * number.min || value.value > 0.99 * number.max)
    result.warnings.push_back("damping ended on its bound " + text_of(value.value) +
                              " s; at the lower one the scene's own time step damps as much as the robot does");
  append(value, result);
  result.changes = lay_over(result.changes, changes_of(value.value));
  result.swings = static_cast<int>(chosen.swings.size());
  result.swing_rms_m = rms_m();
}

}  // namespace soft_robot_lab
