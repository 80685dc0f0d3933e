// SPDX-License-Identifier: BSD-3-Clause
// What a real RGB-D camera makes of an exact picture.
#pragma once

#include <string>

#include "soft_robot_lab/settings/yaml_node.h"
#include "perception/calibration/camera_setting.h"

namespace soft_robot_lab {

// Everything is off by default: the exact picture, rounded to 1/255 of white and, as in realsense2_camera's messages,
// to millimetres.
struct SensorModel {
  // Colour.
  double exposure_gain = 1;       // > 0; brightness is this times the scene's, what exceeds white is cut
  double light_gradient = 0;      // [0, 1]: the right edge of the image gets this share of light less than the left one
  double gloss = 0;               // [0, 1]: brightness of the lights' mirror images (spots) on the silicone
  double blur_px = 0;             // >= 0: standard deviation of the lens's Gaussian blur
  double exposure_time_s = 0;     // >= 0: what moves meanwhile is smeared
  double readout_time_s = 0;      // >= 0: rolling shutter, first to last row; the stamp is that of the middle row
  double electrons_at_white = 0;  // >= 0: photon noise, deviation 1 / sqrt(electrons) of white there; 0: none
  double read_noise = 0;          // >= 0: noise in the dark, deviation in shares of white

  // Depth by stereo matching. A disparity is focal length * baseline / depth [px].
  double baseline_m = 0.055;  // > 0
  double field_of_view_deg =
      65;  // (0, 180), of the infrared images, across; with the image's width it gives their focal length
  double disparity_noise_px = 0;  // >= 0, standard deviation; that of depth is depth^2 / (focal * baseline) times this
  double noise_correlation_px = 0;  // >= 0: the noise is white noise blurred by a Gaussian of this deviation
  double disparity_step_px = 0;     // >= 0: disparities are rounded to multiples of this; 0: not
  double depth_step_m = 0.001;      // [0, 0.1]: depths are rounded to multiples of this; 0: not
  double edge_hole_px = 0;          // >= 0: no depth within this distance of an edge (a jump of depth by more than 2 %)
  bool stereo_shadow = false;       // no depth where something nearer hides a place from the second imager
  double low_texture_level = 0;     // [0, 1]: places darker than this lose their depth in blots: one in two where black

  // An Intel RealSense D415.
  // - Baseline 55 mm, 65 degrees across, rolling shutters: Intel, D400 series data sheet (337029).
  // - Deviation of depth = depth^2 * subpixel / (focal * baseline), subpixel below 0.1 px on a well textured target:
  //   Grunnet-Jepsen, Sweetser, Woodfill, "Tuning depth cameras for best performance"; with 0.08 px that is 0.8 mm at
  //   0.6 m and 848 pixels across.
  // - Steps of 1/32 px: Grunnet-Jepsen et al., "Subpixel linearity improvement for Intel RealSense depth camera D400".
  // - Colour rows are read during most of a frame's time: measurements in librealsense's tracker ("RGB rolling shutter
  //   artifacts coupled with FPS").
  // - The rest is chosen: noise over about the matching window's middle, holes at edges and in the dark of the size
  // that
  //   such cameras show on a dark background, a small colour sensor (1.4 um pixels) in a lit room.
  static SensorModel d415();

  bool moves() const { return exposure_time_s > 0 || readout_time_s > 0; }
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

// The setting at which the model is as its file says: its own exposure, 16.6 ms where it has none, and a gain of 64.
CameraSetting own_setting(const SensorModel& model);
// The model at another setting, or itself at an automatic one. Brightness grows with the exposure's length and doubles
// with every 32 steps of gain (chosen: Intel does not publish the law); gain makes noise brighter too, a longer
// exposure smears for longer, where the model smears at all. Throws std::invalid_argument: outside
// CameraSettingLimits{}.
SensorModel exposed(SensorModel model, const CameraSetting& setting);

// `exact`, `d415`, or a map of this model's keys with `base: exact | d415` for those it does not name.
SensorModel read_sensor_model(const YamlNode& node);

}  // namespace soft_robot_lab
