// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/motion/plan_motion.h"

#include <algorithm>
#include <cmath>

#include "control/pose_problem.h"
#include "control/refuse.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

constexpr double kLeastPiece_s = 1.0e-3;
constexpr double kSearch_m = 1.0e-5;
constexpr double kTurn = 0.25;  // of the play; smaller turns back are left out

Eigen::Index index_of(std::size_t i) { return static_cast<Eigen::Index>(i); }

// Rest states from one fixed state, as each is reached straight from there.
class StraightModel {
 public:
  StraightModel(Simulation& simulation, const std::string& marker)
      : simulation_(simulation), marker_(simulation.marker_index(marker)), start_(simulation.state()) {}

  Prediction operator()(const Eigen::VectorXd& commands, bool with_derivatives) {
    go(commands);
    Prediction prediction;
    prediction.markers_m = simulation_.marker_position(marker_);
    const Eigen::Index count = commands.size();
    prediction.tensions_n.resize(count);
    prediction.slack.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const ActuatorReading reading = simulation_.actuator_state(static_cast<int>(i));
      prediction.tensions_n[i] = reading.tension_n.value_or(0.0);
      prediction.slack[i] = reading.slack_m.value_or(0.0) * commands[i] / reading.commanded_length_m.value_or(1.0);
    }
    if (!with_derivatives) return prediction;
    try {
      prediction.marker_jacobian =
          simulation_.marker_sensitivities(&prediction.tension_jacobian).middleRows<3>(3 * marker_);
    } catch (const std::invalid_argument&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw ForwardModelError(error.what());
    }
    return prediction;
  }

  // The state at these commands becomes the next start.
  void keep(const Eigen::VectorXd& commands) {
    go(commands);
    start_ = simulation_.state();
  }

 private:
  void go(const Eigen::VectorXd& commands) {
    simulation_.set_state(start_);
    for (Eigen::Index i = 0; i < commands.size(); ++i)
      simulation_.set_command(simulation_.actuators()[static_cast<std::size_t>(i)]->name(), commands[i]);
    const SolveReport report = simulation_.solve_equilibrium();
    if (report.interrupted && asked_to_end(simulation_)) throw ForwardModelInterrupted();
    if (!report.converged) throw ForwardModelError(report.message);
  }

  Simulation& simulation_;
  int marker_;
  SimulationState start_;
};

std::vector<PathDrive> drives_of(const Simulation& model, const PathTask& task, std::vector<PathDrive> asked) {
  std::vector<PathDrive> drives;
  for (const auto& actuator : model.actuators()) {
    const CommandLimits& own = actuator->limits();
    const double own_rate_per_s = actuator->command_speed();
    PathDrive drive{actuator->name(), own.min, own.max,
                    own_rate_per_s > 0.0 ? own_rate_per_s : std::numeric_limits<double>::infinity(), 0.0};
    for (const PathDrive& one : asked) {
      if (one.actuator != drive.actuator) continue;
      if (!(one.play >= 0.0) || !(one.max_rate_per_s > 0.0))
        refuse("drive '", one.actuator, "': play ", one.play, " must be in [0, inf), max_rate_per_s ",
               one.max_rate_per_s, " in (0, inf]");
      drive = {one.actuator, std::max(own.min, one.min), std::min(own.max, one.max), one.max_rate_per_s, one.play};
    }
    for (const ActuatorBounds& bounds : task.bounds) {
      if (bounds.actuator != drive.actuator) continue;
      drive.min = std::max(drive.min, bounds.min);
      drive.max = std::min(drive.max, bounds.max);
      drive.max_rate_per_s = std::min(drive.max_rate_per_s, bounds.max_rate_per_s);
    }
    if (!(drive.min < drive.max)) refuse("limits of '", drive.actuator, "': ", drive.min, " is not below ", drive.max);
    drives.push_back(drive);
  }
  return drives;
}

// The search for rest states has limits of commands and tensions; rates are left to the times.
PolicyTask pose_task(const PathTask& task, const std::vector<PathDrive>& drives) {
  PolicyTask poses;
  for (const PathDrive& drive : drives) {
    ActuatorBounds bounds{drive.actuator, drive.min, drive.max};
    for (const ActuatorBounds& asked : task.bounds)
      if (asked.actuator == drive.actuator) bounds.max_tension_n = asked.max_tension_n;
    poses.bounds.push_back(bounds);
  }
  Pose pose;
  pose.goals = {{task.marker, task.curve.at(0.0), 1.0}};
  poses.poses = {pose};
  return poses;
}

void require_path(const PathTask& task) {
  if (!(task.curve.length_m() > 0.0)) refuse("curve: empty");
  if (!(task.tolerance_m > 0.0)) refuse("tolerance_m: ", task.tolerance_m, " is not in (0, inf)");
  if (!(task.duration_s >= 0.0)) refuse("duration_s: ", task.duration_s, " is not in [0, inf)");
  if (task.samples < 2) refuse("samples: ", task.samples, " is not in [2, 50000]");
}

std::size_t piece_at(const PathPlan& plan, double time_s, double& share) {
  const auto next = std::upper_bound(plan.samples.begin(), plan.samples.end(), time_s,
                                     [](double time, const PathSample& sample) { return time < sample.time_s; });
  const auto last = plan.samples.size() - 1;
  const auto i = std::clamp<std::size_t>(static_cast<std::size_t>(next - plan.samples.begin()), 1, last);
  const PathSample &a = plan.samples[i - 1], &b = plan.samples[i];
  share = std::clamp((time_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0);
  return i;
}

std::vector<double> piece_times(const PathPlan& plan, double duration_s) {
  PlayInverse play(plan.drives);
  Eigen::VectorXd before = play.go(plan.samples.front().commands);
  std::vector<double> times_s;
  for (std::size_t k = 1; k < plan.samples.size(); ++k) {
    const Eigen::VectorXd after = play.go(plan.samples[k].commands);
    const double share = (plan.samples[k].way_m - plan.samples[k - 1].way_m) / plan.curve.length_m();
    double piece_s = std::max(kLeastPiece_s, share * duration_s);
    for (std::size_t i = 0; i < plan.drives.size(); ++i)
      piece_s = std::max(piece_s, std::abs(after[index_of(i)] - before[index_of(i)]) / plan.drives[i].max_rate_per_s);
    times_s.push_back(piece_s);
    before = after;
  }
  return times_s;
}

// [1 2 1] / 4, ends kept.
void smooth(std::vector<Eigen::VectorXd>& values, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<Eigen::VectorXd> old = values;
    for (std::size_t k = 1; k + 1 < values.size(); ++k) values[k] = 0.25 * (old[k - 1] + 2.0 * old[k] + old[k + 1]);
  }
}

}  // namespace

Eigen::VectorXd PathPlan::commands_at(double time_s) const {
  double share = 0.0;
  const std::size_t i = piece_at(*this, time_s, share);
  return (1.0 - share) * samples[i - 1].commands + share * samples[i].commands;
}

Eigen::Vector3d PathPlan::target_at(double time_s) const {
  double share = 0.0;
  const std::size_t i = piece_at(*this, time_s, share);
  return curve.at((1.0 - share) * samples[i - 1].way_m + share * samples[i].way_m);
}

Eigen::Vector3d PathPlan::predicted_at(double time_s) const {
  double share = 0.0;
  const std::size_t i = piece_at(*this, time_s, share);
  return (1.0 - share) * samples[i - 1].predicted_m + share * samples[i].predicted_m;
}

const Eigen::MatrixXd& PathPlan::jacobian_at(double time_s) const {
  double share = 0.0;
  const std::size_t i = piece_at(*this, time_s, share);
  return samples[share < 0.5 ? i - 1 : i].jacobian;
}

double PathPlan::largest_unreachable_m() const {
  double most_m = 0.0;
  for (const PathSample& sample : samples) most_m = std::max(most_m, sample.unreachable_m);
  return most_m;
}

double PathPlan::largest_jacobian_m() const {
  double most_m = 0.0;
  for (const PathSample& sample : samples) most_m = std::max(most_m, sample.jacobian.norm());
  return most_m;
}

double PathPlan::predicted_rms_m() const {
  double squares_m2 = 0.0;
  for (const PathSample& sample : samples) squares_m2 += (sample.predicted_m - sample.aim_m).squaredNorm();
  return std::sqrt(squares_m2 / static_cast<double>(samples.size()));
}

PathPlan plan_motion(Simulation& model, const PathTask& task, std::vector<PathDrive> drives) {
  require_path(task);
  PathPlan plan;
  plan.marker = task.marker;
  plan.curve = task.curve;
  plan.drives = drives_of(model, task, std::move(drives));
  PolicyTask poses = pose_task(task, plan.drives);
  require_task(model, poses);
  OptimiserOptions options;
  options.tolerance_m = kSearch_m;
  StraightModel straight(model, task.marker);
  for (int k = 0; k < task.samples; ++k) {
    PathSample sample;
    sample.way_m = task.curve.length_m() * k / (task.samples - 1);
    sample.target_m = task.curve.at(sample.way_m);
    poses.poses.front().goals.front().target_m = sample.target_m;
    ReachProblem problem = pose_problem(model, poses, poses.poses.front());
    problem.model = [&](const Eigen::VectorXd& commands, bool derivatives) { return straight(commands, derivatives); };
    const OptimisationSummary found = optimise(problem, options);
    if (!found.usable) {
      plan.message = "no commands for " + std::to_string(sample.way_m) + " m along the curve: " + found.stop_reason;
      return plan;
    }
    sample.commands = found.commands;
    sample.jacobian = straight(found.commands, true).marker_jacobian;
    straight.keep(found.commands);
    sample.predicted_m = sample.aim_m = model.marker_position(model.marker_index(task.marker));
    sample.unreachable_m = (sample.predicted_m - sample.target_m).norm();
    sample.time_s = k;  // until it is timed
    plan.samples.push_back(sample);
  }
  plan.complete = true;
  retime(plan, task.duration_s);
  return plan;
}

void retime(PathPlan& plan, double duration_s) {
  if (!(duration_s >= 0.0)) refuse("duration_s: ", duration_s, " is not in [0, inf)");
  plan.fastest_s = 0.0;
  for (const double piece_s : piece_times(plan, 0.0)) plan.fastest_s += piece_s;
  double time_s = 0.0;
  const std::vector<double> pieces_s = piece_times(plan, duration_s);
  plan.samples.front().time_s = 0.0;
  for (std::size_t k = 1; k < plan.samples.size(); ++k) plan.samples[k].time_s = time_s += pieces_s[k - 1];
}

Eigen::Vector3d MarkerTrack::at(double asked_s) const {
  const auto next = std::upper_bound(time_s.begin(), time_s.end(), asked_s);
  if (next == time_s.begin()) return position_m.front();
  if (next == time_s.end()) return position_m.back();
  const auto i = static_cast<std::size_t>(next - time_s.begin());
  const double share = (asked_s - time_s[i - 1]) / (time_s[i] - time_s[i - 1]);
  return (1.0 - share) * position_m[i - 1] + share * position_m[i];
}

MarkerTrack play_in_time(Simulation& model, const PathPlan& plan) {
  const auto command = [&](double time_s) {
    const Eigen::VectorXd commands = plan.commands_at(time_s);
    for (std::size_t i = 0; i < plan.drives.size(); ++i)
      model.set_command(plan.drives[i].actuator,
                        std::clamp(commands[index_of(i)], plan.drives[i].min, plan.drives[i].max));
  };
  const int marker = model.marker_index(plan.marker);
  model.reset();
  model.solve_equilibrium();
  command(0.0);
  if (const SolveReport rest = model.solve_equilibrium(); !rest.converged)
    throw std::runtime_error("the path's start has no rest: " + rest.message);
  MarkerTrack track{{0.0}, {model.marker_position(marker)}};
  const double step_s = model.options().time_step_s;
  for (int step = 1; track.time_s.back() < plan.duration_s(); ++step) {
    command(step * step_s);
    if (const SolveReport report = model.step(); !report.converged)
      throw std::runtime_error("a step on the path does not converge: " + report.message);
    track.time_s.push_back(step * step_s);
    track.position_m.push_back(model.marker_position(marker));
  }
  return track;
}

void LearnOptions::validate() const {
  if (!(gain > 0.0 && gain <= 1.0)) refuse("gain: ", gain, " is not in (0, 1]");
  if (!(damping > 0.0 && damping <= 1.0)) refuse("damping: ", damping, " is not in (0, 1]");
  if (!(lag_s >= 0.0 && std::isfinite(lag_s))) refuse("lag_s: ", lag_s, " is not in [0, inf)");
  if (smoothing < 0 || smoothing > 1000) refuse("smoothing: ", smoothing, " is not in [0, 1000]");
}

Eigen::VectorXd damped_inverse(const Eigen::MatrixXd& jacobian, const Eigen::Vector3d& error_m, double damping_m) {
  const Eigen::Matrix3d normal = jacobian * jacobian.transpose() + damping_m * damping_m * Eigen::Matrix3d::Identity();
  return jacobian.transpose() * normal.ldlt().solve(error_m);
}

double learn(PathPlan& plan, const MarkerTrack& seen, const LearnOptions& options) {
  options.validate();
  std::vector<Eigen::VectorXd> corrections;
  const double damping_m = options.damping * plan.largest_jacobian_m();
  double squares_m2 = 0.0;
  for (const PathSample& sample : plan.samples) {
    const Eigen::Vector3d error_m = sample.aim_m - seen.at(sample.time_s + options.lag_s);
    squares_m2 += error_m.squaredNorm();
    corrections.push_back(options.gain * damped_inverse(sample.jacobian, error_m, damping_m));
  }
  smooth(corrections, options.smoothing);
  for (std::size_t k = 0; k < plan.samples.size(); ++k)
    for (std::size_t i = 0; i < plan.drives.size(); ++i) {
      double& command = plan.samples[k].commands[index_of(i)];
      command = std::clamp(command + corrections[k][index_of(i)], plan.drives[i].min, plan.drives[i].max);
    }
  return std::sqrt(squares_m2 / static_cast<double>(plan.samples.size()));
}

void finish_in_time(Simulation& model, PathPlan& plan, int rounds, const LearnOptions& options) {
  std::vector<PathSample> best;
  double best_m = std::numeric_limits<double>::infinity();
  for (int round = 0; round <= rounds; ++round) {
    const MarkerTrack track = play_in_time(model, plan);
    for (PathSample& sample : plan.samples) sample.predicted_m = track.at(sample.time_s);
    if (const double rms_m = plan.predicted_rms_m(); rms_m < best_m) {
      best_m = rms_m;
      best = plan.samples;
    }
    if (round < rounds) learn(plan, track, options);
  }
  plan.samples = best;
  plan.in_time = true;
}

PlayInverse::PlayInverse(const std::vector<PathDrive>& drives) : drives_(drives), paying_out_(drives.size(), false) {}

Eigen::VectorXd PlayInverse::go(const Eigen::VectorXd& wanted) {
  if (extreme_.size() == 0) extreme_ = wanted;
  Eigen::VectorXd turned = wanted;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const Eigen::Index at = index_of(i);
    const double back = paying_out_[i] ? extreme_[at] - wanted[at] : wanted[at] - extreme_[at];
    if (back > kTurn * drives_[i].play) paying_out_[i] = !paying_out_[i];
    if (back < 0.0 || back > kTurn * drives_[i].play) extreme_[at] = wanted[at];
    // Short of a turn the cable stays where it is; so does the drive, which its play would not let follow.
    turned[at] = std::clamp(extreme_[at] + (paying_out_[i] ? drives_[i].play : 0.0), drives_[i].min, drives_[i].max);
  }
  return turned;
}

CommandPolicy policy_of(const PathPlan& plan) {
  CommandPolicy policy;
  for (const PathDrive& drive : plan.drives) policy.names.push_back(drive.actuator);
  for (const PathSample& sample : plan.samples)
    policy.steps.push_back({sample.time_s, {sample.commands.data(), sample.commands.data() + sample.commands.size()}});
  return policy;
}

void take_commands(PathPlan& plan, const CommandPolicy& policy) {
  CommandLimitsByName limits;
  for (const PathDrive& drive : plan.drives) limits[drive.actuator] = {{drive.min, drive.min, drive.max, ""}};
  if (policy.names != policy_of(plan).names) refuse("names: not those of the plan's drives, in their order");
  if (policy.steps.size() != plan.samples.size())
    refuse("steps: ", policy.steps.size(), " where the plan has ", plan.samples.size(), " samples");
  validate(policy, limits);
  for (std::size_t k = 0; k < plan.samples.size(); ++k)
    plan.samples[k].commands =
        Eigen::Map<const Eigen::VectorXd>(policy.steps[k].values.data(), index_of(policy.steps[k].values.size()));
}

}  // namespace soft_robot_lab
