// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "soft_robot_lab/perception/tracking/camera_observation.h"
#include "marker_detection.h"
#include "detection_fusion.h"

namespace soft_robot_lab {

// Each marker as one camera alone measures it, at the time of the predictions; nothing where it is seen in part,
// without depth or not at all. `chosen` are the sights that identify() gave the markers. Where it left most without
// any, as those of a camera that was displaced, they are identified anew wherever they are within some centimetres.
std::vector<std::optional<CameraObservation>> camera_observations(const std::vector<MarkerDetection>& sights,
                                                                  std::vector<int> chosen,
                                                                  const std::vector<MarkerPrediction>& predictions,
                                                                  const std::vector<std::vector<int>>& neighbours,
                                                                  double gate);

}  // namespace soft_robot_lab
