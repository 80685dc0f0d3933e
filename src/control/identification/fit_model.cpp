// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/identification/fit_model.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <ceres/ceres.h>

#include "fit_creep.h"
#include "fit_damping.h"
#include "fit_parameters.h"
#include "fit_solver.h"
#include "fit_statistics.h"
#include "measured_weight.h"
#include "pose_model.h"
#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

void require(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument(what);
}

// Predictions at the point where Ceres asks next: all poses at once, as each follows from the one before.
class Predictor : public ceres::EvaluationCallback {
 public:
  Predictor(const FitParameters& parameters, PoseModel& model, const std::vector<double>& unknowns)
      : parameters_(parameters), model_(model), unknowns_(unknowns) {}

  void PrepareForEvaluation(bool derivatives, bool) override {
    const Eigen::VectorXd asked = values(unknowns_);
    if (differentiated_.is_at(asked)) now_ = differentiated_;
    if (now_.is_at(asked) && (!derivatives || differentiated_.is_at(asked))) return;
    now_ = {asked, {}};
    try {
      now_.poses = model_.predict(
          parameters_.overrides(asked),
          derivatives ? [this](const Simulation& simulation) { return parameters_.model_parameters(simulation); }
                      : PoseModel::Parameters{},
          parameters_.backlash_m(asked));
      if (derivatives) differentiated_ = now_;
    } catch (const std::runtime_error& error) {  // no equilibrium there; a shorter step may have one
      trouble_ = error.what();
    }
  }

  // Unknowns are measured from the start in steps of about one.
  Eigen::VectorXd values(const std::vector<double>& unknowns) const {
    Eigen::VectorXd all(static_cast<Eigen::Index>(unknowns.size()));
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      const FitNumber& number = parameters_.numbers()[i];
      all[static_cast<Eigen::Index>(i)] = std::clamp(number.start + unknowns[i] * number.size, number.min, number.max);
    }
    return all;
  }

  Eigen::Vector3d measured(std::size_t pose, Eigen::Index marker) const {
    return parameters_.measured_from_base(now_.at) * now_.poses[pose].markers_m.col(marker);
  }

  // d measured / d unknown.
  Eigen::Matrix3Xd jacobian(std::size_t pose, Eigen::Index marker) const {
    const PosePrediction& here = now_.poses[pose];
    return parameters_.measured_jacobian(now_.at, here.markers_m.col(marker), here.jacobian.middleRows<3>(3 * marker));
  }

  bool good() const { return !now_.poses.empty(); }
  const std::string& trouble() const { return trouble_; }

 private:
  struct Point {
    bool is_at(const Eigen::VectorXd& place) const { return at.size() == place.size() && at == place; }
    Eigen::VectorXd at;
    std::vector<PosePrediction> poses;  // none where there is no equilibrium
  };

  const FitParameters& parameters_;
  PoseModel& model_;
  const std::vector<double>& unknowns_;
  Point now_, differentiated_;  // the latter the last with derivatives: where steps in vain come back to
  std::string trouble_;
};

// (model - measured) in standard deviations.
class MarkerResidual : public ceres::CostFunction {
 public:
  MarkerResidual(const Predictor& predictor, std::size_t pose, Eigen::Index marker, const MeasuredMarker& measured,
                 double model_error_m, int unknowns)
      : predictor_(predictor),
        pose_(pose),
        marker_(marker),
        measured_m_(measured.position_m),
        weight_(measured_weight(measured, model_error_m)) {
    set_num_residuals(3);
    mutable_parameter_block_sizes()->push_back(unknowns);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    if (!predictor_.good()) return false;
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = weight_ * (predictor_.measured(pose_, marker_) - measured_m_);
    if (jacobians && jacobians[0])
      Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>(
          jacobians[0], 3, parameter_block_sizes()[0]) = weight_ * predictor_.jacobian(pose_, marker_);
    return true;
  }

 private:
  const Predictor& predictor_;
  std::size_t pose_;
  Eigen::Index marker_;
  Eigen::Vector3d measured_m_;
  Eigen::Matrix3d weight_;
};

ModelGap gap_of(const std::vector<MeasuredPose>& poses,
                const std::function<Eigen::Vector3d(std::size_t, Eigen::Index)>& modelled) {
  ModelGap gap;
  std::map<std::string, int> counts;
  int count = 0;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    for (std::size_t m = 0; m < poses[p].markers.size(); ++m) {
      const MeasuredMarker& marker = poses[p].markers[m];
      const double squared = (modelled(p, static_cast<Eigen::Index>(m)) - marker.position_m).squaredNorm();
      gap.rms_m += squared;
      gap.marker_rms_m[marker.name] += squared;
      ++counts[marker.name];
      ++count;
    }
  }
  gap.rms_m = std::sqrt(gap.rms_m / std::max(1, count));
  for (auto& [name, rms] : gap.marker_rms_m) rms = std::sqrt(rms / counts[name]);
  return gap;
}

// [m], of each pose; 0 for one without markers.
std::vector<double> pose_gaps_m(const std::vector<MeasuredPose>& poses, const Predictor& predictor) {
  std::vector<double> gaps_m;
  for (std::size_t p = 0; p < poses.size(); ++p)
    gaps_m.push_back(gap_of({poses[p]}, [&](std::size_t, Eigen::Index m) { return predictor.measured(p, m); }).rms_m);
  return gaps_m;
}

// What is identified by rest states; `unknowns` are where it starts, and then what it found.
FitResult fit_to_rest(const FitParameters& parameters, const std::string& scene, const SceneOptions& options,
                      const std::vector<MeasuredPose>& poses, const FitRequest& request,
                      std::vector<double>& unknowns) {
  PoseModel model(scene, options, poses);
  const int unknown_count = static_cast<int>(parameters.numbers().size());
  Predictor predictor(parameters, model, unknowns);

  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &predictor;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  ceres::LossFunctionWrapper loss(nullptr, ceres::TAKE_OWNERSHIP);
  int residuals = 0;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    for (std::size_t m = 0; m < poses[p].markers.size(); ++m, residuals += 3)
      problem.AddResidualBlock(new MarkerResidual(predictor, p, static_cast<Eigen::Index>(m), poses[p].markers[m],
                                                  request.model_error_m, unknown_count),
                               &loss, unknowns.data());
  }
  require(residuals > 0, "poses: the robot is nowhere at rest with markers seen; allowed: at least one such pose");
  require(residuals > unknown_count, "poses: " + std::to_string(residuals) + " coordinates cannot identify " +
                                         std::to_string(unknown_count) + " parameters");
  for (int i = 0; i < unknown_count; ++i) {
    const FitNumber& number = parameters.numbers()[static_cast<std::size_t>(i)];
    problem.SetParameterLowerBound(unknowns.data(), i, (number.min - number.start) / number.size);
    problem.SetParameterUpperBound(unknowns.data(), i, (number.max - number.start) / number.size);
  }

  const auto gap_now = [&] {
    return gap_of(poses, [&](std::size_t p, Eigen::Index m) { return predictor.measured(p, m); });
  };
  FitResult result;
  predictor.PrepareForEvaluation(true, true);
  if (!predictor.good()) throw std::runtime_error("the scene as it is has no equilibrium: " + predictor.trouble());
  result.before = gap_now();
  const std::vector<double> before_m = pose_gaps_m(poses, predictor);
  const FitEnd end = solve_fit(problem, loss, request, [&] { return gap_now().rms_m; });
  result.converged = end.converged;
  result.message = end.message;
  result.iterations = end.iterations;

  ceres::CRSMatrix jacobian;
  std::vector<double> scaled;
  double cost = 0.0;
  predictor.PrepareForEvaluation(true, true);
  if (!predictor.good()) throw std::runtime_error("the fitted scene has no equilibrium: " + predictor.trouble());
  problem.Evaluate({}, &cost, &scaled, nullptr, &jacobian);
  result.after = gap_now();
  add_configurations(poses, before_m, pose_gaps_m(poses, predictor), request, result);
  const Eigen::VectorXd values = predictor.values(unknowns);
  result.measured_from_base = parameters.measured_from_base(values);
  result.overrides = parameters.overrides(values);
  result.backlash_m = parameters.backlash_m(values);
  add_statistics(parameters, values, dense(jacobian), scaled, result);
  return result;
}

// Rest states creep on, and creep is measured on the robot that they fit: one after the other, three times.
FitResult fit_with_creep(const FitParameters& parameters, const std::string& scene, const SceneOptions& options,
                         const std::vector<MeasuredPose>& poses, const FitRequest& request) {
  constexpr int rounds = 3;
  CreepFit creep(scene, options, poses, parameters.creep());
  std::vector<double> unknowns(parameters.numbers().size(), 0.0);
  FitResult result = fit_to_rest(parameters, scene, options, poses, request, unknowns);
  const FitResult first = result;
  for (int round = 0; round < rounds; ++round) {
    creep.run(request, result);
    result = fit_to_rest(parameters, scene, options, creep.as_at_rest(result), request, unknowns);
  }
  result.before = first.before;
  for (std::size_t i = 0; i < result.configurations.size(); ++i)
    result.configurations[i].before_m = first.configurations[i].before_m;
  creep.finish(result);
  return result;
}

}  // namespace

void FitRequest::validate() const {
  require(std::isfinite(model_error_m) && model_error_m >= 0.0, "model_error_m must be in [0, inf)");
  require(std::isfinite(outlier_deviations) && outlier_deviations > 0.0, "outlier_deviations must be in (0, inf)");
  require(!mass_kg || (std::isfinite(*mass_kg) && *mass_kg > 0.0), "mass_kg must be in (0, inf)");
  require(max_iterations >= 1 && max_iterations <= 1000, "max_iterations must be in [1, 1000]");
  require(!parameters.empty(), "parameters: none are given");
  const bool density = std::any_of(parameters.begin(), parameters.end(),
                                   [](const FitParameter& parameter) { return parameter.name == "density_kg_m3"; });
  require(!(mass_kg && density), "parameters: density_kg_m3 follows from mass_kg; give one of them");
}

FitResult fit_model(const std::string& scene, const SceneOptions& asked, const std::vector<MeasuredPose>& poses,
                    const FitRequest& request, const std::vector<MeasuredSwing>& swings) {
  request.validate();
  const SceneOptions options = request.mass_kg ? weighed(scene, asked, *request.mass_kg) : asked;
  const double start_cpu_s = cpu_time_s();
  const FitParameters parameters(scene, options, request.parameters);
  FitResult result;
  require(parameters.creep().empty() || !parameters.numbers().empty(),
          "parameters: creep is fitted beside others only, such as youngs_modulus_pa");
  if (parameters.numbers().empty()) {
    result.overrides = options.overrides;
    result.before = result.after = model_gap(scene, options, poses);
  } else if (parameters.creep().empty()) {
    std::vector<double> unknowns(parameters.numbers().size(), 0.0);
    result = fit_to_rest(parameters, scene, options, poses, request, unknowns);
  } else {
    result = fit_with_creep(parameters, scene, options, poses, request);
  }
  if (parameters.damping()) fit_damping(scene, options, swings, *parameters.damping(), request, result);
  require(!result.values.empty(),
          "parameters: none that data could identify; damping is identified by a robot that swings");
  result.cpu_s = cpu_time_s() - start_cpu_s;
  return result;
}

ModelGap model_gap(const std::string& scene, const SceneOptions& options, const std::vector<MeasuredPose>& poses,
                   const Eigen::Isometry3d& measured_from_base, const std::map<std::string, double>& backlash_m) {
  const std::vector<PosePrediction> predicted =
      PoseModel(scene, options, poses).predict(options.overrides, {}, backlash_m);
  return gap_of(poses, [&](std::size_t p, Eigen::Index m) -> Eigen::Vector3d {
    return measured_from_base * predicted[p].markers_m.col(m);
  });
}

}  // namespace soft_robot_lab
