// SPDX-License-Identifier: BSD-3-Clause
// The parts of the fidelity estimate. Read choose_fidelity.cpp first.
//
// Mesh error. A scene is settled on its mesh, and again, from there, on the same mesh with every element cut into eight
// (sim/subdivide.h). With errors of order h^p the finer mesh has 2^-p of the error, so the error is the difference
// times 1 / (1 - 2^-p). p = 1, hence twice the difference, is what the robots show, with their re-entrant edges and
// cables that enter over a millimetre; smooth bodies have p = 2, for which twice is 1.5 times too much.
//
// Measured: estimate over error, where the error is the difference to two subdivisions and, beyond them, what the
// observed order leaves. (None was observed for Hammerbot at 20 %: it has buckled sideways, and the mesh decides how
// far.)
//
//   cantilever (R1), 254 elements, Poisson's ratio 0.3 / 0.499    1.6 / 1.9
//   Cook's membrane (R2), 867 elements                            0.7
//   bar with a cable (R5), 247 elements, 10 % pull                1.3
//   Spinebot, 549 elements, 5 / 10 / 20 % pull                    1.0 / 1.0 / 1.2
//   Hammerbot, 400 elements, 5 / 10 / 20 % pull                   1.0 / 0.7 / 1.8
//
// Others were tried and left. One pressure per element against four, on one mesh, do not always bracket the truth: on
// the bar they differ by a third of the error, and on Spinebot the truth lies on the other side of the first; Newton
// needs 20 to 400 iterations for the second. Two meshes of sizes h and 0.7 h: where small features rule, the mesher
// makes nearly the same mesh for both, and what differs is chance.
//
// Element: quadratic at any Poisson's ratio. At 0.3, where nothing locks, the cantilever is 8.6 % off on 1345 nodes of
// linear elements, 1.4 % on 579 nodes of quadratic ones. Method: newton. A Newton iteration takes 0.04 s of CPU on 3600
// nodes, 1.3 s on 25 000, 2.2 s on 54 000 and 12 s on 83 000 (which depends on the shape), so that within the limit on
// nodes there is no mesh where xpbd, 10 to 25 times slower on robots, would gain.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sections.h"
#include "robot/design/content_cache.h"
#include "soft_robot_lab/robot/scene/fidelity.h"

namespace soft_robot_lab {

// Where estimates and reduced models are kept.
inline ContentCache cache_of(const SceneOptions& options) {
  return ContentCache(cache_folder(mesher_options(options)));
}

struct FidelityRequest {
  double tolerance_m = 0.0;  // > 0
  int max_nodes = 5000;      // [100, 20000]; the estimate's own mesh has up to eight times as many
};

// `fidelity`; refuses keys in `body` and `solver` that it would choose itself, unless they come from an included file.
std::optional<FidelityRequest> read_fidelity(const YamlNode& scene);

// What the scene is judged at: rest states, each the commands of all actuators in their order. Those of its run; where
// it has none, as a robot file may, each cable's contraction and each chamber's amount of gas by a fifth, one at a
// time.
std::vector<std::vector<double>> judged_commands(const Simulation& simulation, const RunSettings& run);

struct MeshError {
  std::optional<double> expected_m;
  std::string trouble;  // why there is none
};

// Twice the largest difference of a marker, or the root mean square over the surface where that is more: a marker may
// stand where the difference happens to pass through zero.
MeshError estimate_mesh_error(const YamlNode& settings, const TetMesh& mesh, const SceneOptions& options);

struct TimeError {
  double error_m = 0.0;        // of the time step
  double amplification = 1.0;  // >= 1: how much more a mesh error shows in motion than at rest
  std::optional<TimeStepChoice> choice;
  std::string trouble;  // empty, or why there is no estimate
};

// Of a dynamic run's first seconds (kStretch_s in time_error.cpp), on this mesh: step h against h / 2.
TimeError estimate_time_error(const YamlNode& settings, const TetMesh& mesh, const SceneOptions& options);
// The longest step, of implicit Euler or BDF2, whose error is within the tolerance.
TimeError choose_time_step(const YamlNode& settings, const TetMesh& mesh, const SceneOptions& options,
                           double tolerance_m);

// What contact of skin with skin would change, at the rest states that a scene is judged at. Nothing where no skin is
// in other silicone there, or the scene lists such contact.
struct ContactEffect {
  double moved_m = 0.0;  // of the marker that moves most
  std::string marker;
};
ContactEffect contact_effect(const YamlNode& settings, const SceneOptions& options);
Overrides self_contact();

// Kept by content beside the meshes.
std::optional<FidelityReport> find_fidelity(const std::string& key, const SceneOptions& options);
void keep_fidelity(const std::string& key, const FidelityReport& report, const SceneOptions& options);

// What the scene does not ask for, and so does not pay for.
std::vector<std::string> left_out(const YamlNode& settings, bool dynamic);

// Chooses and judges, or only judges; none where neither is asked for. Throws SettingsError.
std::optional<FidelityReport> settle_fidelity(const YamlNode& settings, const SceneOptions& options);

const char* name_of(Integrator integrator);  // as a scene names it

Overrides overrides_of(const FidelityChoice& choice);
Overrides overrides_of(const TimeStepChoice& choice);

}  // namespace soft_robot_lab
