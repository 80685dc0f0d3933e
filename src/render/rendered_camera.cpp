#include "soft_robot_lab/render/rendered_camera.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "render/sensor.h"

namespace soft_robot_lab {
namespace {

constexpr double still_px =
    0.1;  // what moves less within a row's exposure, or from one band of rows to the next, is still
constexpr int most_bands = 32;     // of rows that are drawn as if exposed at once
constexpr int most_exposures = 9;  // moments that make up a smeared row

SeenState state_at(const SeenMotion& motion, double after_stamp_s) {
  const double steps = after_stamp_s / motion.interval_s;
  return {motion.present.vertices_m + steps * (motion.present.vertices_m - motion.before.vertices_m),
          motion.present.stickers_m + steps * (motion.present.stickers_m - motion.before.stickers_m)};
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
                               std::uint64_t seed)
    : name_(std::move(name)),
      camera_(camera),
      model_(sensor),
      sensor_(std::make_unique<Sensor>(sensor, camera.background().depth.size(), seed)),
      canvas_{camera.background().colour.clone(), camera.background().depth.clone()} {}
RenderedCamera::~RenderedCamera() = default;
RenderedCamera::RenderedCamera(RenderedCamera&&) noexcept = default;
RenderedCamera& RenderedCamera::operator=(RenderedCamera&&) noexcept = default;

RgbdFrame RenderedCamera::take(Stage& stage, const SeenMotion& motion, double stamp_s, std::uint64_t frame) {
  check(motion);
  if (!drawn_.empty()) {
    camera_.background().colour(drawn_).copyTo(canvas_.colour(drawn_));
    camera_.background().depth(drawn_).copyTo(canvas_.depth(drawn_));
  }
  stage.show(motion.present);
  drawn_ = camera_.robot_bounds(stage);
  if (drawn_.empty()) {
  } else if (model_.moves() && motion.interval_s > 0) {
    draw_moving(stage, motion);
  } else {
    camera_.draw(stage, drawn_, static_cast<float>(model_.gloss), canvas_);
  }
  return {name_, stamp_s, sensor_->colour(canvas_, frame), sensor_->depth(canvas_, frame)};
}

void RenderedCamera::draw_moving(Stage& stage, const SeenMotion& motion) {
  const float gloss = static_cast<float>(model_.gloss);
  const double half_s = 0.5 * (model_.readout_time_s + model_.exposure_time_s);
  for (const double end_s : {-half_s, half_s}) {
    stage.show(state_at(motion, end_s));
    drawn_ |= camera_.robot_bounds(stage);
  }
  // As fine as the fastest point asks for, seen from as near as the robot comes.
  const double px_per_m = camera_.model().focal_x_px / camera_.robot_depth_m(stage);
  const double speed_px_s = largest_step_m(motion) / motion.interval_s * px_per_m;
  const auto pieces = [&](double time_s, int most) {
    return std::clamp(static_cast<int>(std::ceil(speed_px_s * time_s / still_px)), 1, most);
  };
  const double rows = camera_.model().height_px;
  const int bands =
      pieces(model_.readout_time_s * drawn_.height / rows, std::min(most_bands, std::max(1, drawn_.height)));
  const int exposures = pieces(model_.exposure_time_s, most_exposures);
  // Together the exposures of a pixel have about as many rays as one of something at rest.
  const int samples_a_side =
      static_cast<int>(std::ceil(ExactCamera::most_samples_a_side / std::sqrt(static_cast<double>(exposures))));
  for (int band = 0; band < bands; ++band) {
    const int first = drawn_.y + drawn_.height * band / bands, end = drawn_.y + drawn_.height * (band + 1) / bands;
    const cv::Rect area(drawn_.x, first, drawn_.width, end - first);
    const double middle_s = model_.readout_time_s * (0.5 * (first + end - 1) - 0.5 * (rows - 1)) / rows;
    cv::Mat sum = cv::Mat::zeros(area.size(), CV_32FC3), depth;
    for (int i = 0; i < exposures; ++i) {
      stage.show(state_at(motion, middle_s + model_.exposure_time_s * ((i + 0.5) / exposures - 0.5)));
      camera_.draw(stage, area, gloss, canvas_, samples_a_side);
      sum += canvas_.colour(area);
      if (i == exposures / 2) depth = canvas_.depth(area).clone();  // matched about where it was in the middle
    }
    cv::Mat(sum / exposures).copyTo(canvas_.colour(area));
    depth.copyTo(canvas_.depth(area));
  }
  stage.show(motion.present);
}

}  // namespace soft_robot_lab
