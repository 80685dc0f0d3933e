// SPDX-License-Identifier: BSD-3-Clause
// Scene and robot files (config/README.md, "Scene"): strict reading, and building a simulation from them.
// A robot file is a scene without a run. `include: other.yaml` names settings that the rest of the file overrides: maps
// merge key by key, lists replace, and `cables: {left: {...}}` changes keys of the cable of that name.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fidelity.h"
#include "soft_robot_lab/settings/overrides.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// Makes an actuator from its plugin name, "soft_robot_lab/Cable". Throws std::invalid_argument for unknown ones.
using ActuatorFactory = std::function<std::unique_ptr<Actuator>(const std::string& plugin)>;

struct TimedCommands {
  double time_s = 0.0;
  std::vector<std::pair<std::string, double>> commands;  // actuator, value
};

enum class RunMode { equilibrium, dynamic, modal };

struct RunSettings {
  bool stated = false;  // by the scene; a robot file may have no run
  RunMode mode = RunMode::equilibrium;
  double duration_s = 0.0;              // dynamic: > 0
  double record_every_s = 0.0;          // dynamic: 0 records every step
  bool sensitivity = false;             // equilibrium: report d marker / d command
  int modes = 4;                        // modal: [1, 100]
  std::vector<TimedCommands> commands;  // in order of time
};

struct SceneReduction;  // the reduced model and how it came about

struct Scene {
  std::string file;
  std::unique_ptr<Simulation> simulation;
  RunSettings run;
  std::vector<SolveWarning> warnings;      // of odd sizes and cables; run_scene reports them with its own
  std::optional<FidelityReport> fidelity;  // where the scene or its options ask for it
  // With solver.method reduced: run_scene moves the simulation by it. Null otherwise, and where none is kept.
  std::shared_ptr<const SceneReduction> reduction;
  bool untrained = false;  // with ReducedUse::if_kept, where none is
};

// What happens with solver.method reduced: refused; newton in its place, which trains it and goes on where it ends;
// the model that is kept, if one is; or one that is trained now where none is kept.
enum class ReducedUse { refused, by_newton, if_kept, trained };

struct SceneOptions {
  std::string mesher;  // empty: the mesher's own defaults (design/mesher.h), also for the folder
  std::string cache_folder;
  double meshing_limit_s = 120.0;
  ActuatorFactory actuator_factory;
  ReducedUse reduced = ReducedUse::refused;
  std::string method;  // newton, xpbd or reduced, in place of the file's; keys of other methods then count for nothing
  std::function<void(double, const std::string&)> progress;  // of training, and of judging a mesh, 0 to 1; may be empty
  // Before a model is trained or a mesh is judged, with what is odd about the scene as it is read; may be empty.
  std::function<void(const std::vector<SolveWarning>&)> on_warnings = {};
  bool estimate_error = false;                // judge the scene as it is (scene/fidelity.h)
  Overrides overrides;                        // laid over the file, as a file that includes it would be
  std::function<void(TetMesh&)> change_mesh;  // applied before anything binds to the mesh; may be empty
  // Asked while the scene is meshed, judged or trained for, and by its simulation's solves (Simulation::set_interrupt),
  // from every thread that loads it: true ends them. Empty: never.
  std::function<bool()> interrupt = {};
};

// Reads the file (and those it includes), meshes or reads the body, binds actuators and markers.
// Throws SettingsError (file, line, key, value, allowed range) or std::invalid_argument from a part, with the section
// named.
Scene load_scene(const std::string& path, const SceneOptions& options);
// The same of a scene that stands within another document; relative file names start at that one's folder.
Scene load_scene(const YamlNode& scene, const SceneOptions& options);

}  // namespace soft_robot_lab
