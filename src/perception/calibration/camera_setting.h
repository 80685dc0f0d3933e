// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace soft_robot_lab {

// Of a colour camera, as realsense2_camera's driver has it.
struct CameraSetting {
  bool automatic = true;  // enable_auto_exposure: the two below are the camera's own affair
  int exposure = 166;     // [0.1 ms]
  int gain = 64;
};

struct CameraSettingLimits {
  int min_exposure = 1, max_exposure = 10000;  // [0.1 ms]
  int min_gain = 0, max_gain = 128;
};

}  // namespace soft_robot_lab
