// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

// What looks like a marker in one image.
struct MarkerBlob {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();  // centroid; pixels count by how far they are the marker's
  double sigma_px = 0;                                  // standard deviation of the centre along each axis
  double area_px = 0;                                   // sum of the same shares
  double roundness = 0;                                 // minor over major axis
  double contrast = 0;                                  // against what surrounds it; full scale is 1
  int colour = -1;                                      // of DetectorSettings::colours; -1 for the method contrast
  bool partial = false;                                 // touches the edge of the image, or another blob
  cv::Rect box;                                         // in the image
  cv::Mat support;                                      // CV_8U, of the box's size: 255 where the marker surely is
};

// Markers in a region of an rgb8 image, in no order that means anything. Regions that overlap the image in part are
// clipped. Throws std::invalid_argument for an image that is not CV_8UC3.
std::vector<MarkerBlob> detect_markers(const cv::Mat& rgb, const cv::Rect& region, const DetectorSettings& settings);

}  // namespace soft_robot_lab
