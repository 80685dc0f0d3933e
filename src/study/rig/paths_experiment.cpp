// SPDX-License-Identifier: BSD-3-Clause
#include "paths_experiment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "control/configuration_table.h"
#include "fit_rig_experiment.h"
#include "lab_settings.h"
#include "path_run.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

struct NamedPath {
  std::string name;
  PathTask task;
  bool fastest = true;  // as well, as fast as the drives turn
};

struct RobotPaths {
  std::string name;
  LabFiles files;
  bool fitted = false;  // as experiments/fit_rig.yaml
  Overrides overrides = {};
  std::map<std::string, double> backlash_m = {};
  double frame_rate_hz = 28.0;
  std::vector<NamedPath> paths = {};
  std::vector<Configuration> configurations = {};  // of `returns`
  std::vector<std::string> come_back = {};
};

struct PathsSettings {
  PathEyes eyes;
  FollowOptions follow;
  LearnOptions learn;
  double reserve = 0.2;  // of the drives' speed, left to corrections
  int rounds = 3, model_rounds = 3, rest_states = 16;
  std::vector<RobotPaths> robots;
};

RobotPaths read_robot(const YamlNode& node, double frame_rate_hz, const ExperimentContext& context) {
  RobotPaths robot{node.text("name"), read_lab_files(node, context)};
  robot.fitted = node.boolean("fitted");
  robot.frame_rate_hz = node.number_or("frame_rate_hz", frame_rate_hz, {1.0, 120.0});
  if (const auto changes = node.optional_child("overrides")) robot.overrides = Overrides(*changes);
  if (const auto plays = node.optional_child("backlash_m"))
    for (const std::string& name : plays->keys()) robot.backlash_m[name] = plays->number(name, {0.0, 0.1});
  if (node.has("returns")) {
    const YamlNode table = YamlNode::load_file(context.settings_file(node.text("returns")));
    robot.configurations = read_configurations(table);
    for (const YamlNode& name : table.sequence("come_back")) robot.come_back.push_back(name.as_text());
  }
  for (const YamlNode& path : node.sequence("paths"))
    robot.paths.push_back({path.text("name"), load_path_task(context.config_folder + "/" + path.text("task")),
                           path.boolean_or("fastest", true)});
  return robot;
}

PathsSettings read_paths_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("paths"));
  PathsSettings settings;
  settings.eyes.frame_rate_hz = node.number("frame_rate_hz", {1.0, 120.0});
  settings.eyes.delay_s = node.number("delay_s", {0.0, 1.0});
  if (node.has("noise_m")) settings.eyes.noise_m = node.number("noise_m", {0.0, 1.0});
  settings.follow.gain = node.number("gain", {0.0, 1.0, true, false});
  settings.follow.drive_lag_s = settings.follow.lead_s = node.number("drive_lag_s", {0.0, 1.0});
  settings.learn.gain = node.number("learning_gain", {0.0, 1.0, true, false});
  settings.learn.smoothing = node.integer("learning_smoothing", 0, 1000);
  settings.reserve = node.number("reserve", {0.0, 0.9});
  settings.rounds = node.integer("rounds", 1, 100);
  settings.model_rounds = node.integer("model_rounds", 0, 100);
  settings.rest_states = node.integer("rest_states", 1, 1000);
  for (const YamlNode& robot : node.sequence("robots"))
    settings.robots.push_back(read_robot(robot, settings.eyes.frame_rate_hz, context));
  node.require_all_read();
  return settings;
}

// Of one path at one speed.
struct PathOutcome {
  std::string robot, name;
  PathPlan plan;
  bool reached = false;  // within the task's tolerance at all samples
  PathRecord rest_states, open_loop, feedback;
  std::vector<PathRecord> rounds;
};

// Today's way: a policy of rest states, played from each to the next.
PathPlan rest_state_plan(Simulation& model, const PathPlan& timed, int states) {
  PolicyTask task;
  for (const PathDrive& drive : timed.drives) task.bounds.push_back({drive.actuator, drive.min, drive.max});
  std::vector<double> times_s;
  for (int k = 0; k <= states; ++k) {
    times_s.push_back(timed.duration_s() * k / states);
    Pose pose;
    pose.goals = {{timed.marker, timed.target_at(times_s.back()), 1.0}};
    pose.duration_s = timed.duration_s() / states;
    task.poses.push_back(pose);
  }
  model.reset();
  model.solve_equilibrium();
  const PolicyAnswer answer = find_policy(model, task, {});
  PathPlan plan = timed;
  for (PathDrive& drive : plan.drives) drive.play = 0.0;
  plan.samples.clear();
  for (std::size_t k = 0; k < answer.policy.steps.size(); ++k) {
    const std::vector<double>& values = answer.policy.steps[k].values;
    PathSample sample;
    sample.time_s = times_s[k];
    sample.way_m = timed.curve.length_m() * static_cast<double>(k) / states;
    sample.commands = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    sample.target_m = task.poses[k].goals.front().target_m;
    sample.predicted_m = answer.summaries[k].markers_m.col(0);
    plan.samples.push_back(sample);
  }
  plan.complete = answer.success;
  if (!answer.success) plan.message = "rest states: " + answer.summaries.back().stop_reason;
  return plan;
}

// The target is where the curve is at that time, not on the chord between rest states.
void aim_at(const PathPlan& plan, PathRecord& record) {
  for (std::size_t i = 0; i < record.time_s.size(); ++i) record.target_m[i] = plan.target_at(record.time_s[i]);
}

// Of the plane of the curve: across which its samples spread least.
Eigen::Vector3d normal_of(const PathPlan& plan) {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const PathSample& sample : plan.samples) mean_m += sample.target_m / static_cast<double>(plan.samples.size());
  Eigen::Matrix3d spread_m2 = Eigen::Matrix3d::Zero();
  for (const PathSample& sample : plan.samples)
    spread_m2 += (sample.target_m - mean_m) * (sample.target_m - mean_m).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread_m2).eigenvectors().col(0);
}

// Of the model's nearest rest states from the curve.
Eigen::Vector3d mean_off_m(const PathPlan& plan) {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const PathSample& sample : plan.samples)
    mean_m += (sample.aim_m - sample.target_m) / static_cast<double>(plan.samples.size());
  return mean_m;
}

// What is left on a path that leaves the reachable set where the model is nearest to it everywhere.
double nearest_rms_m(const PathPlan& plan) {
  double squares_m2 = 0.0;
  for (const PathSample& sample : plan.samples) squares_m2 += (sample.aim_m - sample.target_m).squaredNorm();
  return std::sqrt(squares_m2 / static_cast<double>(plan.samples.size()));
}

class RobotRun {
 public:
  RobotRun(const RobotPaths& robot, const PathsSettings& settings, const ExperimentContext& context)
      : robot_(robot), settings_(settings), context_(context), eyes_(settings.eyes) {
    eyes_.frame_rate_hz = robot.frame_rate_hz;
    Overrides changes = robot.overrides;
    std::map<std::string, double> backlash_m = robot.backlash_m;
    if (robot.fitted) {
      const FitResult fit = fit_emulated_rig(context);
      changes = fit.overrides;
      backlash_m = fit.backlash_m;
      eyes_.base_from_measured = fit.measured_from_base.inverse();
    }
    model_ = load_scene(robot.files.robot, context.scene_options(changes));
    drives_ = drives_of(robot.files.lab.rig, backlash_m, robot.frame_rate_hz);
    lab_ = std::make_unique<EmulatedLab>(robot.files.lab, context.scene_options());
    if (!settings.eyes.noise_m) lab_->calibrate(robot.files.balls);
    for (const auto& actuator : model_.simulation->actuators()) rest_.push_back(actuator->limits().rest);
  }

  PathOutcome run(const NamedPath& path, double duration_s) {
    PathOutcome outcome;
    outcome.robot = robot_.name;
    outcome.name = path.name + (duration_s > 0.0 ? ", slow" : ", fastest");
    Simulation& model = *model_.simulation;
    model.reset();
    model.solve_equilibrium();
    context_.report(0.5, outcome.robot + ", " + outcome.name + ": planning");
    outcome.plan = plan_motion(model, path.task, drives_);
    if (!outcome.plan.complete) throw std::runtime_error(outcome.name + ": " + outcome.plan.message);
    const std::vector<PathDrive> full = outcome.plan.drives;
    for (PathDrive& drive : outcome.plan.drives) drive.max_rate_per_s *= 1.0 - settings_.reserve;
    retime(outcome.plan, duration_s);
    outcome.plan.drives = full;
    outcome.reached = outcome.plan.largest_unreachable_m() <= path.task.tolerance_m;
    const PathPlan today = rest_state_plan(model, outcome.plan, settings_.rest_states);
    LearnOptions on_model;
    on_model.lag_s = 0.0;
    finish_in_time(model, outcome.plan, settings_.model_rounds, on_model);
    std::ostringstream words;
    words << outcome.robot << ", " << outcome.name << ": " << 1e3 * outcome.plan.largest_unreachable_m()
          << " mm out of reach, predicted within " << 1e3 * outcome.plan.predicted_rms_m() << " mm, "
          << outcome.plan.duration_s() << " s, mean off " << 1e3 * mean_off_m(outcome.plan).transpose() << " mm "
          << today.message;
    context_.report(0.55, words.str());
    play(today, outcome);
    return outcome;
  }

  // The largest rms of all markers from where they were in the first of the configurations that ask for the same.
  double return_error_m(bool without_play) {
    std::vector<std::string> names;
    for (const PathDrive& drive : drives_) names.push_back(drive.actuator);
    PlayInverse inverse(drives_);
    if (without_play) come_pulling(names);
    lab_->go(names, rest_);
    inverse.go(Eigen::Map<const Eigen::VectorXd>(rest_.data(), static_cast<Eigen::Index>(rest_.size())));
    std::optional<MarkerPlaces> first_m;
    double most_m = 0.0;
    for (const Configuration& one : robot_.configurations) {
      context_.report(0.9, robot_.name + " comes back: " + one.name);
      const Eigen::Map<const Eigen::VectorXd> wanted(one.commands.data(),
                                                     static_cast<Eigen::Index>(one.commands.size()));
      const Eigen::VectorXd turned = inverse.go(wanted);
      lab_->go(names, without_play ? std::vector<double>(turned.data(), turned.data() + turned.size()) : one.commands);
      if (std::find(robot_.come_back.begin(), robot_.come_back.end(), one.name) == robot_.come_back.end()) continue;
      const MarkerPlaces now_m = lab_->plant().markers_m();
      if (!first_m) first_m = now_m;
      most_m = std::max(most_m, rms_m(now_m, *first_m));
    }
    return most_m;
  }

  int failed_steps() const { return lab_->plant().failed_steps(); }

 private:
  // So that the drives come to rest pulling, as play is inverted from there.
  void come_pulling(const std::vector<std::string>& names) {
    std::vector<double> beyond = rest_;
    for (std::size_t i = 0; i < drives_.size(); ++i)
      beyond[i] = std::min(drives_[i].max, rest_[i] + 2.0 * drives_[i].play);
    lab_->go(names, beyond);
  }

  PathRecord once(const PathOutcome& outcome, const PathPlan& plan, bool feedback, const std::string& way) {
    FollowOptions options = settings_.follow;
    options.feedback = feedback;
    options.lead_s += 0.5 / eyes_.frame_rate_hz;  // a command stands for a frame
    PathRecord record = run_path(*lab_, plan, options, eyes_, rest_);
    aim_at(outcome.plan, record);
    std::ostringstream words;
    words << outcome.robot << ", " << outcome.name << ": " << way << " " << 1e3 * record.rms_m()
          << " mm, within the plane " << 1e3 * record.rms_within_m(normal_of(outcome.plan)) << " mm, late by "
          << 1e3 * record.late_by_s() << " ms " << record.last.reason;
    context_.report(0.6, words.str());
    return record;
  }

  void play(const PathPlan& today, PathOutcome& outcome) {
    if (today.complete) outcome.rest_states = once(outcome, today, false, "rest states");
    outcome.open_loop = once(outcome, outcome.plan, false, "open loop");
    outcome.feedback = once(outcome, outcome.plan, true, "feedback");
    PathPlan learnt = outcome.plan;
    const PathRecord* last = &outcome.feedback;
    for (int round = 0; round < settings_.rounds; ++round) {
      learn(learnt, last->seen, settings_.learn);
      outcome.rounds.push_back(once(outcome, learnt, true, "learnt"));
      last = &outcome.rounds.back();
    }
    std::string file = outcome.robot + "_" + outcome.name + ".yaml";
    std::replace(file.begin(), file.end(), ' ', '_');
    write_file(context_.output_folder + "/" + file, policy_yaml(policy_of(learnt)));
  }

  const RobotPaths& robot_;
  const PathsSettings& settings_;
  const ExperimentContext& context_;
  PathEyes eyes_;
  Scene model_;
  std::vector<PathDrive> drives_;
  std::unique_ptr<EmulatedLab> lab_;
  std::vector<double> rest_;
};

double rms_or_nan(const PathRecord& record) {
  return record.true_m.empty() ? std::numeric_limits<double>::quiet_NaN() : record.rms_m();
}

std::vector<TableCell> row_of(const PathOutcome& outcome) {
  const auto cell_mm = [](const PathRecord& record) {
    return record.true_m.empty() ? TableCell("none") : TableCell(1e3 * record.rms_m());
  };
  return {outcome.robot,
          outcome.name,
          outcome.plan.duration_s(),
          1e3 * outcome.plan.largest_unreachable_m(),
          1e3 * outcome.plan.predicted_rms_m(),
          cell_mm(outcome.rest_states),
          cell_mm(outcome.open_loop),
          cell_mm(outcome.feedback),
          cell_mm(outcome.rounds.back())};
}

nlohmann::ordered_json numbers_of(const PathOutcome& outcome) {
  nlohmann::ordered_json numbers = {{"name", outcome.name},
                                    {"robot", outcome.robot},
                                    {"duration_s", outcome.plan.duration_s()},
                                    {"fastest_s", outcome.plan.fastest_s},
                                    {"unreachable_m", outcome.plan.largest_unreachable_m()},
                                    {"within_tolerance", outcome.reached},
                                    {"predicted_rms_m", outcome.plan.predicted_rms_m()}};
  if (!outcome.rest_states.true_m.empty()) numbers["rest_states_rms_m"] = rms_or_nan(outcome.rest_states);
  numbers["open_loop_rms_m"] = rms_or_nan(outcome.open_loop);
  numbers["feedback_rms_m"] = rms_or_nan(outcome.feedback);
  numbers["learnt_rms_m"] = rms_or_nan(outcome.rounds.back());
  const Eigen::Vector3d normal = normal_of(outcome.plan);
  numbers["within_plane_rms_m"] = {{"open_loop", outcome.open_loop.rms_within_m(normal)},
                                   {"feedback", outcome.feedback.rms_within_m(normal)},
                                   {"learnt", outcome.rounds.back().rms_within_m(normal)}};
  const Eigen::Vector3d off_m = mean_off_m(outcome.plan);
  numbers["nearest_rms_m"] = nearest_rms_m(outcome.plan);
  numbers["model_mean_off_m"] = {off_m.x(), off_m.y(), off_m.z()};
  for (const PathRecord& round : outcome.rounds) numbers["rounds_rms_m"].push_back(rms_or_nan(round));
  return numbers;
}

// The two axes along which the curve is longest.
std::array<int, 2> seen_axes(const std::vector<Eigen::Vector3d>& places_m) {
  Eigen::Vector3d least = places_m.front(), most = places_m.front();
  for (const Eigen::Vector3d& position_m : places_m) {
    least = least.cwiseMin(position_m);
    most = most.cwiseMax(position_m);
  }
  Eigen::Index hidden = 0;
  (most - least).minCoeff(&hidden);
  return hidden == 0 ? std::array<int, 2>{1, 2} : hidden == 1 ? std::array<int, 2>{0, 2} : std::array<int, 2>{0, 1};
}

Series series_of(const std::string& label, const std::vector<Eigen::Vector3d>& places_m, std::array<int, 2> axes,
                 SeriesStyle style) {
  Series series{label, {}, {}, style};
  for (const Eigen::Vector3d& position_m : places_m) {
    series.x.push_back(1e3 * position_m[axes[0]]);
    series.y.push_back(1e3 * position_m[axes[1]]);
  }
  return series;
}

Plot plot_of(const PathOutcome& outcome, std::size_t number) {
  std::vector<Eigen::Vector3d> asked_m, predicted_m;
  for (const PathSample& sample : outcome.plan.samples) {
    asked_m.push_back(sample.target_m);
    predicted_m.push_back(sample.predicted_m);
  }
  const std::array<int, 2> axes = seen_axes(asked_m);
  const std::array<std::string, 3> names = {"x [mm]", "y [mm]", "z [mm]"};
  Plot plot{"path_" + std::to_string(number),
            outcome.robot + ", " + outcome.name,
            {names[static_cast<std::size_t>(axes[0])]},
            {names[static_cast<std::size_t>(axes[1])]}};
  plot.equal_scale = true;
  plot.series.push_back(series_of("asked", asked_m, axes, SeriesStyle::lines));
  plot.series.push_back(series_of("predicted", predicted_m, axes, SeriesStyle::dashes));
  if (!outcome.rest_states.true_m.empty())
    plot.series.push_back(series_of("rest states", outcome.rest_states.true_m, axes, SeriesStyle::lines));
  plot.series.push_back(series_of("open loop", outcome.open_loop.true_m, axes, SeriesStyle::lines));
  plot.series.push_back(series_of("feedback", outcome.feedback.true_m, axes, SeriesStyle::lines));
  plot.series.push_back(series_of("learnt", outcome.rounds.back().true_m, axes, SeriesStyle::lines));
  return plot;
}

Plot error_plot_of(const PathOutcome& outcome, std::size_t number) {
  Plot plot{"error_" + std::to_string(number),
            outcome.robot + ", " + outcome.name,
            {"time [s]"},
            {"distance of the tip from where it should be [mm]"}};
  const auto show = [&](const std::string& label, const PathRecord& record) {
    Series series{label, record.time_s, {}, SeriesStyle::lines};
    for (std::size_t i = 0; i < record.time_s.size(); ++i)
      series.y.push_back(1e3 * (record.true_m[i] - record.target_m[i]).norm());
    plot.series.push_back(series);
  };
  if (!outcome.rest_states.true_m.empty()) show("rest states", outcome.rest_states);
  show("open loop", outcome.open_loop);
  show("feedback", outcome.feedback);
  show("learnt", outcome.rounds.back());
  return plot;
}

void add(const PathOutcome& outcome, ExperimentResult& result) {
  const std::size_t number = result.table.rows.size() + 1;
  result.table.rows.push_back(row_of(outcome));
  result.numbers["paths"].push_back(numbers_of(outcome));
  result.plots.push_back(plot_of(outcome, number));
  result.plots.push_back(error_plot_of(outcome, number));
  for (const PathRecord* record :
       {&outcome.rest_states, &outcome.open_loop, &outcome.feedback, &outcome.rounds.back()}) {
    if (record->last.reason.empty()) continue;
    result.converged = false;
    result.message = outcome.name + ": " + record->last.reason;
  }
}

}  // namespace

ExperimentResult run_paths_experiment(const ExperimentContext& context) {
  const PathsSettings settings = read_paths_settings(context);
  ExperimentResult result;
  result.title = "Tips that draw curves on the emulated rig";
  result.table = {{{"robot"},
                   {"path"},
                   {"time [s]", 3},
                   {"out of reach [mm]", 2},
                   {"model's error [mm]", 2},
                   {"rest states [mm]", 3},
                   {"open loop [mm]", 3},
                   {"feedback [mm]", 3},
                   {"learnt [mm]", 3}},
                  {}};
  for (const RobotPaths& robot : settings.robots) {
    RobotRun runs(robot, settings, context);
    for (const NamedPath& path : robot.paths) {
      add(runs.run(path, path.task.duration_s), result);
      if (path.fastest) add(runs.run(path, 0.0), result);
    }
    if (!robot.configurations.empty()) {
      result.numbers["return_error_today_m"] = runs.return_error_m(false);
      result.numbers["return_error_m"] = runs.return_error_m(true);
    }
    if (runs.failed_steps() == 0) continue;
    result.converged = false;
    result.message = robot.name + ": steps of plant failed";
  }
  result.we_differ = "The robot on the emulated rig is our own model with other numbers and another mesh.";
  std::ostringstream words;
  words.precision(3);
  for (const auto& path : result.numbers["paths"]) {
    words << path["robot"].get<std::string>() << ", " << path["name"].get<std::string>() << ": open loop "
          << 1e3 * path["open_loop_rms_m"].get<double>() << " mm, feedback "
          << 1e3 * path["feedback_rms_m"].get<double>() << " mm, learnt " << 1e3 * path["learnt_rms_m"].get<double>()
          << " mm. ";
  }
  if (result.numbers.contains("return_error_m"))
    words << "Configurations that ask for the same come back within "
          << 1e3 * result.numbers["return_error_today_m"].get<double>() << " mm, with the drives' play inverted within "
          << 1e3 * result.numbers["return_error_m"].get<double>() << " mm.";
  result.we_find = words.str();
  return result;
}

}  // namespace soft_robot_lab
