// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "study/experiment.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// A robot at rest with its chamber filled.
struct ChamberState {
  double beta = 1.0;
  SolveReport solve;
  ActuatorReading chamber;
  double gas_residual = 0.0;     // the largest of all the robot's chambers
  Eigen::Matrix3Xd markers_m;    // one column per marker
  Eigen::Matrix3Xd positions_m;  // one column per node
};

// A robot on one mesh, filled step by step.
struct ChamberRun {
  std::string mesh;  // as the settings call it
  Scene scene;
  std::vector<ChamberState> states;  // one per beta; fewer where one did not converge

  const Simulation& simulation() const { return *scene.simulation; }
  Eigen::Vector3d moved_m(const ChamberState& state, const std::string& marker) const;  // from states.front()
};

struct ChamberMesh {
  std::string name, file;
  std::vector<double> betas;  // in the order of filling
};

// Filled in time as the source does: by so much a time step, then held.
struct PumpSettings {
  std::string mesh;
  double beta = 1.0, beta_per_step = 0.01;
  double duration_s = 0.0;  // in all
};

struct ChamberSettings {
  std::string chamber;  // empty: the robot's first actuator
  Overrides overrides;  // laid over the scenes
  std::vector<ChamberMesh> meshes;
  std::optional<PumpSettings> pump;
};

// config/experiments/NAME.yaml: meshes: {NAME: FILE}, betas: [...] or {NAME: [...]}, chamber, set_up, pump.
ChamberSettings read_chamber_settings(const ExperimentContext& context, const std::string& name);

// A run per mesh, each beta a rest state reached from the one before. Solves that fail or leave an element inverted are
// reported in `result`.
std::vector<ChamberRun> run_chambers(const ExperimentContext& context, const ChamberSettings& settings,
                                     ExperimentResult& result);

struct Pumping {
  ChamberRun run;  // states: before the first step, and after the last
  std::vector<double> time_s, volume_m3, gauge_pressure_pa;
};

// From the rest state at beta 1; `settings` must have a pump. Steps that fail are reported in `result`.
Pumping pump_chamber(const ExperimentContext& context, const ChamberSettings& settings, ExperimentResult& result);

double worst_gas_residual(const std::vector<ChamberRun>& runs);

// The first and the last state by the body's edges where its faces meet at an angle, in two axes: 0 is x.
Plot outline_plot(const ChamberRun& run, const std::string& name, const std::string& title, int x_axis, int y_axis);

}  // namespace soft_robot_lab
