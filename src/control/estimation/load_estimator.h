// SPDX-License-Identifier: BSD-3-Clause
// What loads from outside act on a robot, by markers that are measured while it rests at known commands: none, a push
// at an unknown place of the skin, two pushes, a weight that hangs at a marker, or something else that has changed (the
// modulus, a drive's offset, the place of a camera).
//
// By reciprocity one solve for each marker's axes gives C_p = d markers / d force at p for all places p of the skin. A
// push lies in the friction cone around the inward normal; its force is the most probable one of
//     1/2 |y - m - C_p f|^2_{R^-1} - log p(f),  p a mixture of normal distributions about zero,
// and hypotheses are weighed by their evidence (Laplace's approximation; MacKay, Information Theory, Inference, and
// Learning Algorithms, chapter 28), places by their area. C is made anew where the loaded model rests (Gauss-Newton),
// as a soft body's compliance changes much with its shape.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/identification/fit_model.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

struct LoadEstimationOptions {
  double place_spacing_m = 0.004;     // > 0; distance of places that are tried
  double friction_coefficient = 0.5;  // [0, 10], of what pushes
  // Forces of this size are looked for: the standard deviations of a mixture reach from one to the other.
  double least_force_n = 0.01;       // > 0
  double most_force_n = 0.25;        // >= least_force_n
  double false_alarm_rate = 1.0e-4;  // (0, 0.5); of a look at an untouched robot
  // Errors of a coordinate beside its covariance, standard deviations; the model's:
  double model_error_m = 3.0e-5;    // >= 0; where offsets were taken at this pose
  double model_error_ratio = 0.02;  // [0, 1]; of how far loads have moved the marker
  double compliance_error = 0.05;   // [0, 1]; of how far all markers have moved by loads, together
  // Where markers have moved by pose_change_m or more since offsets were taken; nearer, these grow with the way. The
  // first is of each coordinate, the others move all markers together: of a drive (play, friction), of a modulus.
  double pose_error_m = 2.0e-4;     // >= 0
  double command_error = 0.006;     // >= 0; of the command's range
  double modulus_error = 0.03;      // >= 0; relative
  double pose_change_m = 0.005;     // > 0
  double unknown_error_m = 1.0e-3;  // > 0; where the marker's offset was never taken
  double observable_m = 0.009;      // > 0; a place that is less sure than this is not called observable
  double modulus_drift = 0.2;       // > 0; standard deviation, relative
  double command_drift = 0.02;      // > 0; standard deviation, of the command's range
  void validate() const;            // throws std::invalid_argument: field, value, allowed range
};

enum class LoadKind {
  none,
  push,
  two_pushes,
  weight,
  modulus,  // not a load: all moduli have changed
  command,  // an actuator's offset has
  frame,    // markers moved as one rigid body: a camera, or the robot's foot, stands elsewhere
  unknown   // what was measured fits none of these
};
const char* name_of(LoadKind kind);

// A force on the skin, or a weight at a marker. Positions are where the loaded robot is; robot_base.
struct EstimatedLoad {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d position_covariance_m2 = Eigen::Matrix3d::Zero();
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Matrix3d force_covariance_n2 = Eigen::Matrix3d::Zero();
  // The place can be known to observable_m. Where not, force and position are the most probable, and may be far off.
  bool observable = false;
  std::string marker;  // of a weight; empty for a push
};

struct LoadEstimate {
  LoadKind kind = LoadKind::none;
  double probability = 1.0;                          // of the kind, among those that were weighed
  std::vector<EstimatedLoad> loads;                  // of a push one, of two pushes two, of a weight one
  std::string actuator;                              // of kind command
  double change = 0.0;                               // kinds modulus: relative; command: in the command's unit
  double chi2_unloaded = 0.0, chi2 = 0.0;            // of the coordinates seen; without a load, and as estimated
  int coordinates = 0;                               // seen: 3 for each marker
  std::map<std::string, Eigen::Vector3d> markers_m;  // all markers, also those not seen, as estimated with offsets
  std::map<LoadKind, double> log_evidence;           // of what was weighed, relative to no load
  std::string message;                               // why nothing is known, in words; empty otherwise
};

class LoadEstimator {
 public:
  // `model` moves while estimates are made, and stands as before after them. Throws std::invalid_argument for options
  // out of range, and a model without markers.
  LoadEstimator(Simulation& model, const LoadEstimationOptions& options);
  ~LoadEstimator();

  // Takes markers of an untouched robot at rest for where the model should have them: their offsets count from now on.
  // The model rests at the robot's commands. Throws as estimate() does, and changes nothing then.
  void take_offsets(const std::vector<MeasuredMarker>& measured);

  // The model rests, without loads, at the robot's commands. Throws std::invalid_argument for names that there are not
  // or come twice, numbers that are not finite and covariances that are not positive semi-definite.
  LoadEstimate estimate(const std::vector<MeasuredMarker>& measured);

  // Of the last estimate: the shape under its loads. The model's present one before there was any.
  const SimulationState& estimated_state() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace soft_robot_lab
