// SPDX-License-Identifier: BSD-3-Clause
// Where balls to calibrate cameras by stand around a robot.
#pragma once

#include "perception/calibration/calibration.h"
#include "perception/render/camera_setup.h"
#include "session/report/skin.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// Five balls that each camera sees whole beside the robot as it is now, none before another, and which no other order
// of them could be taken for. The same robot and cameras give the same places. Throws std::invalid_argument where there
// is no room for them: the robot hides too much, or the cameras see too little in common.
BallPlacement place_balls(const Simulation& simulation, const CameraSetup& cameras);

}  // namespace soft_robot_lab
