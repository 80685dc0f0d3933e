// SPDX-License-Identifier: BSD-3-Clause
// Pictures as a perfect pinhole camera behind a perfect lens would take them.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "ray_scene.h"
#include "soft_robot_lab/perception/tracking/camera_model.h"

namespace soft_robot_lab {

struct ExactImage {
  cv::Mat colour;  // CV_32FC3, red first, 0 to 1 (brighter than 1 where lights add up)
  cv::Mat depth;   // CV_32FC1 [m] along z at the pixels' middles; 0 where nothing is met
};

class ExactCamera {
 public:
  // Draws the surroundings once; they stand still. Throws std::domain_error where the lens folds within the image.
  ExactCamera(const CameraModel& model, const Eigen::Isometry3d& world_from_camera, const RayScene& scene);

  const CameraModel& model() const { return model_; }
  const Eigen::Isometry3d& world_from_camera() const { return world_from_camera_; }
  const ExactImage& background() const { return background_; }

  // Where a robot may be seen in a state that the scene need not show.
  cv::Rect robot_bounds(const SeenRobot& robot, const SeenState& state) const;
  // The least depth of its skin and stickers, at least 1 cm; infinite where there is none.
  double robot_depth_m(const SeenState& state) const;
  // Draws robot and surroundings in `area`, nothing elsewhere. Pixels with an edge in or beside them and those about a
  // sticker are the mean of samples_a_side^2 rays each, others are one ray.
  void draw(const RayScene& scene, const cv::Rect& area, float gloss, ExactImage& image,
            int samples_a_side = most_samples_a_side) const;
  // The same of something that moves by `smear_px` at most: those pixels' rays are shared among the moments, all else
  // is the middle one. `show` moves the scene to moment i.
  struct Exposure {
    int moments = 1;
    double smear_px = 0;
    std::function<void(int moment)> show;
  };
  void draw(const RayScene& scene, const Exposure& exposure, const cv::Rect& area, float gloss, ExactImage& image,
            int samples_a_side = most_samples_a_side) const;

  static constexpr int most_samples_a_side = 5;

 private:
  // Of a ray through a place of a pixel: (0, 0) is its upper left corner, (1, 1) its lower right one. Frame world,
  // depth 1 along z.
  Eigen::Vector3f direction(cv::Point pixel, float right, float down) const;
  RayHit ray_hit(const RayScene& scene, cv::Point pixel, const Eigen::Vector3f& direction, float gloss) const;
  // `look` gives the RayHit of a pixel's ray. Of the pixel's rays those that are due at one of several moments.
  template <typename Look>
  Eigen::Vector3f mean_colour(cv::Point pixel, int samples_a_side, const Look& look, int moment = 0,
                              int moments = 1) const;
  template <typename Look>
  ExactImage sharp_image(const cv::Rect& area, const Look& look) const;
  void draw_background(const RayScene& scene);
  // Of `area`: 255 where many rays are due.
  cv::Mat fine_pixels(const RayScene& scene, const ExactImage& sharp, const cv::Rect& area, double smear_px) const;
  std::vector<cv::Rect> sticker_bounds(const SeenRobot& robot, const SeenState& state) const;
  cv::Rect image_area() const { return {0, 0, model_.width_px, model_.height_px}; }

  CameraModel model_;
  Eigen::Isometry3d world_from_camera_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f origin_m_;
  cv::Mat
      rays_;  // CV_32FC2: x, y at z = 1 of the rays through the pixels' corners; one row and column more than pixels
  ExactImage background_;
  cv::Mat background_edges_;  // CV_8UC1: 1 where the background differs from a neighbour
};

}  // namespace soft_robot_lab
