// SPDX-License-Identifier: BSD-3-Clause
// The measured tentacle of config/reference/tentacle, as its JSON file has it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

struct TentacleMaterial {
  double youngs_modulus_pa, poissons_ratio, density_kg_m3;
  Overrides overrides() const;  // to be laid over the robot
};

struct TentaclePose {
  MeasuredPose measured;
  std::string session;  // of two set-ups, with the markers put on again
  // Published mean distances of others' models: of soromox at its start material (session A only) and at the identified
  // one, and of a converged rod at the identified one.
  std::optional<double> soromox_start_m;
  double soromox_identified_m = 0.0, rod_identified_m = 0.0;
  std::map<std::string, Eigen::Vector3d> rod_m;  // where the rod has the markers
};

struct MeasuredTentacle {
  TentacleMaterial start, identified;                     // of soromox
  std::vector<TentaclePose> poses;                        // tension grows
  std::map<std::string, Eigen::Vector3d> hanging_rest_m;  // of the converged rod, without tension
  // Mean distances over all poses, as published with the data: of soromox at the start material (session A) and at the
  // identified one, and of a converged rod fitted to all of them.
  double soromox_start_m = 0.0, soromox_identified_m = 0.0, fitted_rod_m = 0.0;
};

// Throws std::runtime_error: unreadable, or not what is described above.
MeasuredTentacle read_measured_tentacle(const std::string& file);

// Mean over all markers of all poses of how far the scene, with options.changes, has them from where they were
// measured; and the mean vectors (model less measured) by marker.
struct TentacleGap {
  double mean_m = 0.0;
  std::vector<double> pose_mean_m;
  std::map<std::string, Eigen::Vector3d> offset_m;
  std::vector<Eigen::Matrix3Xd> markers_m;  // of the model, by pose
};
TentacleGap tentacle_gap(const std::string& robot, const SceneOptions& options, const std::vector<MeasuredPose>& poses);

}  // namespace soft_robot_lab
