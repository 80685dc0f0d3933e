// SPDX-License-Identifier: BSD-3-Clause
#include "marker_sightings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "perception/tracking/marker_detector.h"

namespace soft_robot_lab {
namespace {

struct Look {
  const std::vector<MarkerView>& views;
  std::vector<double> radii_px;  // of the stickers, facing the camera
  std::vector<MarkerBlob> blobs;

  bool within(const MarkerBlob& blob, std::size_t marker) const {
    return views[marker].depth_m > 0 && (blob.centre_px - views[marker].pixel).norm() <= radii_px[marker];
  }
};

std::optional<Eigen::Vector2d> nearest(const Look& look, std::size_t marker) {
  std::optional<Eigen::Vector2d> found_px;
  double least_px = std::numeric_limits<double>::infinity();
  for (const MarkerBlob& blob : look.blobs) {
    const double distance_px = (blob.centre_px - look.views[marker].pixel).norm();
    if (!look.within(blob, marker) || distance_px >= least_px) continue;
    least_px = distance_px;
    found_px = blob.centre_px;
  }
  return found_px;
}

bool is_stray(const Look& look, const MarkerBlob& blob) {
  for (std::size_t marker = 0; marker < look.views.size(); ++marker)
    if (look.within(blob, marker)) return false;
  return true;
}

void add(const Look& look, MarkerSightings& sightings, std::vector<bool>& found) {
  ++sightings.images;
  for (const MarkerBlob& blob : look.blobs) sightings.strays += is_stray(look, blob) ? 1 : 0;
  for (std::size_t marker = 0; marker < look.views.size(); ++marker)
    if (look.views[marker].centre_seen) {
      sightings.sightings.push_back({marker, look.views[marker].pixel, nearest(look, marker)});
      if (sightings.sightings.back().found_px) found[marker] = true;
    }
}

}  // namespace

MarkerSightings sight_markers(const std::vector<SimulationState>& states, const Simulation& simulation,
                              const CameraSetup& rig, const DetectorSettings& settings,
                              const std::function<void(double)>& progress) {
  std::vector<std::string> names;
  for (const Marker& marker : simulation.markers()) names.push_back(marker.name());
  const std::vector<Sticker> stickers = rig.stickers(names);
  FrameRecorder film(simulation, rig);
  MarkerSightings sightings;
  for (std::size_t i = 0; i < states.size(); ++i) {
    std::vector<bool> found(stickers.size(), false);
    const Capture capture = film.take(states[i], states[i], double(i));
    for (std::size_t camera = 0; camera < capture.frames.size(); ++camera) {
      const cv::Mat& image = capture.frames[camera].colour;
      Look look{capture.views[camera], {}, detect_markers(image, {{0, 0}, image.size()}, settings)};
      const double focal_px = rig.cameras[camera].model.focal_x_px;
      for (std::size_t marker = 0; marker < stickers.size(); ++marker)
        look.radii_px.push_back(0.5 * stickers[marker].diameter_m * focal_px / look.views[marker].depth_m);
      add(look, sightings, found);
    }
    if (std::all_of(found.begin(), found.end(), [](bool each) { return each; })) ++sightings.complete_states;
    progress(double(i + 1) / double(states.size()));
  }
  return sightings;
}

SightingScore score(const MarkerSightings& sightings, std::optional<std::size_t> marker) {
  SightingScore score;
  double sum_px = 0, sum_2_px2 = 0;
  for (const MarkerDetectioning& sighting : sightings.sightings) {
    if (marker && sighting.marker != *marker) continue;
    ++score.in_sight;
    if (!sighting.found_px) continue;
    ++score.found;
    const double distance_px = (*sighting.found_px - sighting.true_px).norm();
    sum_px += distance_px;
    sum_2_px2 += distance_px * distance_px;
  }
  if (score.found == 0) return score;
  score.mean_px = sum_px / score.found;
  score.deviation_px = std::sqrt(std::max(0.0, sum_2_px2 / score.found - score.mean_px * score.mean_px));
  return score;
}

}  // namespace soft_robot_lab
