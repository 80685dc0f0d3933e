// SPDX-License-Identifier: BSD-3-Clause
// The emulated lab goes through configurations and films each, as a fit wants them.
#pragma once

#include <vector>

#include "control/configuration_table.h"
#include "lab_settings.h"

namespace soft_robot_lab {

struct RecordingSettings {
  double held_s = 0.0;
  std::vector<double> film_at_s = {};  // since the command, rising
  Overrides known = {};                // of the model: what is measured otherwise
};

// held_s: 7                # how long a command is held
// film_at_s: [2, 6.5]      # at least one
// overrides: {...}         # over the robot's file
RecordingSettings read_recording_settings(const YamlNode& node);

// model_error_m: 2.0e-5    # as in FitRequest
// parameters: [youngs_modulus_pa, ...]
FitRequest read_fit_request(const YamlNode& node);

// The model only shows which marker is which.
class Recorder {
 public:
  // Calibrates the cameras. Throws as EmulatedLab does.
  Recorder(const LabFiles& files, const RecordingSettings& settings, const ExperimentContext& context);

  MeasuredPose hold(const Configuration& configuration);
  std::vector<MeasuredPose> record(const std::vector<Configuration>& configurations, const ExperimentContext& context,
                                   double from, double to);  // shares of the work, to be reported

  const Plant& plant() const { return lab_.plant(); }
  EmulatedLab& lab() { return lab_; }
  double time_s() const { return lab_.time_s(); }
  // As the drives stand, which are whole steps.
  double rounded(const std::string& name, double command) const;

 private:
  MarkersAt film(double start_s);

  const LabFiles& files_;
  const RecordingSettings& settings_;
  Scene model_;
  EmulatedLab lab_;
};

}  // namespace soft_robot_lab
