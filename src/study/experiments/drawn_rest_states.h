// SPDX-License-Identifier: BSD-3-Clause
// Time as the judge of equilibria: a drawn scene is solved for its rest state, and is brought there by a slow, damped
// motion in time of gravity, loads, commands, obstacles and holds, all in step.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "drawn_scenes.h"
#include "study/experiment.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct DrawnSettings {
  std::uint64_t first_seed;
  int scenes, joined_scenes, robot_scenes;  // of one thing each, of several at once, and of robots
  std::vector<std::string> robots;          // files below config/
  std::vector<std::string> methods;         // of the equilibrium: "newton", "xpbd"
  double motion_s, time_step_s, rayleigh_mass_per_s;
  std::vector<double> slower_motions_s;    // for what is still apart, one after the other
  double within_m;                         // between the two rest states
  double still_m, still_for_s, longest_s;  // at rest: no node goes further than this in that time
};

// Throws SettingsError.
DrawnSettings read_drawn_settings(const YamlNode& node);

struct JudgedScene {
  std::string name;       // seed, kind, friction
  std::string method;     // of the equilibrium
  double apart_m = 0.0;   // the nodes at most
  double moved_m = 0.0;   // from the rest shape, in time
  double motion_s = 0.0;  // of the motion that judged last
  double rest_after_s = 0.0;
  double cpu_s = 0.0;  // of the equilibrium
  std::string said;    // kinds of the equilibrium's warnings
  std::string failed;  // what did not converge or come to rest
  bool open = false;   // the equilibrium names another side of a snap, or contact that the mesh is too coarse for
  // Whether the equilibrium is what time leads to, or says why not.
  bool right(double within_m) const { return failed.empty() && (apart_m <= within_m || open); }
};

// The same scene, moved to its end in a time of one's choice.
using DrawnMotion = std::function<DrawnScene(double motion_s)>;

// One for each method. Where one is apart from time, time is asked again in steps of a fifth, and then more slowly:
// time itself may be what is wrong. The last answer counts.
std::vector<JudgedScene> judge_drawn_scene(const DrawnMotion& draw, const DrawnSettings& settings,
                                           const ExperimentContext& context);

}  // namespace soft_robot_lab
