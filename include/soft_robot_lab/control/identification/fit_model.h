// SPDX-License-Identifier: BSD-3-Clause
// Fits numbers of a robot's scene, and where the cameras stand, to markers measured at rest: Levenberg-Marquardt with
// bounds and a robust loss (Ceres), on exact derivatives of the equilibria (Simulation::parameter_sensitivities). Then,
// with these numbers, its damping to markers measured while the robot swung.
//
// Parameters by name; one for all cables unless a cable is named after a dot ("compliance_m_n.left"):
//   youngs_modulus_pa, density_kg_m3   all moduli of the material grow with the first; the second if not weighed
//   friction_coefficient  of cables, which then are of model friction; depends on the order of the poses
//   compliance_m_n        of cables: their own stretch and the plug's sinking in beyond the model's
//   length_offset_m       one for each cable: what it is longer (slack) or shorter than commanded
//   backlash_m            one for each cable that commands a length: so much further its drive turns before it pays out
//   camera_to_base        six: measured = R p + t of a point p of robot_base, t [m] and R's rotation vector [rad]
//   creep                 two: body.hysteresis.stiffness_ratio and .relaxation_time_s, by how markers go on moving
//                         while a command is held. All numbers are then fitted together, to the robot in time
//   damping               body.damping.rayleigh_stiffness_s: swings die away by it, and by what the integrator damps in
//                         the scene's own time step. Left as it is, with a warning, where nothing swings
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

struct MeasuredMarker {
  std::string name;
  Eigen::Vector3d position_m;     // robot_base, as the tracker believes it stands
  Eigen::Matrix3d covariance_m2;  // positive semi-definite
};

struct MarkersAt {
  double time_s = 0.0;
  std::vector<MeasuredMarker> markers;
};

// A rest state; in a list they stand in the order in which the rig went through them, from rest commands.
struct MeasuredPose {
  std::map<std::string, double> commands;  // by actuator; those not listed rest
  std::vector<MeasuredMarker> markers;
  std::map<std::string, double> reached = {};  // where drives really stood, of which that is known: between whole steps
  // For creep, all since the command came: until when it was held, since when `markers` are averaged, and what short
  // times of it saw. Not known where held_s is 0.
  double held_s = 0.0, rest_from_s = 0.0;
  std::vector<MarkersAt> seen = {};
  std::string left_out = {};  // why there are no markers, in words for its reader; empty where nothing is to be said
};

// From rest under `from`, moved by `commands`, then left to itself. All times by one clock.
struct MeasuredSwing {
  std::map<std::string, double> from;   // by actuator; those not listed rest
  std::vector<TimedCommands> commands;  // at least one, in order of time
  std::vector<MarkersAt> seen;          // since the first of them, in order of time
};

struct FitParameter {
  std::string name;
  std::optional<double> start, min, max;  // otherwise the scene's value, and bounds that suit the parameter
};

constexpr double kLeastMass_kg = 1.0e-6;  // of a robot that is weighed

struct FitRequest {
  std::vector<FitParameter> parameters;
  std::optional<double> mass_kg;    // [1e-6, 1e6], of the whole body, weighed; otherwise the scene's density stands
  double model_error_m = 1.0e-4;    // >= 0; by how much a perfect fit would still miss a coordinate, beside the noise
  double outlier_deviations = 3.0;  // > 0; beyond, a residual counts linearly (Huber 1964)
  int max_iterations = 30;          // [1, 1000]
  std::function<bool(int iteration, double rms_gap_m)> progress;  // may be empty; false stops with the best so far
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

struct FittedValue {
  std::string name;
  double start = 0.0, value = 0.0;
  double deviation = 0.0;  // standard
  // Of 95 %, within the bounds. The variance is that of the residuals, at least the stated noise, so a model that
  // misses widens it; residuals count as independent. What a robot would still creep after its holds, by its markers'
  // drifts late in them, widens it too where creep is not fitted.
  double low = 0.0, high = 0.0;
  double min = 0.0, max = 0.0;
  bool identifiable = true;  // from the data; otherwise the interval is all that the bounds leave
};

struct ModelGap {
  double rms_m = 0.0;  // of the distances of all markers at all poses
  std::map<std::string, double> marker_rms_m;
};

// One rest state that had markers; rms over these.
struct FittedConfiguration {
  std::map<std::string, double> commands;
  double before_m = 0.0, after_m = 0.0;
  bool outlying = false;  // after the fit far beyond the others
};

struct FitResult {
  bool converged = false;
  std::string message;  // why it stopped
  std::vector<FittedValue> values;
  Eigen::MatrixXd correlations;       // of the values, ones on the diagonal
  std::vector<std::string> warnings;  // what the data cannot identify, and configurations that are left out
  ModelGap before, after;             // at rest
  std::vector<FittedConfiguration> configurations;
  int swings = 0;            // that identified the damping
  double swing_rms_m = 0.0;  // by which the fitted model misses them
  int iterations = 0;
  double cpu_s = 0.0;
  Overrides overrides;                       // to be laid over the scene: what is identifiable
  std::map<std::string, double> backlash_m;  // by cable, of those that were fitted; no scene holds it
  Eigen::Isometry3d measured_from_base = Eigen::Isometry3d::Identity();
};

// Throws std::invalid_argument for unknown names, values out of range, too few data; std::runtime_error where the scene
// has no equilibrium at its present values. Where `options.interrupt` answers true, solves end, and the best so far is
// the result, where the first iteration has one; else it throws std::runtime_error.
FitResult fit_model(const std::string& scene, const SceneOptions& options, const std::vector<MeasuredPose>& poses,
                    const FitRequest& request, const std::vector<MeasuredSwing>& swings = {});

// How far the scene, with options.changes, is from poses; drives with backlash go through them in their order.
ModelGap model_gap(const std::string& scene, const SceneOptions& options, const std::vector<MeasuredPose>& poses,
                   const Eigen::Isometry3d& measured_from_base = Eigen::Isometry3d::Identity(),
                   const std::map<std::string, double>& backlash_m = {});

// Throws std::invalid_argument where no file can be written: better known before a fit than after it.
void require_writable(const std::string& file);

// Throws std::invalid_argument where the file is the scene, or one that it includes: a fitted scene would include
// itself.
void require_not_read(const std::string& file, const std::string& scene);

// Throws std::invalid_argument for what is there and no fit wrote: for a name that comes from elsewhere than the user's
// own command line.
void require_own_or_new(const std::string& file);

// A scene that includes `scene` and lays the fit over it; comments say the deviations, the gap and the cameras' place.
// Throws std::runtime_error where it cannot be written.
void write_fitted_scene(const FitResult& result, const std::string& scene, const std::string& file);

// Values, deviations, correlations beyond 0.9, warnings and gap in some lines.
std::string summary(const FitResult& result);

}  // namespace soft_robot_lab
