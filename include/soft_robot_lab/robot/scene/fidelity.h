// SPDX-License-Identifier: BSD-3-Clause
// How wrong a scene's answer is expected to be, and the settings chosen so that it is not more wrong than asked for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/solver_options.h"

namespace soft_robot_lab {

// What a scene is chosen for: rest states of its run, motion of its run, a search over the actuators' ranges by rest
// states, or a session that somebody moves.
enum class FidelityUse { rest, motion, search, live };

struct TimeStepChoice {
  Integrator integrator = Integrator::implicit_euler;
  double time_step_s = 0.0;
};

// A reduced model in place of method newton.
struct ReducedFidelity {
  double tolerance_m = 0.0;  // it is trained to
  int modes = 0;
  double error_m = 0.0;  // largest distance from newton on what it was not trained with
};

// Beside quadratic elements and the method newton.
struct FidelityChoice {
  std::optional<double> element_size_m;    // none where the scene names a mesh
  std::optional<TimeStepChoice> in_time;   // none at rest
  std::optional<ReducedFidelity> reduced;  // none: newton
  bool self_contact = false;  // switched on: without it the markers would be off by more than the tolerance
};

// What an optional part of a scene changes at the judged states: contact with obstacles or skin,
// friction of contact or cables, hysteresis, damping.
struct PartEffect {
  std::string part;
  double moved_m = 0.0;  // of the marker that it moves most
  std::string marker;    // its name
  bool may_go = false;   // less than a tenth of the tolerance
  std::string trouble;   // why it is not known; else empty
};

// Counted by solves and the size of their matrix, in CPU time of the results page's machine, so that no load and no
// other machine changes it.
struct FidelityCost {
  double rest_state_s = 0.0;  // of a judged rest state
  double per_second_s = 0.0;  // of a simulated second; 0 where nothing moves
  double choosing_s = 0.0;    // of choosing and judging
};

// A mesh that was looked at, and its expected error in the judged states; none where no estimate was found.
struct JudgedMesh {
  int nodes = 0;
  std::optional<double> expected_error_m;
};

// A judged rest state at which the body has buckled on a mesh that was looked at, or nearly. The side to which it goes
// hangs there on what the model does not know, and the markers may be elsewhere by far more than a mesh's error.
struct NearBuckling {
  int rest_state = 0;      // its number, from 1
  int nodes = 0;           // of the mesh that shows it
  double snapped_m = 0.0;  // by how much a node moved where the way there became unstable; 0: it did not
  double apart_m = 0.0;    // how far the markers are from where the mesh that judges has them; 0: they agree
  double stiffness = 1.0;  // with which the markers are held there, over that of the rest shape
};

struct FidelityReport {
  double tolerance_m = 0.0;  // of the markers; 0: the scene was judged as it is
  FidelityUse use = FidelityUse::rest;
  bool met = true;                       // the tolerance, and the speed; without a known error they are not
  std::optional<FidelityChoice> choice;  // none where the scene was judged as it is
  int nodes = 0;                         // of the mesh that was chosen or judged

  // Expected distances of the markers from those of an infinitely fine mesh and step; absent where no estimate was
  // found, and `trouble` says why.
  std::optional<double> expected_error_m;
  double mesh_error_m = 0.0;
  double time_error_m = 0.0;
  double reduced_error_m = 0.0;
  std::string trouble;
  std::optional<NearBuckling> near_buckling;  // then no error is expected, and the tolerance is not met
  double left_out_contact_m = 0.0;  // how far contact of skin with skin would move a marker, where it is left out

  double real_time = 0.0;           // asked for, times real time; 0: not
  double expected_real_time = 0.0;  // by counted costs; 0: not judged in motion
  FidelityCost cost;

  std::vector<JudgedMesh> meshes;     // from coarse to fine
  std::vector<PartEffect> parts;      // those that the scene has
  std::vector<std::string> reasons;   // of the choice, for a reader
  std::vector<std::string> left_out;  // what the model does without, for a reader
  bool from_cache = false;
  double cpu_s = 0.0;  // what the estimate cost when it was made
};

// "expected error 0.41 mm (tolerance 1 mm)", or why there is none.
std::string expected_error_text(const FidelityReport& report);

// What was chosen, why, its expected error, its cost, and what is left out with its size: one sentence.
std::string sentence(const FidelityReport& report);

// All of it in a few lines.
std::string summary(const FidelityReport& report);

}  // namespace soft_robot_lab
