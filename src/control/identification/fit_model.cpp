// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/identification/fit_model.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "fit_damping.h"
#include "fit_in_time.h"
#include "fit_parameters.h"
#include "fit_statistics.h"
#include "measured_weight.h"
#include "pose_model.h"
#include "sight_fit.h"
#include "settings/cpu_time.h"
#include "settings/limits.h"
#include "settings/require.h"

namespace soft_robot_lab {
namespace {

// What is identified by rest states; `unknowns` are where it starts, and then what it found.
FitResult fit_to_rest(const FitParameters& parameters, const std::string& scene, const SceneOptions& options,
                      const std::vector<MeasuredPose>& poses, const FitRequest& request,
                      std::vector<double>& unknowns) {
  PoseModel model(scene, options, poses);
  const auto numbers_of = [&](const Simulation& simulation) { return parameters.model_parameters(simulation); };
  SightFit fit(
      parameters, parameters.numbers(),
      [&](const Eigen::VectorXd& values, bool derivatives) {
        return model.predict(parameters.overrides(values),
                             derivatives ? PoseModel::Parameters(numbers_of) : PoseModel::Parameters{},
                             parameters.backlash_m(values));
      },
      unknowns);
  const Eigen::Matrix3Xd creep_m = still_to_come_m(poses);
  Eigen::VectorXd unseen(creep_m.size());
  Eigen::Index at = 0;
  for (std::size_t p = 0; p < poses.size(); ++p)
    for (std::size_t m = 0; m < poses[p].markers.size(); ++m) {
      const Eigen::Matrix3d weight = measured_weight(poses[p].markers[m], request.model_error_m);
      fit.add({{p, static_cast<Eigen::Index>(m)}}, Eigen::VectorXd::Ones(1), poses[p].markers[m].position_m, weight);
      unseen.segment<3>(3 * at) = weight * creep_m.col(at);
      ++at;
    }
  FitResult result = fit.solve(poses, request);
  const Eigen::VectorXd values = fit.values();
  result.measured_from_base = parameters.measured_from_base(values);
  result.backlash_m = parameters.backlash_m(values);
  add_statistics(parameters, values, fit.jacobian(), fit.residuals(), fit.robust_shares().cwiseProduct(unseen), result);
  result.overrides = parameters.overrides(values, unidentified(result));
  return result;
}

// Rest states say where a fit in time starts.
FitResult fit_with_creep(const FitParameters& parameters, const std::string& scene, const SceneOptions& options,
                         const std::vector<MeasuredPose>& poses, const FitRequest& request) {
  std::vector<double> unknowns(parameters.numbers().size(), 0.0);
  const FitResult first = fit_to_rest(parameters, scene, options, poses, request, unknowns);
  FitResult result = fit_in_time(parameters, scene, options, poses, request, unknowns);
  result.before = first.before;
  for (std::size_t i = 0; i < result.configurations.size(); ++i)
    result.configurations[i].before_m = first.configurations[i].before_m;
  for (std::size_t i = 0; i < parameters.numbers().size(); ++i) result.values[i].start = first.values[i].start;
  result.iterations += first.iterations;
  return result;
}

// What was found before an interrupt stays.
void add_damping(const std::string& scene, const SceneOptions& options, const std::vector<MeasuredSwing>& swings,
                 const FitNumber& damping, const FitRequest& request, FitResult& result) {
  const auto interrupted = [&] { return options.interrupt && options.interrupt() && !result.values.empty(); };
  const FitResult at_rest = result;
  try {
    if (!interrupted()) return fit_damping(scene, options, swings, damping, request, result);
  } catch (const std::runtime_error&) {
    if (!interrupted()) throw;
    result = at_rest;
  }
  result.converged = false;
  result.message = "interrupted before damping was fitted";
}

}  // namespace

void FitRequest::validate() const {
  require(std::isfinite(model_error_m) && model_error_m >= 0.0, "model_error_m must be in [0, inf)");
  require(std::isfinite(outlier_deviations) && outlier_deviations > 0.0, "outlier_deviations must be in (0, inf)");
  require(!mass_kg || (*mass_kg >= kLeastMass_kg && *mass_kg <= limits::kMass_kg), "mass_kg must be in [1e-06, 1e+06]");
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
    warn_of_creep(poses, request, result);
  } else {
    result = fit_with_creep(parameters, scene, options, poses, request);
  }
  if (parameters.damping()) add_damping(scene, options, swings, *parameters.damping(), request, result);
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
