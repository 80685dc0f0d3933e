// SPDX-License-Identifier: BSD-3-Clause
#include "load_estimator.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <boost/math/distributions/chi_squared.hpp>

#include "control/refuse.h"
#include "estimator_parts.h"
#include "settings/require_in_range.h"

namespace soft_robot_lab {
namespace {

constexpr double kUnexplained = 1.0e-6;  // chance of a chi^2 so large where the estimate is right

}  // namespace

void LoadEstimationOptions::validate() const {
  const AllowedRange positive = AllowedRange::positive(), not_negative = AllowedRange::not_negative();
  require_in_range("place_spacing_m", place_spacing_m, positive);
  require_in_range("friction_coefficient", friction_coefficient, AllowedRange{0.0, 10.0});
  require_in_range("least_force_n", least_force_n, positive);
  require_in_range("most_force_n", most_force_n, AllowedRange{least_force_n, AllowedRange::any().max});
  if (!(false_alarm_rate > 0.0 && false_alarm_rate < 0.5))
    refuse("false_alarm_rate: ", false_alarm_rate, " is not in (0, 0.5)");
  require_in_range("model_error_m", model_error_m, not_negative);
  require_in_range("model_error_ratio", model_error_ratio, AllowedRange{0.0, 1.0});
  require_in_range("compliance_error", compliance_error, AllowedRange{0.0, 1.0});
  require_in_range("pose_error_m", pose_error_m, not_negative);
  require_in_range("command_error", command_error, not_negative);
  require_in_range("modulus_error", modulus_error, not_negative);
  require_in_range("pose_change_m", pose_change_m, positive);
  require_in_range("unknown_error_m", unknown_error_m, positive);
  require_in_range("observable_m", observable_m, positive);
  require_in_range("modulus_drift", modulus_drift, positive);
  require_in_range("command_drift", command_drift, positive);
}

const char* name_of(LoadKind kind) {
  switch (kind) {
    case LoadKind::none:
      return "none";
    case LoadKind::push:
      return "push";
    case LoadKind::two_pushes:
      return "two_pushes";
    case LoadKind::weight:
      return "weight";
    case LoadKind::modulus:
      return "modulus";
    case LoadKind::command:
      return "command";
    case LoadKind::frame:
      return "frame";
    case LoadKind::unknown:
      break;
  }
  return "unknown";
}

double largest_chi2(int coordinates, double chance) {
  return boost::math::quantile(boost::math::complement(boost::math::chi_squared(coordinates), chance));
}

LoadEstimator::Parts::Parts(Simulation& simulation, const LoadEstimationOptions& chosen)
    : model(simulation), options(chosen) {
  options.validate();
  if (model.markers().empty()) refuse("loads cannot be estimated: the scene has no markers");
  std::vector<PushPlace> all = push_places(model.body(), options.place_spacing_m);
  double area_m2 = 0.0;
  for (const PushPlace& place : all) area_m2 += place.area_m2;
  for (PushPlace& place : all) skin.push_back({place.at, place.area_m2 / area_m2, place, -1});
  const MeshLocator locator(model.body().mesh());
  for (const Marker& marker : model.markers())
    hooks.push_back({locator.embed(marker.rest_position_m()),
                     1.0 / static_cast<double>(model.markers().size()),
                     {},
                     static_cast<int>(hooks.size())});
  estimated = model.state();
}

LoadPrior LoadEstimator::Parts::prior() const {
  const Eigen::Vector3d& gravity = model.body().gravity_m_s2();
  const Eigen::Vector3d down = gravity.isZero(0.0) ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : gravity.normalized();
  return {model.body().mesh(),
          down,
          options.friction_coefficient,
          {options.least_force_n, std::sqrt(options.least_force_n * options.most_force_n), options.most_force_n}};
}

SeenCoordinates LoadEstimator::Parts::check(const std::vector<MeasuredMarker>& measured) const {
  SeenCoordinates seen;
  std::set<std::string> names;
  for (const MeasuredMarker& marker : measured) {
    const int index = model.marker_index(marker.name);
    if (!names.insert(marker.name).second) refuse("marker '", marker.name, "' is measured twice");
    const Eigen::Matrix3d& covariance_m2 = marker.covariance_m2;
    if (!marker.position_m.allFinite() || !covariance_m2.allFinite())
      refuse("marker '", marker.name, "': position or covariance is not finite");
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance_m2, Eigen::EigenvaluesOnly);
    if (!(axes.eigenvalues()[0] >= -1e-6 * std::abs(axes.eigenvalues()[2])))
      refuse("marker '", marker.name, "': its covariance is not positive semi-definite");
    seen.markers.push_back(index);
    seen.positions_m.push_back(marker.position_m);
    seen.covariances_m2.push_back(covariance_m2);
  }
  return seen;
}

Eigen::VectorXd LoadEstimator::Parts::gap_m(const SeenCoordinates& seen) const {
  Eigen::VectorXd gap(seen.coordinates());
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    const auto offset = offsets.find(seen.markers[i]);
    Eigen::Vector3d here_m = seen.positions_m[i] - model.marker_position(seen.markers[i]);
    if (offset != offsets.end()) here_m -= offset->second.offset_m;
    gap.segment<3>(3 * static_cast<Eigen::Index>(i)) = here_m;
  }
  return gap;
}

double LoadEstimator::Parts::pose_change(const SeenCoordinates& seen) const {
  double most = 0.0;
  for (const int marker : seen.markers) {
    const auto offset = offsets.find(marker);
    if (offset == offsets.end()) continue;
    const double way_m = (model.marker_position(marker) - offset->second.modelled_m).norm();
    most = std::max(most, std::min(1.0, way_m / options.pose_change_m));
  }
  return most;
}

UnloadedChanges LoadEstimator::Parts::changes(const SeenCoordinates& seen) {
  const auto seen_rows = [&](const Eigen::MatrixXd& of_all) {
    Eigen::MatrixXd rows(seen.coordinates(), of_all.cols());
    for (std::size_t i = 0; i < seen.markers.size(); ++i)
      rows.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = of_all.middleRows<3>(3 * seen.markers[i]);
    return rows;
  };
  Eigen::MatrixXd slipped_m;
  UnloadedChanges result;
  result.by_modulus = model.body().material().youngs_modulus_pa *
                      seen_rows(model.parameter_sensitivities({{"youngs_modulus_pa", {}}}, slipped_m));
  result.by_commands = seen_rows(model.marker_sensitivities());
  for (Eigen::Index i = 0; i < result.by_commands.cols(); ++i) {
    const CommandLimits& limits = model.actuators()[static_cast<std::size_t>(i)]->limits();
    result.ranges.push_back(std::isfinite(limits.max - limits.min) ? limits.max - limits.min : 1.0);
    result.by_commands.col(i) *= result.ranges.back();
  }
  return result;
}

// `moved_m`: how far loads are taken to have moved the coordinates. The model stands where the robot does without them.
Eigen::MatrixXd LoadEstimator::Parts::whitening(const SeenCoordinates& seen,
                                                const std::optional<UnloadedChanges>& changes,
                                                const Eigen::VectorXd& moved_m) const {
  // A wrong compliance moves all markers by the same share of their way.
  Eigen::MatrixXd variance_m2 = options.compliance_error * options.compliance_error * moved_m * moved_m.transpose();
  const auto square = [](double value) { return value * value; };
  const double changed = pose_change(seen);
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    const Eigen::Index row = 3 * static_cast<Eigen::Index>(i);
    Eigen::Matrix3d of_marker_m2 = seen.covariances_m2[i];
    const auto offset = offsets.find(seen.markers[i]);
    double error_m2 = square(options.model_error_ratio) * moved_m.segment<3>(row).squaredNorm();
    if (offset == offsets.end()) {
      error_m2 += square(options.unknown_error_m);
    } else {
      error_m2 += square(options.model_error_m) + square(options.pose_error_m * changed);
      of_marker_m2 += offset->second.covariance_m2;
    }
    variance_m2.block<3, 3>(row, row) += of_marker_m2 + std::max(error_m2, 1e-16) * Eigen::Matrix3d::Identity();
  }
  if (changed > 0.0)
    variance_m2 += square(changed * options.modulus_error) * changes->by_modulus * changes->by_modulus.transpose() +
                   square(changed * options.command_error) * changes->by_commands * changes->by_commands.transpose();
  return variance_m2.llt().matrixL().solve(Eigen::MatrixXd::Identity(variance_m2.rows(), variance_m2.cols()));
}

void LoadEstimator::Parts::conclude(const SeenCoordinates& seen, const UnloadedChanges& changes,
                                    const std::vector<LoadHypothesis>& all, LoadEstimate& result) {
  for (const LoadHypothesis& each : all) {
    const auto [known, added] = result.log_evidence.emplace(each.kind, each.log_evidence);
    if (!added) known->second = std::max(known->second, each.log_evidence);
  }
  const LoadHypothesis& best = *std::max_element(
      all.begin(), all.end(),
      [](const LoadHypothesis& a, const LoadHypothesis& b) { return a.log_evidence < b.log_evidence; });
  double others = 0.0;
  for (const LoadHypothesis& each : all) others += std::exp(each.log_evidence - best.log_evidence);
  result.kind = best.kind;
  result.probability = 1.0 / others;
  result.chi2 = best.chi2;
  const double most = largest_chi2(static_cast<int>(seen.coordinates()), kUnexplained);
  if (best.chi2 > most) {
    result.kind = LoadKind::unknown;
    result.message = std::string("what was measured fits no load: the nearest is ") + name_of(best.kind) +
                     " with chi^2 " + std::to_string(best.chi2) + ", beyond " + std::to_string(most);
    return;
  }
  if (best.solution) {
    const std::vector<LoadPlace>& places = best.kind == LoadKind::weight ? hooks : skin;
    for (std::size_t i = 0; i < best.solution->loads.size(); ++i)
      result.loads.push_back(describe(*best.solution, i, places));
    estimated = best.solution->state;
  } else if (best.kind == LoadKind::modulus) {
    result.change = options.modulus_drift * best.numbers[0];
  } else if (best.kind == LoadKind::command) {
    const Actuator& actuator = *model.actuators()[static_cast<std::size_t>(best.actuator)];
    result.actuator = actuator.name();
    result.change = options.command_drift * changes.ranges[static_cast<std::size_t>(best.actuator)] * best.numbers[0];
  }
}

LoadEstimator::LoadEstimator(Simulation& model, const LoadEstimationOptions& options)
    : parts_(std::make_unique<Parts>(model, options)) {}
LoadEstimator::~LoadEstimator() = default;

void LoadEstimator::take_offsets(const std::vector<MeasuredMarker>& measured) {
  Parts& p = *parts_;
  const SeenCoordinates seen = p.check(measured);
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    const Eigen::Vector3d modelled_m = p.model.marker_position(seen.markers[i]);
    p.offsets[seen.markers[i]] = {seen.positions_m[i] - modelled_m, modelled_m, seen.covariances_m2[i]};
  }
}

LoadEstimate LoadEstimator::estimate(const std::vector<MeasuredMarker>& measured) {
  Parts& p = *parts_;
  const SeenCoordinates seen = p.check(measured);
  LoadEstimate result;
  p.untouched = p.estimated = p.model.state();
  result.coordinates = static_cast<int>(seen.coordinates());
  if (seen.markers.empty()) {
    result.kind = LoadKind::unknown;
    result.message = "no marker is seen";
  } else {
    const Eigen::VectorXd gap_m = p.gap_m(seen);
    std::optional<UnloadedChanges> changes;  // solved for where they are needed
    if (p.pose_change(seen) > 0.0) changes = p.changes(seen);
    const Eigen::VectorXd still_m = Eigen::VectorXd::Zero(gap_m.size());
    result.chi2_unloaded = result.chi2 = (p.whitening(seen, changes, still_m) * gap_m).squaredNorm();
    if (result.chi2_unloaded > largest_chi2(result.coordinates, p.options.false_alarm_rate)) {
      const Eigen::MatrixXd whitening = p.whitening(seen, changes, gap_m);
      if (!changes) changes = p.changes(seen);
      const LinearisedLoads unloaded = p.linearise(seen, whitening, {}, {});
      std::vector<LoadHypothesis> all;
      p.add_changes(seen, *changes, whitening, unloaded, all);
      p.add_loads(seen, whitening, unloaded, all);
      p.model.pull({});
      p.model.set_state(p.untouched);
      p.conclude(seen, *changes, all, result);
    }
  }
  for (std::size_t i = 0; i < p.model.markers().size(); ++i) {
    Eigen::Vector3d position_m = p.model.markers()[i].position(p.estimated.positions_m);
    const auto offset = p.offsets.find(static_cast<int>(i));
    if (offset != p.offsets.end()) position_m += offset->second.offset_m;
    result.markers_m[p.model.markers()[i].name()] = position_m;
  }
  return result;
}

const SimulationState& LoadEstimator::estimated_state() const { return parts_->estimated; }

}  // namespace soft_robot_lab
