// SPDX-License-Identifier: BSD-3-Clause
#include "ball_finder.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "soft_robot_lab/settings/yaml_node.h"
#include "ball_change.h"
#include "ball_fit.h"
#include "ball_outline.h"
#include "sphere_cloud.h"

namespace soft_robot_lab {
namespace {

constexpr double inner_share = 0.85;           // of a ball's apparent radius: depths further out slip off its edge
constexpr double cluster_step = 0.35;          // of a ball's radius
constexpr double sphere_sigmas = 3;            // within which a point is on a sphere
constexpr double known_radius_sigma_m = 1e-5;  // of the last fit

std::string place_text(const Eigen::Vector3d& point_m, const CameraModel& camera) {
  const Eigen::Vector2d pixel = camera.project(point_m);
  std::ostringstream text;
  text << "at pixel (" << std::lround(pixel.x()) << ", " << std::lround(pixel.y()) << ")";
  return text.str();
}

double depth_sigma_m(double depth_m, int count, const BallFinderSettings& settings) {
  const double noise_m = settings.depth.noise_per_m * depth_m * depth_m / std::sqrt(count);
  return std::hypot(noise_m, settings.depth.quantisation_m / std::sqrt(12.0));
}

Eigen::Matrix3Xd changed_points(const BallChange& change, const CameraModel& camera) {
  std::vector<cv::Point> pixels;
  cv::findNonZero(change.mask & (change.depth_m > 0), pixels);
  Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(pixels.size()));
  for (std::size_t i = 0; i < pixels.size(); ++i)
    points_m.col(static_cast<Eigen::Index>(i)) =
        change.depth_m.at<float>(pixels[i]) * camera.ray({pixels[i].x, pixels[i].y});
  return points_m;
}

Eigen::Matrix3Xd columns(const Eigen::Matrix3Xd& all, const std::vector<int>& chosen) {
  Eigen::Matrix3Xd some(3, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) some.col(static_cast<Eigen::Index>(i)) = all.col(chosen[i]);
  return some;
}

// Judges and measures one cluster of changed points.
class BallJudge {
 public:
  BallJudge(const BallChange& change, const CameraModel& camera, const BallFinderSettings& settings)
      : change_(change), camera_(camera), settings_(settings) {}

  void judge(const Eigen::Matrix3Xd& cluster_m, BallSearch& search) const {
    const std::string what = "what came " + place_text(cluster_m.rowwise().mean(), camera_);
    const double depth_m = cluster_m.row(2).mean();
    const double tolerance_m = sphere_sigmas * depth_sigma_m(depth_m, change_.depth_count, settings_);
    const auto sphere = find_sphere(cluster_m, 0.4 * settings_.radius_m, 2.5 * settings_.radius_m, tolerance_m);
    if (!sphere) return reject(what + " is no sphere", search);
    const double fraction = static_cast<double>(sphere->inliers.size()) / static_cast<double>(cluster_m.cols());
    if (fraction < settings_.min_sphere_share)
      return reject(what + " is not one ball: " + percent(fraction) +
                        " of its points lie on a sphere; balls must not touch each other or other things that came",
                    search);
    measure(columns(cluster_m, sphere->inliers), *sphere, what, search);
  }

 private:
  static std::string percent(double fraction) { return std::to_string(std::lround(100 * fraction)) + " %"; }
  static void reject(const std::string& why, BallSearch& search) { search.rejected.push_back(why); }

  double radians_per_px() const { return 2 / (camera_.focal_x_px + camera_.focal_y_px); }

  BallMeasurement measurement(const Eigen::Matrix3Xd& points_m, const Eigen::Vector3d& center_m,
                              double radius_m) const {
    BallMeasurement measured;
    std::vector<int> inner;
    const double max_angle = inner_share * std::asin(radius_m / center_m.norm());
    for (Eigen::Index i = 0; i < points_m.cols(); ++i)
      if (points_m.col(i).normalized().dot(center_m.normalized()) > std::cos(max_angle))
        inner.push_back(static_cast<int>(i));
    measured.points_m = columns(points_m, inner);
    measured.depth_sigmas_m = measured.points_m.row(2).transpose().unaryExpr([&](double depth_m) {
      return settings_.depth.correlation_px * depth_sigma_m(depth_m, change_.depth_count, settings_);
    });
    const auto outline = find_outline(change_.brightness, camera_, center_m, radius_m, settings_.colour_change);
    measured.outline.resize(3, static_cast<Eigen::Index>(outline.size()));
    for (std::size_t i = 0; i < outline.size(); ++i)
      measured.outline.col(static_cast<Eigen::Index>(i)) = camera_.ray(outline[i]);
    measured.outline_sigma = settings_.edge_noise_px * radians_per_px();
    measured.outline_bias_sigma = settings_.outline_bias_px * radians_per_px();
    return measured;
  }

  void measure(const Eigen::Matrix3Xd& points_m, const CloudSphere& sphere, const std::string& what,
               BallSearch& search) const {
    // The cloud alone gives the radius badly; cloud and outline together give it well.
    const BallMeasurement rough = measurement(points_m, sphere.center_m, sphere.radius_m);
    const BallFit free = fit_ball(rough, sphere.center_m, sphere.radius_m, settings_.radius_m);
    if (!(std::abs(free.radius_m - settings_.radius_m) <= settings_.radius_tolerance * settings_.radius_m)) {
      std::ostringstream why;
      why.precision(3);
      why << what << " has a radius of " << 1000 * free.radius_m << " mm; allowed: " << 1000 * settings_.radius_m
          << " mm within " << percent(settings_.radius_tolerance);
      return reject(why.str(), search);
    }
    const BallMeasurement fine = measurement(points_m, free.center_m, free.radius_m);
    if (fine.points_m.cols() < settings_.min_points)
      return reject(what + " has only " + std::to_string(fine.points_m.cols()) +
                        " depths; allowed: " + std::to_string(settings_.min_points) + " or more",
                    search);
    const double outline_share = static_cast<double>(fine.outline.cols()) / outline_directions;
    if (outline_share < settings_.min_outline_share)
      return reject(
          what + " shows only " + percent(outline_share) +
              " of its outline: it is hidden in part, cut by the image's edge, or as bright as what is behind",
          search);
    const BallFit fit = fit_ball(fine, free.center_m, settings_.radius_m, known_radius_sigma_m);
    search.balls.push_back(to_ball(fit, fine, free.radius_m));
  }

  FoundBall to_ball(const BallFit& fit, const BallMeasurement& measured, double radius_m) const {
    FoundBall ball;
    ball.center_m = fit.center_m;
    const Eigen::Vector3d ahead = fit.center_m.normalized();
    const double distance_m = fit.center_m.norm();
    const double aside_m = settings_.centre_floor_px * radians_per_px() * distance_m;
    const double along_m = settings_.depth_bias * distance_m;
    ball.covariance_m2 = fit.covariance_m2 + aside_m * aside_m * Eigen::Matrix3d::Identity() +
                         along_m * along_m * ahead * ahead.transpose();
    ball.radius_m = radius_m;
    ball.depth_residual_m = fit.depth_residual_m;
    ball.outline_residual_px = fit.outline_residual / radians_per_px();
    ball.points = static_cast<int>(measured.points_m.cols());
    return ball;
  }

  const BallChange& change_;
  const CameraModel& camera_;
  const BallFinderSettings& settings_;
};

// Changes of a ball's size whose depth is missing.
void report_without_depth(const BallChange& change, const CameraModel& camera, const BallFinderSettings& settings,
                          BallSearch& search) {
  cv::Mat labels, statistics, centroids;
  const int count = cv::connectedComponentsWithStats(change.mask, labels, statistics, centroids);
  for (int label = 1; label < count; ++label) {
    const cv::Mat here = labels == label;
    const int measured = cv::countNonZero(here & (change.depth_m > 0));
    if (statistics.at<int>(label, cv::CC_STAT_AREA) < settings.min_points || measured >= settings.min_points) continue;
    const Eigen::Vector2d pixel(centroids.at<double>(label, 0), centroids.at<double>(label, 1));
    search.rejected.push_back("what came " + place_text(camera.ray(pixel), camera) + " has only " +
                              std::to_string(measured) + " depths; allowed: " + std::to_string(settings.min_points) +
                              " or more");
  }
}

}  // namespace

void BallFinderSettings::validate() const {
  const auto require = [](const char* field, double value, const AllowedRange& range) {
    if (!range.contains(value))
      throw std::invalid_argument(std::string(field) + " is " + std::to_string(value) +
                                  "; allowed: " + range.to_string());
  };
  require("radius_m", radius_m, AllowedRange::positive());
  require("radius_tolerance", radius_tolerance, {0, 0.5, true, true});
  require("colour_change", colour_change, {0, 1, true, true});
  require("depth_change_m", depth_change_m, AllowedRange::positive());
  require("min_points", min_points, {10, 1e6});
  require("min_sphere_share", min_sphere_share, {0, 1, true, false});
  require("min_outline_share", min_outline_share, {0, 1, true, false});
  require("depth.noise_per_m", depth.noise_per_m, AllowedRange::positive());
  require("depth.correlation_px", depth.correlation_px, AllowedRange::positive());
  require("depth.quantisation_m", depth.quantisation_m, AllowedRange::not_negative());
  require("edge_noise_px", edge_noise_px, AllowedRange::positive());
  require("centre_floor_px", centre_floor_px, AllowedRange::not_negative());
  require("outline_bias_px", outline_bias_px, AllowedRange::positive());
  require("depth_bias", depth_bias, AllowedRange::not_negative());
}

BallSearch find_balls(const std::vector<RgbdFrame>& without_balls, const std::vector<RgbdFrame>& with_balls,
                      const CameraModel& camera, const BallFinderSettings& settings) {
  settings.validate();
  camera.validate();
  const BallChange change = find_change(without_balls, with_balls, camera, settings);
  BallSearch search;
  const Eigen::Matrix3Xd points_m = changed_points(change, camera);
  const BallJudge judge(change, camera, settings);
  for (const auto& cluster : euclidean_clusters(points_m, cluster_step * settings.radius_m, settings.min_points))
    judge.judge(columns(points_m, cluster), search);
  report_without_depth(change, camera, settings, search);
  std::sort(search.balls.begin(), search.balls.end(), [](const FoundBall& a, const FoundBall& b) {
    return a.center_m.x() * b.center_m.z() < b.center_m.x() * a.center_m.z();
  });
  return search;
}

}  // namespace soft_robot_lab
