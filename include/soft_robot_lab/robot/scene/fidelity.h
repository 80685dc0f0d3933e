// SPDX-License-Identifier: BSD-3-Clause
// How wrong a scene's answer is expected to be, and the settings chosen so that it is not more wrong than asked for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/solver_options.h"

namespace soft_robot_lab {

struct TimeStepChoice {
  Integrator integrator = Integrator::implicit_euler;
  double time_step_s = 0.0;
};

// Beside quadratic elements and the method newton.
struct FidelityChoice {
  std::optional<double> element_size_m;   // none where the scene names a mesh
  std::optional<TimeStepChoice> in_time;  // none at rest
  bool self_contact = false;              // switched on: without it the markers would be off by more than the tolerance
};

struct FidelityReport {
  double tolerance_m = 0.0;              // of the markers; 0: the scene was judged as it is
  bool met = true;                       // the tolerance; without a known error it is not
  std::optional<FidelityChoice> choice;  // none where the scene was judged as it is
  int nodes = 0;                         // of the mesh that was chosen or judged

  // Expected distances of the markers from those of an infinitely fine mesh and step; absent where no estimate was
  // found, and `trouble` says why.
  std::optional<double> expected_error_m;
  double mesh_error_m = 0.0;
  double time_error_m = 0.0;
  std::string trouble;
  double left_out_contact_m = 0.0;  // how far contact of skin with skin would move a marker, where it is left out

  std::vector<std::string> reasons;   // of the choice, for a reader
  std::vector<std::string> left_out;  // what the model does without, for a reader
  bool from_cache = false;
  double cpu_s = 0.0;  // what the estimate cost when it was made
};

// "expected error 0.41 mm (tolerance 1 mm)", or why there is none.
std::string expected_error_text(const FidelityReport& report);

// All of it in a few lines.
std::string summary(const FidelityReport& report);

}  // namespace soft_robot_lab
