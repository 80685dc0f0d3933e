// SPDX-License-Identifier: BSD-3-Clause
#include "exact_camera.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "rectangles.h"

namespace soft_robot_lab {
namespace {

constexpr float edge_contrast = 0.02f;     // between neighbours; of white
constexpr float edge_depth_ratio = 0.01f;  // of the depth
constexpr double nearest_sight_m = 0.01;   // along z
constexpr int margin_px = 2;

ExactImage empty_image(cv::Size size) { return {cv::Mat::zeros(size, CV_32FC3), cv::Mat::zeros(size, CV_32FC1)}; }

cv::Vec3f to_pixel(const Eigen::Vector3f& colour) { return {colour.x(), colour.y(), colour.z()}; }

Eigen::Vector3f from_pixel(const cv::Vec3f& pixel) { return {pixel[0], pixel[1], pixel[2]}; }

bool differ(const ExactImage& image, cv::Point a, cv::Point b) {
  const cv::Vec3f& first = image.colour.at<cv::Vec3f>(a);
  const cv::Vec3f& second = image.colour.at<cv::Vec3f>(b);
  for (int channel = 0; channel < 3; ++channel)
    if (std::abs(first[channel] - second[channel]) > edge_contrast) return true;
  const float depth = image.depth.at<float>(a);
  return std::abs(depth - image.depth.at<float>(b)) > edge_depth_ratio * depth;
}

// Whether a pixel differs from one of its four neighbours.
bool at_edge(const ExactImage& image, cv::Point pixel) {
  const cv::Rect area(cv::Point(0, 0), image.depth.size());
  for (const cv::Point& step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)})
    if (area.contains(pixel + step) && differ(image, pixel, pixel + step)) return true;
  return false;
}

// The pixels from the least to the largest place, and some more.
cv::Rect pixels_between(const Eigen::Vector2d& least, const Eigen::Vector2d& largest, const cv::Rect& image) {
  const Eigen::Vector2d low = least.cwiseMax(-1e6), high = largest.cwiseMin(1e6);
  if (!(low.x() <= high.x() && low.y() <= high.y())) return {};
  const cv::Point first(static_cast<int>(std::floor(low.x())), static_cast<int>(std::floor(low.y())));
  const cv::Point last(static_cast<int>(std::ceil(high.x())), static_cast<int>(std::ceil(high.y())));
  return grown({first, last + cv::Point(1, 1)}, margin_px) & image;
}

}  // namespace

ExactCamera::ExactCamera(const CameraModel& model, const Eigen::Isometry3d& world_from_camera, const RayScene& scene)
    : model_(model),
      world_from_camera_(world_from_camera),
      rotation_(world_from_camera.linear().cast<float>()),
      origin_m_(world_from_camera.translation().cast<float>()) {
  model_.validate();
  rays_.create(model.height_px + 1, model.width_px + 1, CV_32FC2);
  for (int v = 0; v < rays_.rows; ++v)
    for (int u = 0; u < rays_.cols; ++u) {
      const Eigen::Vector3d ray = model_.ray({u - 0.5, v - 0.5});
      rays_.at<cv::Vec2f>(v, u) = {static_cast<float>(ray.x()), static_cast<float>(ray.y())};
    }
  draw_background(scene);
}

Eigen::Vector3f ExactCamera::direction(cv::Point pixel, float right, float down) const {
  const auto* above = rays_.ptr<cv::Vec2f>(pixel.y) + pixel.x;
  const auto* below = rays_.ptr<cv::Vec2f>(pixel.y + 1) + pixel.x;
  const cv::Vec2f ray =
      (1 - down) * ((1 - right) * above[0] + right * above[1]) + down * ((1 - right) * below[0] + right * below[1]);
  return rotation_ * Eigen::Vector3f(ray[0], ray[1], 1);
}

RayHit ExactCamera::ray_hit(const RayScene& scene, cv::Point pixel, const Eigen::Vector3f& direction,
                            float gloss) const {
  const RayHit robot = scene.cast_at_robot(origin_m_, direction, gloss);
  if (background_edges_.at<std::uint8_t>(pixel) == 0) {
    // Here the background is one thing: what was drawn of it serves every ray of the pixel.
    const float depth = background_.depth.at<float>(pixel);
    if (robot.depth <= 0) return {depth, from_pixel(background_.colour.at<cv::Vec3f>(pixel))};
    if (depth <= 0 || robot.depth < (1 - 2 * edge_depth_ratio) * depth) return robot;
  }
  const RayHit still = scene.cast_at_surroundings(origin_m_, direction);
  return robot.depth > 0 && !(still.depth > 0 && still.depth < robot.depth) ? robot : still;
}

template <typename Look>
Eigen::Vector3f ExactCamera::mean_colour(cv::Point pixel, int samples_a_side, const Look& look, int moment,
                                         int moments) const {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int count = 0;
  for (int i = 0; i < samples_a_side * samples_a_side; ++i) {
    const int column = i % samples_a_side, row = i / samples_a_side;
    if ((column + 2 * row) % moments != moment) continue;  // every moment has rays all over the pixel
    const float right = (static_cast<float>(column) + 0.5f) / static_cast<float>(samples_a_side);
    const float down = (static_cast<float>(row) + 0.5f) / static_cast<float>(samples_a_side);
    sum += look(pixel, direction(pixel, right, down)).colour;
    ++count;
  }
  return sum / static_cast<float>(count);
}

template <typename Look>
ExactImage ExactCamera::sharp_image(const cv::Rect& area, const Look& look) const {
  ExactImage sharp = empty_image(area.size());
  for (int v = 0; v < area.height; ++v)
    for (int u = 0; u < area.width; ++u) {
      const cv::Point pixel(area.x + u, area.y + v);
      const RayHit seen = look(pixel, direction(pixel, 0.5f, 0.5f));
      sharp.colour.at<cv::Vec3f>(v, u) = to_pixel(seen.colour);
      sharp.depth.at<float>(v, u) = seen.depth;
    }
  return sharp;
}

void ExactCamera::draw_background(const RayScene& scene) {
  const auto look = [&](cv::Point, const Eigen::Vector3f& ray) { return scene.cast_at_surroundings(origin_m_, ray); };
  const ExactImage sharp = sharp_image(image_area(), look);
  background_ = {sharp.colour.clone(), sharp.depth};
  background_edges_ = cv::Mat::zeros(image_area().size(), CV_8UC1);
  for (int v = 0; v < background_edges_.rows; ++v)
    for (int u = 0; u < background_edges_.cols; ++u) {
      if (!at_edge(sharp, {u, v})) continue;
      background_edges_.at<std::uint8_t>(v, u) = 1;
      background_.colour.at<cv::Vec3f>(v, u) = to_pixel(mean_colour({u, v}, most_samples_a_side, look));
    }
}

cv::Mat ExactCamera::fine_pixels(const RayScene& scene, const ExactImage& sharp, const cv::Rect& area,
                                 double smear_px) const {
  cv::Mat fine = cv::Mat::zeros(area.size(), CV_8UC1);
  for (int v = 0; v < area.height; ++v)
    for (int u = 0; u < area.width; ++u)
      if (at_edge(sharp, {u, v})) fine.at<std::uint8_t>(v, u) = 255;
  for (const cv::Rect& bounds : sticker_bounds(scene.robot(), scene.state())) {
    const cv::Rect seen = bounds & area;
    if (!seen.empty()) fine(seen - area.tl()).setTo(255);
  }
  const int reach = static_cast<int>(std::ceil(0.5 * smear_px));
  if (reach > 0) cv::dilate(fine, fine, cv::Mat::ones(2 * reach + 1, 2 * reach + 1, CV_8UC1));
  return fine;
}

void ExactCamera::draw(const RayScene& scene, const cv::Rect& area, float gloss, ExactImage& image,
                       int samples_a_side) const {
  draw(scene, {1, 0, [](int) {}}, area, gloss, image, samples_a_side);
}

void ExactCamera::draw(const RayScene& scene, const Exposure& exposure, const cv::Rect& area, float gloss,
                       ExactImage& image, int samples_a_side) const {
  const auto look = [&](cv::Point pixel, const Eigen::Vector3f& ray) { return ray_hit(scene, pixel, ray, gloss); };
  const cv::Rect inside = area & image_area(), wide = grown(inside, 1) & image_area();  // edges show by the neighbours
  if (inside.empty()) return;
  samples_a_side = std::max(samples_a_side, (exposure.moments + 4) / 3);  // so that every moment has a ray: mean_colour
  exposure.show(exposure.moments / 2);
  const ExactImage sharp = sharp_image(wide, look);
  const cv::Rect local(inside.tl() - wide.tl(), inside.size());
  const cv::Mat fine = fine_pixels(scene, sharp, wide, exposure.smear_px)(local);
  sharp.depth(local).copyTo(image.depth(inside));
  sharp.colour(local).copyTo(image.colour(inside));
  image.colour(inside).setTo(cv::Scalar::all(0), fine);
  for (int i = 0; i < exposure.moments; ++i) {
    const int moment = (i + exposure.moments / 2) % exposure.moments;  // beginning with what is shown now
    if (i > 0) exposure.show(moment);
    for (int v = 0; v < fine.rows; ++v)
      for (int u = 0; u < fine.cols; ++u) {
        if (fine.at<std::uint8_t>(v, u) == 0) continue;
        const cv::Point pixel = inside.tl() + cv::Point(u, v);
        const Eigen::Vector3f mean = mean_colour(pixel, samples_a_side, look, moment, exposure.moments);
        image.colour.at<cv::Vec3f>(pixel) += to_pixel(mean / static_cast<float>(exposure.moments));
      }
  }
}

cv::Rect ExactCamera::robot_bounds(const SeenRobot& robot, const SeenState& state) const {
  const Eigen::Isometry3d camera_from_world = world_from_camera_.inverse();
  Eigen::Vector2d least = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), largest = -least;
  const Eigen::Matrix3Xd& vertices_m = state.vertices_m;
  for (Eigen::Index i = 0; i < vertices_m.cols(); ++i) {
    const Eigen::Vector3d point = camera_from_world * vertices_m.col(i);
    if (point.z() < nearest_sight_m) return image_area();
    const Eigen::Vector2d pixel = model_.project(point);
    least = least.cwiseMin(pixel);
    largest = largest.cwiseMax(pixel);
  }
  cv::Rect bounds = pixels_between(least, largest, image_area());
  for (const cv::Rect& sticker : sticker_bounds(robot, state)) bounds |= sticker;
  return bounds & image_area();
}

double ExactCamera::robot_depth_m(const SeenState& state) const {
  const Eigen::Isometry3d camera_from_world = world_from_camera_.inverse();
  const Eigen::RowVector3d ahead = camera_from_world.linear().row(2);
  double depth_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Matrix3Xd* points_m : {&state.vertices_m, &state.stickers_m})
    if (points_m->size() > 0)
      depth_m = std::min(depth_m, (ahead * *points_m).minCoeff() + camera_from_world.translation().z());
  return std::max(depth_m, nearest_sight_m);
}

std::vector<cv::Rect> ExactCamera::sticker_bounds(const SeenRobot& robot, const SeenState& state) const {
  const Eigen::Isometry3d camera_from_world = world_from_camera_.inverse();
  const double focal_px = std::max(model_.focal_x_px, model_.focal_y_px);
  std::vector<cv::Rect> bounds;
  for (Eigen::Index i = 0; i < state.stickers_m.cols(); ++i) {
    const Eigen::Vector3d centre = camera_from_world * state.stickers_m.col(i);
    const double radius_m = 0.5 * robot.stickers[static_cast<std::size_t>(i)].diameter_m;
    if (centre.z() < nearest_sight_m + radius_m) continue;
    const Eigen::Vector2d middle = model_.project(centre);
    const auto reach = Eigen::Vector2d::Constant(focal_px * radius_m / (centre.z() - radius_m));
    bounds.push_back(pixels_between(middle - reach, middle + reach, image_area()));
  }
  return bounds;
}

}  // namespace soft_robot_lab
