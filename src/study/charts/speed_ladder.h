// SPDX-License-Identifier: BSD-3-Clause
// What chart_speed_accuracy compares: config/experiments/speed_accuracy.yaml.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "motion_chart.h"
#include "published_figure.h"
#include "rollout_rates.h"
#include "study/experiment.h"

namespace soft_robot_lab {

struct SpeedProblem {
  std::string name;
  std::string title;
  std::string scene;                          // file
  double size_m = 0.0;                        // thickness of the body
  double duration_s = 0.0;                    // of a run from rest that shall come to rest
  std::vector<std::string> poissons_ratios;   // as the tables write them
  std::vector<Eigen::Vector3d> references_m;  // per Poisson's ratio: displacement of the first judged point
  Eigen::Matrix3Xd points_m;                  // all that are judged, of the rest shape
  std::vector<Eigen::Matrix3Xd> curves_m;     // per Poisson's ratio: their displacements
};

struct SpeedRung {
  std::string name;
  Overrides overrides;  // laid over the scene; Bullet's own settings where `bullet`
  bool bullet = false;
  bool settled = true;
  bool equilibrium = true;
  bool quick = true;                  // run with --quick too
  std::vector<std::string> problems;  // empty: all
  std::vector<double> sizes;          // of the elements, as parts of the body's thickness; coarse to fine
};

// How costs grow with nodes: one problem at one Poisson's ratio, for a short time.
struct NodeCosts {
  SpeedProblem problem;
  std::vector<SpeedRung> rungs;   // ours, then Bullet's
  double stop_after_cpu_s = 0.0;  // a series goes no finer after a run that took longer
  int from_nodes = 0;             // meshes that exponents are of
};

struct ReleaseRung {
  std::string name;
  std::string integrator;
  std::vector<double> steps_s;
};

struct ReleaseProblem {
  std::string scene;
  double duration_s = 0.0;
  double element_size_m = 0.0;
  std::vector<ReleaseRung> rungs;
};

// A result of others on the cantilever.
struct ElsewherePoint {
  std::string name;
  std::string poissons_ratio;
  std::optional<double> cost;  // CPU-seconds per simulated second; not known for every point
  double error_percent = 0.0;
};

struct SpeedLadder {
  double time_step_s = 0.0;
  double judged_s = 0.0;
  double stop_after_cpu_s = 0.0;
  std::vector<SpeedProblem> problems;
  std::vector<SpeedRung> rungs;  // ours, then Bullet's
  ReleaseProblem release;
  std::vector<ElsewherePoint> elsewhere;
  NodeCosts nodes;
  MotionProblem motion;
  RolloutProblem rollouts;
  std::vector<PublishedFigure> published;
};

// Throws SettingsError, or std::runtime_error where no table knows a problem's Poisson's ratio.
SpeedLadder read_speed_ladder(const ExperimentContext& context);

// Only the named problems and Poisson's ratios; empty: all. Throws std::invalid_argument for an unknown problem, or
// where nothing is left.
SpeedLadder choose_problems(SpeedLadder ladder, const std::vector<std::string>& names,
                            const std::vector<std::string>& poissons_ratios);

// The two coarsest sizes of the quick rungs on the first problem at its first and last Poisson's ratio.
SpeedLadder quick_part(SpeedLadder ladder);

}  // namespace soft_robot_lab
