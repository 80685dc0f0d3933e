// SPDX-License-Identifier: BSD-3-Clause
// A curve that a marker shall follow in time, the file that names it (config/README.md, "Path"), and commands for it.
// Commands in time with which a marker follows a curve: rest states along it, each from the one before, so that a
// cable's friction counts as on the way; then times that the drives can keep; then, where it is asked for, corrections
// by the model's own motion in time, which has creep, inertia and the drives' speed.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// A chain of straight pieces by the way along it. Lengths in m, places in robot_base.
class Curve {
 public:
  Curve() = default;
  // Throws std::invalid_argument: fewer than two points, one that is not finite, or one within 1e-9 m of the one
  // before.
  explicit Curve(std::vector<Eigen::Vector3d> points_m);

  double length_m() const { return ways_m_.empty() ? 0.0 : ways_m_.back(); }
  Eigen::Vector3d at(double way_m) const;  // beyond its ends: these

 private:
  std::vector<Eigen::Vector3d> points_m_;
  std::vector<double> ways_m_;
};

struct PathTask {
  std::string marker;
  Curve curve;
  double tolerance_m = 5.0e-4;  // > 0; by so much may the marker miss the curve
  double duration_s = 20.0;     // >= 0; 0: as fast as the drives turn
  int samples = 96;             // [2, 50000], of commands along the curve, its ends among them
  std::vector<ActuatorBounds> bounds = {};
};

// Throws SettingsError: file, line, key, value, allowed range.
PathTask load_path_task(const std::string& file);
PathTask parse_path_task(const std::string& text, const std::string& source_name);

struct PathSample {
  double time_s = 0.0;       // since the start of the path, rising
  double way_m = 0.0;        // along the curve
  Eigen::VectorXd commands;  // by actuator: what the cables shall have, without the drives' play
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero(), predicted_m = Eigen::Vector3d::Zero();  // robot_base
  Eigen::Vector3d aim_m = Eigen::Vector3d::Zero();  // the nearest rest state to the target
  Eigen::MatrixXd jacobian;                         // 3 x actuators [m per command], of rest states
  double unreachable_m = 0.0;                       // distance of the nearest rest state from the target
};

struct PathDrive {
  std::string actuator;
  double min = 0.0, max = 0.0;  // of the command
  double max_rate_per_s = 0.0;  // > 0 of the command; infinity for none
  double play = 0.0;            // >= 0, of the command: paying out, the drive turns so far before the cable follows
};

struct PathPlan {
  std::string marker;
  Curve curve;
  std::vector<PathDrive> drives;  // by actuator, in the model's order
  std::vector<PathSample> samples;
  double fastest_s = 0.0;  // that the drives allow
  bool complete = false;   // a rest state was found for each sample
  bool in_time = false;    // predicted_m are of motion in time; else of rest states
  std::string message;     // where it is not complete: why

  double duration_s() const { return samples.back().time_s; }
  Eigen::VectorXd commands_at(double time_s) const;         // linear between samples; before and after: the ends
  Eigen::Vector3d target_at(double time_s) const;           // on the curve
  Eigen::Vector3d predicted_at(double time_s) const;        // linear
  const Eigen::MatrixXd& jacobian_at(double time_s) const;  // of the nearest sample
  double largest_unreachable_m() const;
  double largest_jacobian_m() const;  // norm over the samples
  double predicted_rms_m() const;     // of predicted_m from aim_m
};

// From the model's present rest state, which it leaves at the last sample's. The drives' limits and rates are `drives`'
// and the task's, else the actuators' own. `fastest_s` and times are by retime(). Throws std::invalid_argument naming
// field, value and allowed range, and ForwardModelInterrupted where the model's interrupt asks for an end.
PathPlan plan_motion(Simulation& model, const PathTask& task, std::vector<PathDrive> drives = {});

// Times: the curve at even speed in `duration_s`, slower where a drive would be too slow, play included; 0: as fast as
// the drives turn. Sets fastest_s too.
void retime(PathPlan& plan, double duration_s);

// Where a marker was, in order of time.
struct MarkerTrack {
  std::vector<double> time_s;
  std::vector<Eigen::Vector3d> position_m;
  Eigen::Vector3d at(double time_s) const;  // linear; before and after: the ends. Must not be empty.
};

// The model at rest at the first commands, then moved along the plan in time steps, by ideal drives of its own speed.
// Throws std::runtime_error where a step does not converge.
MarkerTrack play_in_time(Simulation& model, const PathPlan& plan);

struct LearnOptions {
  double gain = 0.7;      // (0, 1], of an error that is corrected in one round
  double damping = 0.05;  // (0, 1], of the largest Jacobian: errors that ask for larger commands are left
  double lag_s = 0.0;     // >= 0, from a command to the marker
  int smoothing = 2;      // [0, 1000], passes of a binomial filter over the corrections
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

// Corrects the plan's commands by where the marker was, within the drives' limits. The rms of its distances from aim_m
// before.
double learn(PathPlan& plan, const MarkerTrack& seen, const LearnOptions& options);

// Rounds of learning on the model in time; keeps the best of them, and predicted_m of it. Throws as play_in_time.
void finish_in_time(Simulation& model, PathPlan& plan, int rounds, const LearnOptions& options);

// J^T (J J^T + damping^2)^-1 error, the commands that mend an error at a marker.
Eigen::VectorXd damped_inverse(const Eigen::MatrixXd& jacobian, const Eigen::Vector3d& error_m, double damping_m);

// What drives are commanded so that cables get what they shall have in spite of play. Pulling lowers the command.
class PlayInverse {
 public:
  explicit PlayInverse(const std::vector<PathDrive>& drives);  // the last motion was a pull
  // Turns that are smaller than a quarter of the play are no turns. Within the limits.
  Eigen::VectorXd go(const Eigen::VectorXd& wanted);

 private:
  std::vector<PathDrive> drives_;
  std::vector<bool> paying_out_;
  Eigen::VectorXd extreme_;
};

// The plan's commands as a policy to be stored and played; and back, into a plan of as many samples. The latter throws
// std::invalid_argument where names or numbers of samples differ, or a command is beyond its limits.
CommandPolicy policy_of(const PathPlan& plan);
void take_commands(PathPlan& plan, const CommandPolicy& policy);

}  // namespace soft_robot_lab
