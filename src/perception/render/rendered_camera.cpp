// SPDX-License-Identifier: BSD-3-Clause
#include "rendered_camera.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <opencv2/core.hpp>

#include "colour_sensor.h"
#include "depth_sensor.h"

namespace soft_robot_lab {
namespace {

constexpr double moment_px = 0.5;  // how far a thing may go from one moment of an exposure to the next
constexpr int most_moments = 9;    // of an exposure

// The image's row of a point; without the lens where the image does not show it.
double row_px(const ExactCamera& camera, const Eigen::Isometry3d& camera_from_world, const Eigen::Vector3d& point_m) {
  const CameraModel& model = camera.model();
  const Eigen::Vector3d point = camera_from_world * point_m;
  const double depth_m = std::max(point.z(), 0.01);
  const double straight_px = model.focal_y_px * point.y() / depth_m + model.centre_y_px;
  if (!(straight_px > 0 && straight_px < model.height_px)) return straight_px;
  return model.project({point.x(), point.y(), depth_m}).y();
}

// The robot with every point where it is when the point's row is exposed: one shape that shows what a rolling shutter
// does. `late_s` after the row's middle exposure.
Eigen::Matrix3Xd rolled(const ExactCamera& camera, double readout_time_s, double late_s, double interval_s,
                        const Eigen::Matrix3Xd& present_m, const Eigen::Matrix3Xd& before_m) {
  const Eigen::Isometry3d camera_from_world = camera.world_from_camera().inverse();
  const double rows = camera.model().height_px;
  Eigen::Matrix3Xd points_m = present_m;
  for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
    const Eigen::Vector3d velocity_m_s = (present_m.col(i) - before_m.col(i)) / interval_s;
    for (int pass = 0; pass < 3; ++pass) {  // as it moves it comes into another row
      const double row = row_px(camera, camera_from_world, points_m.col(i));
      const double after_stamp_s = readout_time_s * (row - 0.5 * (rows - 1)) / rows + late_s;
      points_m.col(i) = present_m.col(i) + after_stamp_s * velocity_m_s;
    }
  }
  return points_m;
}

double largest_step_m(const SeenMotion& motion) {
  double step_m = 0;
  if (motion.present.vertices_m.size() > 0)
    step_m = (motion.present.vertices_m - motion.before.vertices_m).colwise().norm().maxCoeff();
  if (motion.present.stickers_m.size() > 0)
    step_m = std::max(step_m, (motion.present.stickers_m - motion.before.stickers_m).colwise().norm().maxCoeff());
  return step_m;
}

void check(const SeenMotion& motion) {
  if (!(motion.interval_s >= 0) || !std::isfinite(motion.interval_s))
    throw std::invalid_argument("interval_s is " + std::to_string(motion.interval_s) + "; allowed: [0, inf)");
  if (motion.interval_s > 0 && (motion.before.vertices_m.cols() != motion.present.vertices_m.cols() ||
                                motion.before.stickers_m.cols() != motion.present.stickers_m.cols()))
    throw std::invalid_argument("two moments of one robot have as many vertices and stickers each");
}

}  // namespace

RenderedCamera::RenderedCamera(std::string name, const ExactCamera& camera, const SensorModel& sensor,
                               std::uint64_t seed, int samples_a_side)
    : samples_a_side_(samples_a_side),
      name_(std::move(name)),
      camera_(camera),
      model_((sensor.validate(), sensor)),
      colour_(std::make_unique<ColourSensor>(sensor, camera.background().colour, seed)),
      depth_(std::make_unique<DepthSensor>(sensor, camera.background(), seed)),
      canvas_{camera.background().colour.clone(), camera.background().depth.clone()} {}
RenderedCamera::~RenderedCamera() = default;
RenderedCamera::RenderedCamera(RenderedCamera&&) noexcept = default;
RenderedCamera& RenderedCamera::operator=(RenderedCamera&&) noexcept = default;

RgbdFrame RenderedCamera::take(RayScene& scene, const SeenMotion& motion, double stamp_s, std::uint64_t frame) {
  check(motion);
  const SeenState& shown = scene.state();
  if (motion.present.vertices_m.cols() != shown.vertices_m.cols() ||
      motion.present.stickers_m.cols() != shown.stickers_m.cols())
    scene.show(motion.present);  // which refuses it
  if (!drawn_.empty()) {
    camera_.background().colour(drawn_).copyTo(canvas_.colour(drawn_));
    camera_.background().depth(drawn_).copyTo(canvas_.depth(drawn_));
  }
  if (model_.moves() && motion.interval_s > 0 && largest_step_m(motion) > 0) {
    draw_moving(scene, motion);
    scene.show(motion.present);
  } else {
    scene.show(motion.present);
    drawn_ = camera_.robot_bounds(scene.robot(), motion.present);
    camera_.draw(scene, drawn_, static_cast<float>(model_.gloss), canvas_, samples_a_side_);
  }
  return {name_, stamp_s, colour_->image(canvas_.colour, drawn_, frame), depth_->image(canvas_, drawn_, frame),
          model_.depth_step_m};
}

void RenderedCamera::draw_moving(RayScene& scene, const SeenMotion& motion) {
  const double px_per_m = camera_.model().focal_x_px / camera_.robot_depth_m(motion.present);
  const double smear_px = largest_step_m(motion) / motion.interval_s * px_per_m * model_.exposure_time_s;
  const int moments = std::clamp(static_cast<int>(std::ceil(smear_px / moment_px)), 1, most_moments);
  std::vector<SeenState> states;
  for (int i = 0; i < moments; ++i) {
    const double late_s = model_.exposure_time_s * ((i + 0.5) / moments - 0.5);
    const auto at = [&](const Eigen::Matrix3Xd& present_m, const Eigen::Matrix3Xd& before_m) {
      return rolled(camera_, model_.readout_time_s, late_s, motion.interval_s, present_m, before_m);
    };
    states.push_back({at(motion.present.vertices_m, motion.before.vertices_m),
                      at(motion.present.stickers_m, motion.before.stickers_m)});
    const cv::Rect bounds = camera_.robot_bounds(scene.robot(), states.back());
    drawn_ = i == 0 ? bounds : drawn_ | bounds;
  }
  const ExactCamera::Exposure exposure{moments, smear_px,
                                       [&](int i) { scene.show(states[static_cast<std::size_t>(i)]); }};
  camera_.draw(scene, exposure, drawn_, static_cast<float>(model_.gloss), canvas_, samples_a_side_);
}

}  // namespace soft_robot_lab
