// SPDX-License-Identifier: BSD-3-Clause
#include "fit_in_time.h"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/QR>

#include "fit_statistics.h"
#include "hold_model.h"
#include "measured_weight.h"
#include "sight_fit.h"

namespace soft_robot_lab {
namespace {

constexpr double kLongEnough = 2.0;  // times the relaxation time
constexpr double kSettled_s = 1.0;   // after the drives stood: what swings has died away

void require_seen_while_held(const std::vector<MeasuredPose>& poses) {
  std::size_t seen = 0;
  for (const MeasuredPose& pose : poses) {
    if (!(pose.held_s > 0.0))
      throw std::invalid_argument("parameters: creep: of a pose it is not known how long its command was held");
    seen += pose.seen.size();
  }
  if (seen < 2) throw std::invalid_argument("parameters: creep: no markers were seen while commands were held");
}

// One marker while one command was held: it counts by its mean, and by how it moves about that.
struct Track {
  std::vector<SeenAt> parts;
  std::vector<const MeasuredMarker*> markers;
};

// `first_sight` is that of the pose's first short time.
std::map<std::string, Track> tracks_of(const MeasuredPose& pose, std::size_t first_sight, double from_s) {
  std::map<std::string, Track> tracks;
  for (std::size_t s = 0; s < pose.seen.size(); ++s) {
    if (pose.seen[s].time_s < from_s) continue;
    const std::vector<MeasuredMarker>& markers = pose.seen[s].markers;
    for (std::size_t m = 0; m < markers.size(); ++m) {
      Track& track = tracks[markers[m].name];
      track.parts.push_back({first_sight + s, static_cast<Eigen::Index>(m)});
      track.markers.push_back(&markers[m]);
    }
  }
  return tracks;
}

// Errors of one place are alike, so the mean of a track is not much surer than one sight of it.
void add_track(const Track& track, double model_error_m, SightFit& fit) {
  const auto count = static_cast<Eigen::Index>(track.parts.size());
  MeasuredMarker mean{"", Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  for (const MeasuredMarker* marker : track.markers) {
    mean.position_m += marker->position_m / static_cast<double>(count);
    mean.covariance_m2 += marker->covariance_m2 / static_cast<double>(count);
  }
  const Eigen::VectorXd shares = Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count));
  fit.add(track.parts, shares, mean.position_m, measured_weight(mean, model_error_m));
  for (Eigen::Index i = 0; count > 1 && i < count; ++i) {
    const MeasuredMarker& marker = *track.markers[static_cast<std::size_t>(i)];
    fit.add(track.parts, Eigen::VectorXd::Unit(count, i) - shares, marker.position_m - mean.position_m,
            measured_weight(marker, model_error_m));
  }
}

// Returns how many markers were seen moving.
int add_pose(const std::vector<MeasuredPose>& poses, std::size_t p, std::size_t first_sight, double from_s,
             double model_error_m, SightFit& fit) {
  int moving = 0;
  const std::map<std::string, Track> tracks = tracks_of(poses[p], first_sight, from_s);
  for (const auto& [name, track] : tracks) {
    add_track(track, model_error_m, fit);
    if (track.parts.size() > 1) ++moving;
  }
  for (std::size_t m = 0; m < poses[p].markers.size(); ++m) {
    const MeasuredMarker& marker = poses[p].markers[m];
    if (tracks.count(marker.name) == 0)
      fit.add({{p, static_cast<Eigen::Index>(m)}}, Eigen::VectorXd::Ones(1), marker.position_m,
              measured_weight(marker, model_error_m));
  }
  return moving;
}

// `some` without what `others` say as well.
Eigen::MatrixXd beside(const Eigen::MatrixXd& some, const Eigen::MatrixXd& others) {
  return some - others * others.completeOrthogonalDecomposition().solve(some);
}

void add_values(const FitParameters& parameters, const SightFit& fit, FitResult& result) {
  const Eigen::VectorXd values = fit.values();
  const Eigen::Index count = values.size() - 2;
  const Eigen::MatrixXd creep = fit.jacobian().rightCols<2>(), others = fit.jacobian().leftCols(count);
  add_statistics(parameters, values.head(count), beside(others, creep), fit.residuals(), {}, result);
  const Eigen::MatrixXd alone = beside(creep, others);
  add_by_logarithms(parameters.creep(), values.tail<2>().array().exp(),
                    alone.transpose() * alone / residual_variance(fit.residuals(), values.size()), result);
  for (std::size_t i = result.values.size() - 2; i < result.values.size(); ++i)
    if (!result.values[i].identifiable) result.warnings.push_back("the data cannot identify " + result.values[i].name);
  result.measured_from_base = parameters.measured_from_base(values);
  result.backlash_m = parameters.backlash_m(values);
}

// Of a slow relaxation a short hold shows the beginning, which others fit as well.
void warn_of_short_holds(const std::vector<MeasuredPose>& poses, FitResult& result) {
  double longest_s = 0.0;
  for (const MeasuredPose& pose : poses) longest_s = std::max(longest_s, pose.held_s);
  const double relaxation_s = result.values.back().value;
  if (longest_s >= kLongEnough * relaxation_s) return;
  std::ostringstream text;
  text << std::setprecision(3) << "creep.relaxation_time_s is " << relaxation_s
       << " s, and no command was held for more "
       << "than " << longest_s << " s: intervals may exclude the truth; hold longer, for " << kLongEnough * relaxation_s
       << " s";
  result.warnings.push_back(text.str());
}

}  // namespace

FitResult fit_in_time(const FitParameters& parameters, const std::string& scene, const SceneOptions& options,
                      const std::vector<MeasuredPose>& poses, const FitRequest& request, std::vector<double> unknowns) {
  require_seen_while_held(poses);
  unknowns.resize(unknowns.size() + 2, 0.0);
  HoldModel model(scene, options, poses, parameters);
  SightFit fit(
      parameters, parameters.numbers_in_time(),
      [&](const Eigen::VectorXd& values, bool derivatives) { return model.predict(values, derivatives); }, unknowns);
  const std::vector<SimulatedHold> holds = model.holds(fit.values());
  int moving = 0;
  std::size_t sight = poses.size();
  for (std::size_t p = 0; p < poses.size(); sight += poses[p++].seen.size())
    moving += add_pose(poses, p, sight, holds[p].arrived_s + kSettled_s, request.model_error_m, fit);
  if (moving == 0) throw std::invalid_argument("parameters: creep: no marker was seen twice while a command was held");
  FitResult result = fit.solve(poses, request);
  add_values(parameters, fit, result);
  result.overrides = model.overrides(fit.values(), unidentified(result));
  warn_of_short_holds(poses, result);
  return result;
}

}  // namespace soft_robot_lab
