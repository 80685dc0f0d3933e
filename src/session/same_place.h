// SPDX-License-Identifier: BSD-3-Clause
// Whether markers rest, judged from where cameras saw them in two windows of time: in a session and in its recording.
#pragma once

#include "measured_rest.h"

namespace soft_robot_lab {

void add_seen(const MarkerFrame& frame, SeenMarkers& seen);

// Leaves out markers seen too rarely to know their means and scatter.
void require_observations(int observations, SeenMarkers& seen);

Eigen::Vector3d mean_of(const SeenPlaces& places_m);

// The mean of now, or where it lies farther from the median than that and the marker's noise explain, the median: then
// the marker jumped, or frames missed.
Eigen::Vector3d place_of(const SeenPlaces& before, const SeenPlaces& now, double motion_m);

// Whether no marker of both windows moved farther than it may, or than its noise would have it; false where there is
// none.
bool same_place(const SeenMarkers& before, const SeenMarkers& now, double motion_m);

}  // namespace soft_robot_lab
