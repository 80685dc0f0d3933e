// SPDX-License-Identifier: BSD-3-Clause
// A whole lab without its hardware, in lock-step, so that it repeats to the last digit: the motor driver talks to the
// real firmware on an emulated board, whose shafts pull the cables or press the syringes of a robot that plays plant,
// which rendered cameras film and the tracker measures. Only frames of the robot at rest are rendered.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "soft_robot_lab/control/closed_loop.h"
#include "soft_robot_lab/control/identification/fit_model.h"
#include "session/report/frame_recorder.h"
#include "hardware/motor/rig_settings.h"
#include "hardware/plant/plant.h"
#include "perception/calibration/calibration.h"
#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

class EmulatedSession;
class Tracker;

struct EmulatedLabSettings {
  RigSettings rig;
  PlantSettings plant;
  CameraSetup cameras;  // where they are believed to stand
  TrackerSettings tracker;
  FrameRecorderOptions film = {};
  int frames = 8;             // [1, 1000] of each camera for a measurement, 1/30 s apart
  std::string emulator = {};  // as in Testbench
};

using MarkerPlaces = std::map<std::string, Eigen::Vector3d>;  // robot_base
// The most that a marker of `one` is away from its place in `other`, which must have it.
double farthest_m(const MarkerPlaces& one, const MarkerPlaces& other);
// Root mean square distance of the markers that both have; of none 0.
double rms_m(const MarkerPlaces& places, const MarkerPlaces& others);

class EmulatedLab {
 public:
  // The robot hangs at rest and its motors are ready. Throws std::runtime_error where they do not get so, and
  // std::invalid_argument for settings that do not belong together.
  EmulatedLab(const EmulatedLabSettings& settings, const SceneOptions& options);
  ~EmulatedLab();

  // Finds the cameras by white balls. Throws CalibrationError; the poses believed before stay then.
  void calibrate(const BallPlacement& placement);

  // Commands the motors and lets time pass until they and the robot rest. Throws std::invalid_argument as the driver
  // does, std::runtime_error where it does not rest within a minute or a motor faults.
  void go(const std::vector<std::string>& names, const std::vector<double>& commands);

  // Lets time pass until motors and robot rest. Throws std::runtime_error as go() does.
  void settle();

  // Someone pushes the robot, in place of who did before, as Plant::load.
  void load(const std::vector<PointLoad>& loads) { plant_.load(loads); }

  // Commands the motors, and no more.
  void command(const std::vector<std::string>& names, const std::vector<double>& commands);

  // Lets time pass. Throws std::runtime_error where a motor faults meanwhile.
  void wait(double duration_s);

  // Films the resting robot and tracks it, as if it were seen for the first time; of each marker the mean of the frames
  // that show it, and the mean of their covariances: errors of frames of one place are alike, so the mean is not much
  // surer than a frame. `expected_m`: where a simulation has every marker, which shows which is which.
  std::vector<MeasuredMarker> observe(const MarkerPlaces& expected_m);
  MeasuredMarkers measure(const MarkerPlaces& expected_m);  // the positions alone

  // Markers of the moving robot, a frame at a time: of what the cameras see now, those that the tracker sees. It starts
  // anew where markers are as in `expected_m`.
  void start_tracking(const MarkerPlaces& expected_m);
  MeasuredMarkers track();

  const Plant& plant() const { return plant_; }
  double time_s() const;

 private:
  void pass(double duration_s);
  Capture take(FrameRecorder& film);
  std::unique_ptr<Tracker> new_tracker(const MarkerPlaces& expected_m) const;

  EmulatedLabSettings settings_;
  Plant plant_;
  CameraSetup real_cameras_;
  std::map<std::string, Eigen::Isometry3d> believed_;  // world_from_camera by name
  FrameRecorder recorder_;
  std::unique_ptr<EmulatedSession> session_;
  std::unique_ptr<Tracker> tracker_;
};

MarkerPlaces marker_places(const Simulation& simulation);

// Robot and model at rest after the same command.
struct RestRecord {
  std::vector<std::string> actuators;
  std::vector<double> commands;
  MeasuredMarkers measured_m;
  MarkerPlaces true_m, simulated_m;
};

// Both from where the command before has left them: the robot as the motors move it, the model as its own drives do,
// and then to its equilibrium. Throws std::runtime_error where one of them finds no rest.
RestRecord record_at_rest(EmulatedLab& lab, Simulation& model, const std::vector<double>& commands);

// Where the model rests that starts as its present rest mirrored in the plane across `axis` (0 to 2) through the
// origin: there, if that is another rest state. The model itself stays. nullopt where it finds no rest.
std::optional<MarkerPlaces> rest_from_mirror_image(Simulation& model, int axis);

}  // namespace soft_robot_lab
