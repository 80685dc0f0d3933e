#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/experiment/experiment.h"
#include "soft_robot_lab/scene/scene.h"

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

struct ChamberSettings {
  std::string chamber;                                      // empty: the robot's first actuator
  std::vector<std::pair<std::string, std::string>> meshes;  // name, scene file
  std::vector<double> betas;                                // in the order of filling
  std::string changes;                                      // laid over every mesh's scene
};

// config/experiments/NAME.yaml: meshes: {NAME: FILE}, betas, chamber, and scene, which is laid over every mesh's file.
ChamberSettings read_chamber_settings(const ExperimentContext& context, const std::string& name);

// A run per mesh. Solves that fail or leave an element inverted are told in `result`.
std::vector<ChamberRun> run_chambers(const ExperimentContext& context, const ChamberSettings& settings,
                                     ExperimentResult& result);

double worst_gas_residual(const std::vector<ChamberRun>& runs);

// The nodes of the outer skin, which bears no name, in two axes [mm].
Series skin(const ChamberRun& run, const ChamberState& state, int x_axis, int y_axis, const std::string& label);

}  // namespace soft_robot_lab
