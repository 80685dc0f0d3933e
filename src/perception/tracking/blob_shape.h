// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "marker_detector.h"

namespace soft_robot_lab {

// One connected patch of a mask with what lies around it; all images of one size.
struct BlobPatch {
  cv::Mat rgb;     // CV_8UC3
  cv::Mat own;     // CV_8U, 255: the patch
  cv::Mat others;  // CV_8U, 255: other patches, of any colour
};

// How far around its mask a blob's soft edge and then its background are looked for.
constexpr int kBlobMargin_px = 4;

// Fills in a blob's measures, in pixels of the patch. Each pixel of the edge counts by its share of the marker's
// colour: how far it is from the background's to the marker's, where greys do not count if the marker's colour differs
// from the background in more than brightness, so that an edge against the dark counts as one against the robot.
void measure_blob(const BlobPatch& patch, const DetectorSettings& settings, MarkerBlob& blob);

}  // namespace soft_robot_lab
