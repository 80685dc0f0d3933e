// SPDX-License-Identifier: BSD-3-Clause
// Records the emulated robot for a fit: it is held at one configuration after the other, and filmed meanwhile.
#pragma once

#include <string>
#include <vector>

#include "control/configuration_table.h"
#include "lab_settings.h"

namespace soft_robot_lab {

// Beside the lab's files (LabFiles):
// configurations: [{name: a, contractions: [1, 1]}, ...]
// held_s: 7
// film_at_s: [2, 5]            # since the command, rising
// model_error_m: 2.0e-5        # as in FitRequest
// parameters: [youngs_modulus_pa, ...]
// overrides: {}                # over the robot's scene: what is measured otherwise
struct FitRecording {
  LabFiles files;
  std::vector<Configuration> configurations;
  double held_s = 0.0;
  std::vector<double> film_at_s = {};
  Overrides known = {};
  FitRequest request = {};
};

// Throws SettingsError. The node may have other keys.
FitRecording read_fit_recording(const YamlNode& node, const ExperimentContext& context);

// The lab goes through configurations; the model only shows which marker is which.
class HoldRecorder {
 public:
  // Calibrates the cameras. Throws as EmulatedLab. Keeps a reference to the recording's settings.
  HoldRecorder(const FitRecording& recording, const ExperimentContext& context);

  // Throws std::runtime_error where the model finds no rest, or a motor faults.
  MeasuredPose hold(const Configuration& configuration);
  // Reports from one share of the experiment to another.
  std::vector<MeasuredPose> hold_all(const std::vector<Configuration>& configurations, const ExperimentContext& context,
                                     double from, double to);

  // As the drives stand, which are whole steps.
  double rounded(const std::string& name, double command) const;

  EmulatedLab& lab() { return lab_; }
  const EmulatedLab& lab() const { return lab_; }

 private:
  MarkersAt film(double start_s);

  const FitRecording& recording_;
  Scene model_;
  EmulatedLab lab_;
};

}  // namespace soft_robot_lab
