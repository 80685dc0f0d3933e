// SPDX-License-Identifier: BSD-3-Clause
#include "fit_creep.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <stdexcept>

#include <ceres/ceres.h>

#include "creep_model.h"
#include "fit_statistics.h"
#include "measured_weight.h"
#include "pose_model.h"

namespace soft_robot_lab {
namespace {

constexpr double kSettled_s = 1.0;       // after the drives stood: what swings has died away
constexpr double kLogarithmStep = 0.02;  // of a logarithm
constexpr int kMostIterations = 10;

Overrides with_creep(Overrides overrides, const Eigen::VectorXd& values) {
  return overrides.set({"body", "hysteresis", "stiffness_ratio"}, values[0])
      .set({"body", "hysteresis", "relaxation_time_s"}, values[1]);
}

const MeasuredMarker* find_marker(const MarkersAt& seen, const std::string& name) {
  for (const MeasuredMarker& marker : seen.markers)
    if (marker.name == name) return &marker;
  return nullptr;
}

// One marker while one command was held.
struct CreepTrack {
  std::size_t pose;
  int marker;  // of the scene
  std::vector<double> times_s;
  std::vector<Eigen::Vector3d> moved_m;  // from their mean
  std::vector<Eigen::Matrix3d> weights;
};

CreepTrack track_of(const MeasuredPose& pose, const std::string& name, double from_s, double model_error_m) {
  CreepTrack track;
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  for (const MarkersAt& seen : pose.seen) {
    const MeasuredMarker* marker = seen.time_s < from_s ? nullptr : find_marker(seen, name);
    if (!marker) continue;
    track.times_s.push_back(seen.time_s);
    track.moved_m.push_back(marker->position_m);
    track.weights.push_back(measured_weight(*marker, model_error_m));
    sum_m += marker->position_m;
  }
  for (Eigen::Vector3d& moved_m : track.moved_m) moved_m -= sum_m / static_cast<double>(track.moved_m.size());
  return track;
}

std::vector<CreepTrack> tracks_of(const std::vector<MeasuredPose>& poses, const std::vector<SimulatedHold>& holds,
                                  const Simulation& simulation, double model_error_m) {
  std::vector<CreepTrack> tracks;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    for (std::size_t m = 0; m < simulation.markers().size(); ++m) {
      CreepTrack track =
          track_of(poses[p], simulation.markers()[m].name(), holds[p].arrived_s + kSettled_s, model_error_m);
      if (track.times_s.size() < 2) continue;
      track.pose = p;
      track.marker = static_cast<int>(m);
      tracks.push_back(std::move(track));
    }
  }
  return tracks;
}

// What both numbers' logarithms say about all tracks, each from its own mean: where it stands is of other numbers.
class CreepResidual : public ceres::CostFunction {
 public:
  CreepResidual(const std::vector<CreepTrack>& tracks, Eigen::Matrix3d turn,
                std::function<std::vector<SimulatedHold>(const Eigen::Vector2d&)> simulate)
      : tracks_(tracks), turn_(std::move(turn)), simulate_(std::move(simulate)) {
    int count = 0;
    for (const CreepTrack& track : tracks_) count += 3 * static_cast<int>(track.times_s.size());
    set_num_residuals(count);
    mutable_parameter_block_sizes()->push_back(2);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Vector2d at(parameters[0]);
    try {
      const bool differentiate = jacobians && jacobians[0];
      std::vector<std::future<Eigen::VectorXd>> beside;
      for (int i = 0; differentiate && i < 2; ++i)
        beside.push_back(std::async(std::launch::async,
                                    [this, at, i] { return misses(at + kLogarithmStep * Eigen::Vector2d::Unit(i)); }));
      if (at != known_at_) known_ = misses(at);
      known_at_ = at;
      Eigen::Map<Eigen::VectorXd>(residuals, known_.size()) = known_;
      if (!differentiate) return true;
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>> jacobian(jacobians[0], known_.size(), 2);
      for (int i = 0; i < 2; ++i)
        jacobian.col(i) = (beside[static_cast<std::size_t>(i)].get() - known_) / kLogarithmStep;
    } catch (const std::runtime_error&) {  // a step that does not converge; a shorter way may
      return false;
    }
    return true;
  }

 private:
  Eigen::VectorXd misses(const Eigen::Vector2d& logarithms) const {
    const std::vector<SimulatedHold> holds = simulate_(logarithms);
    Eigen::VectorXd all(num_residuals());
    Eigen::Index row = 0;
    for (const CreepTrack& track : tracks_) {
      Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(track.times_s.size()));
      for (Eigen::Index i = 0; i < places.cols(); ++i)
        places.col(i) = holds[track.pose].at(track.marker, track.times_s[static_cast<std::size_t>(i)]);
      const Eigen::Vector3d mean = places.rowwise().mean();
      for (Eigen::Index i = 0; i < places.cols(); ++i, row += 3) {
        const auto k = static_cast<std::size_t>(i);
        all.segment<3>(row) = track.weights[k] * (turn_ * (places.col(i) - mean) - track.moved_m[k]);
      }
    }
    return all;
  }

  const std::vector<CreepTrack>& tracks_;
  Eigen::Matrix3d turn_;
  std::function<std::vector<SimulatedHold>(const Eigen::Vector2d&)> simulate_;
  // The last place, which is asked for twice: by what it misses, then for derivatives too.
  mutable Eigen::Vector2d known_at_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  mutable Eigen::VectorXd known_;
};

}  // namespace

CreepFit::CreepFit(std::string scene, SceneOptions options, const std::vector<MeasuredPose>& poses,
                   std::vector<FitNumber> numbers)
    : scene_(std::move(scene)),
      options_(std::move(options)),
      poses_(poses),
      numbers_(std::move(numbers)),
      values_(Eigen::Vector2d(numbers_[0].start, numbers_[1].start)) {
  std::size_t seen = 0;
  for (const MeasuredPose& pose : poses_) {
    if (!(pose.held_s > 0.0))
      throw std::invalid_argument("parameters: creep: of a pose it is not known how long its command was held");
    seen += pose.seen.size();
  }
  if (seen < 2) throw std::invalid_argument("parameters: creep: no markers were seen while commands were held");
}

void CreepFit::run(const FitRequest& request, const FitResult& result) {
  const auto simulate = [&](const Eigen::Vector2d& logarithms) {
    SceneOptions options = options_;
    options.overrides = with_creep(result.overrides, logarithms.array().exp().matrix());
    return simulate_holds(scene_, options, poses_, result.backlash_m);
  };
  Eigen::Vector2d unknowns = values_.array().log();
  const std::vector<SimulatedHold> holds = simulate(unknowns);
  const std::vector<CreepTrack> tracks =
      tracks_of(poses_, holds, *load_scene(scene_, options_).simulation, request.model_error_m);
  if (tracks.empty())
    throw std::invalid_argument("parameters: creep: no marker was seen twice while a command was held");

  ceres::Problem problem;
  problem.AddResidualBlock(new CreepResidual(tracks, result.measured_from_base.linear(), simulate), nullptr,
                           unknowns.data());
  for (int i = 0; i < 2; ++i) {
    problem.SetParameterLowerBound(unknowns.data(), i, std::log(numbers_[static_cast<std::size_t>(i)].min));
    problem.SetParameterUpperBound(unknowns.data(), i, std::log(numbers_[static_cast<std::size_t>(i)].max));
  }
  ceres::Solver::Options solver;
  solver.max_num_iterations = kMostIterations;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.function_tolerance = 1e-4;
  solver.parameter_tolerance = 1e-3;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  converged_ = summary.termination_type == ceres::CONVERGENCE;
  message_ = summary.message;

  ceres::CRSMatrix sparse;
  std::vector<double> residuals;
  problem.Evaluate({}, nullptr, &residuals, nullptr, &sparse);
  const Eigen::MatrixXd jacobian = dense(sparse);
  values_ = unknowns.array().exp();
  information_ = jacobian.transpose() * jacobian / residual_variance(residuals, 2);
}

// By how far the model, held as long, is then from its rest states: it creeps on, and where cables rub, how it swung on
// its way there counts.
std::vector<MeasuredPose> CreepFit::as_at_rest(const FitResult& result) const {
  SceneOptions options = options_;
  options.overrides = with_creep(result.overrides, values_);
  const Scene loaded = load_scene(scene_, options);
  const std::vector<SimulatedHold> holds = simulate_holds(scene_, options, poses_, result.backlash_m);
  const std::vector<PosePrediction> rests =
      PoseModel(scene_, options_, poses_).predict(result.overrides, {}, result.backlash_m);
  std::vector<MeasuredPose> poses = poses_;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    for (std::size_t m = 0; m < poses[p].markers.size(); ++m) {
      MeasuredMarker& marker = poses[p].markers[m];
      const int index = loaded.simulation->marker_index(marker.name);
      marker.position_m -=
          result.measured_from_base.linear() * (holds[p].mean(index, poses[p].rest_from_s, poses[p].held_s) -
                                                rests[p].markers_m.col(static_cast<Eigen::Index>(m)));
    }
  }
  return poses;
}

void CreepFit::finish(FitResult& result) const {
  add_by_logarithms(numbers_, values_, information_, result);
  for (std::size_t i = result.values.size() - 2; i < result.values.size(); ++i)
    if (!result.values[i].identifiable) result.warnings.push_back("the data cannot identify " + result.values[i].name);
  result.overrides = with_creep(result.overrides, values_);
  if (converged_) return;
  result.converged = false;
  result.message = "creep: " + message_;
}

}  // namespace soft_robot_lab
