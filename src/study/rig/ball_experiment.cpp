// SPDX-License-Identifier: BSD-3-Clause
// Spinebot and a ball: a policy found on the model, replayed on the emulated rig, then corrected in closed loop. 7.3.3
// has the source's ball and its method, `ball` the demonstration's, with a place within reach beside it.
#include "ball_experiment.h"

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "study/experiments/policy_run.h"
#include "lab_settings.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/control/forward_model.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kEnough_m = 1.0e-4;

struct BallSettings {
  LabFiles files;
  std::string marker;
  Eigen::Vector3d ball_m;
  std::optional<Eigen::Vector3d> within_reach_m;  // another target
  std::vector<OptimiserOptions> methods;          // the first one's policy is played
  std::vector<Eigen::VectorXd> starts;            // contractions that the search for plant's nearest begins from
};

BallSettings read_ball_settings(const ExperimentContext& context, const std::string& name) {
  const YamlNode node = YamlNode::load_file(context.settings_file(name));
  const YamlNode task = node.has("task") ? YamlNode::load_file(context.config_folder + "/" + node.text("task")) : node;
  BallSettings settings{read_lab_files(node, context), task.text("marker"), task.vector3("target_m"), {}, {}, {}};
  if (node.has("within_reach_m")) settings.within_reach_m = node.vector3("within_reach_m");
  settings.methods = read_methods(node);
  for (const YamlNode& start : node.sequence("starts")) settings.starts.push_back(start.as_numbers());
  node.require_all_read();
  return settings;
}

// Within the limits of the rig's motors.
PolicyTask task_of(const BallSettings& settings, const Eigen::Vector3d& target_m) {
  PolicyTask task;
  task.poses = {{{{settings.marker, target_m, 1.0}}}};
  for (const MotorSettings& motor : settings.files.lab.rig.motors)
    task.bounds.push_back({motor.name, motor.min_value, motor.max_value});
  return task;
}

PolicyAnswer search(Simulation& simulation, const BallSettings& settings, const Eigen::Vector3d& target_m,
                    const OptimiserOptions& options) {
  const PolicyAnswer answer = find_policy(simulation, task_of(settings, target_m), options);
  if (!answer.success)
    throw std::runtime_error("no policy: " + (answer.summaries.empty() ? "" : answer.summaries.back().stop_reason));
  return answer;
}

// With plant's own robot, which no lab can do: the least distance to which contractions bring it from hanging, whence
// all are played, as with friction the way there decides where it rests.
class RealReach {
 public:
  RealReach(const BallSettings& settings, const SceneOptions& options)
      : settings_(settings), real_(load_scene(settings.files.lab.plant.robot, options).simulation) {
    real_->solve_equilibrium();
    hanging_ = real_->state();
  }

  double nearest_m(const Eigen::Vector3d& target_m) {
    ReachProblem problem;
    problem.goals = {{target_m, 1.0}};
    const std::vector<MotorSettings>& motors = settings_.files.lab.rig.motors;
    problem.min.resize(static_cast<Eigen::Index>(motors.size()));
    problem.max = problem.min;
    for (std::size_t i = 0; i < motors.size(); ++i) {
      problem.names.push_back(motors[i].name);
      problem.min[static_cast<Eigen::Index>(i)] = motors[i].min_value;
      problem.max[static_cast<Eigen::Index>(i)] = motors[i].max_value;
    }
    problem.model = [&](const Eigen::VectorXd& contractions, bool with_derivatives) {
      real_->set_state(hanging_);
      return ForwardModel(*real_, {settings_.marker}, problem.names).predict(contractions, with_derivatives);
    };
    OptimiserOptions options;
    options.tolerance_m = kEnough_m;  // each place is played from hanging, which takes its time
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Eigen::VectorXd& start : settings_.starts) {
      problem.start = start;
      const OptimisationSummary found = optimise(problem, options);
      if (found.usable) nearest_m = std::min(nearest_m, found.final_distance_m);
    }
    if (!std::isfinite(nearest_m)) throw std::runtime_error("no search for plant's nearest succeeded");
    return nearest_m;
  }

 private:
  const BallSettings& settings_;
  std::unique_ptr<Simulation> real_;
  SimulationState hanging_;
};

struct Attempt {
  std::vector<double> true_m, measured_m;  // distances at rest: hanging, after the replay, after each correction
  std::vector<double> contractions;        // at the end
  std::string end;
};

// What a method found on the model.
struct ModelSearch {
  std::string method;
  OptimisationSummary summary;
};

class Attempts {
 public:
  Attempts(const BallSettings& settings, const Eigen::Vector3d& target_m, const ExperimentContext& context)
      : settings_(settings),
        target_m_(target_m),
        context_(context),
        model_(std::move(load_scene(settings.files.robot, context.scene_options()).simulation)) {
    model_->solve_equilibrium();
    const SimulationState hanging = model_->state();
    for (const OptimiserOptions& options : settings.methods) {
      model_->set_state(hanging);
      const PolicyAnswer answer = search(*model_, settings, target_m, options);
      searches_.push_back({options.method, answer.summaries.back()});
      if (searches_.size() > 1) continue;
      names_ = answer.policy.names;
      policy_ = answer.policy.steps.back().values;
    }
  }

  Attempt run(bool calibrated) {
    EmulatedLab lab(settings_.files.lab, context_.scene_options());
    if (calibrated) lab.calibrate(settings_.files.balls);
    Attempt attempt;
    place_model(std::vector<double>(names_.size(), 1.0));
    look(lab, attempt);
    lab.go(names_, policy_);
    place_model(policy_);
    ClosedLoop loop(*model_, task_of(settings_, target_m_), ClosedLoopOptions());
    attempt.contractions = policy_;
    while (true) {
      const MeasuredMarkers measured = look(lab, attempt);
      const LoopStep step = loop.correct(lab.time_s(), measured, "");
      if (step.end != LoopEnd::none) {
        attempt.end = step.reason;
        return attempt;
      }
      attempt.contractions.assign(step.commands.begin(), step.commands.end());
      lab.go(loop.actuators(), attempt.contractions);
      place_model(attempt.contractions);
    }
  }

  const std::vector<ModelSearch>& searches() const { return searches_; }

 private:
  void place_model(const std::vector<double>& contractions) {
    for (std::size_t i = 0; i < names_.size(); ++i) model_->set_command(names_[i], contractions[i]);
    const SolveReport report = model_->solve_equilibrium();
    if (!report.converged) throw std::runtime_error("the model finds no rest: " + report.message);
  }

  double distance_m(const MarkerPlaces& places) const {
    const auto place = places.find(settings_.marker);
    return place == places.end() ? std::nan("") : (place->second - target_m_).norm();
  }

  MeasuredMarkers look(EmulatedLab& lab, Attempt& attempt) const {
    const MeasuredMarkers measured = lab.measure(marker_places(*model_));
    attempt.true_m.push_back(distance_m(lab.plant().markers_m()));
    attempt.measured_m.push_back(distance_m(measured));
    context_.report(0.5, std::to_string(attempt.true_m.size()) + " times at rest");
    return measured;
  }

  const BallSettings& settings_;
  Eigen::Vector3d target_m_;
  const ExperimentContext& context_;
  std::unique_ptr<Simulation> model_;
  std::vector<std::string> names_;
  std::vector<double> policy_;
  std::vector<ModelSearch> searches_;
};

Series line(const std::string& label, const std::vector<double>& distances_m, SeriesStyle style) {
  Series series{label, {}, {}, style};
  for (std::size_t i = 1; i < distances_m.size(); ++i) {
    if (!std::isfinite(distances_m[i])) continue;
    series.x.push_back(static_cast<double>(i) - 1.0);
    series.y.push_back(1e3 * distances_m[i]);
  }
  return series;
}

nlohmann::ordered_json numbers_of(const Attempt& attempt) {
  // A marker that was not seen has no measured distance: null.
  return {{"replay_m", attempt.true_m.at(1)},
          {"closed_loop_m", attempt.true_m.back()},
          {"measured_replay_m", attempt.measured_m.at(1)},
          {"measured_closed_loop_m", attempt.measured_m.back()},
          {"corrections", attempt.true_m.size() - 2},
          {"contractions", attempt.contractions},
          {"end", attempt.end}};
}

// What became of one target.
struct Reached {
  std::string what;
  double nearest_m = 0.0;             // of plant
  std::vector<ModelSearch> searches;  // the first one's policy was played
  Attempt as_believed, calibrated;    // cameras

  double expected_m() const { return searches.front().summary.final_distance_m; }
};

Reached reach(const BallSettings& settings, const std::string& what, const Eigen::Vector3d& target_m,
              const ExperimentContext& context) {
  context.report(0.0, what + ": nearest that plant can reach");
  Reached reached{what, RealReach(settings, context.scene_options()).nearest_m(target_m), {}, {}, {}};
  context.report(0.2, what + ": policy on the model");
  Attempts attempts(settings, target_m, context);
  reached.searches = attempts.searches();
  reached.as_believed = attempts.run(false);
  reached.calibrated = attempts.run(true);
  return reached;
}

void add_rows(const Reached& reached, const Attempt& attempt, const std::string& cameras, Table& table) {
  const auto cell = [](double value_m) { return std::isfinite(value_m) ? TableCell(1e3 * value_m) : TableCell(""); };
  const auto row = [&](const std::string& when, std::size_t at) {
    const double true_m = attempt.true_m.at(at);
    table.rows.push_back({reached.what, cameras, when, cell(true_m), cell(attempt.measured_m.at(at)),
                          1e3 * (true_m - reached.nearest_m)});
  };
  row("hanging", 0);
  row("replay", 1);
  row("closed loop, " + std::to_string(attempt.true_m.size() - 2) + " corrections", attempt.true_m.size() - 1);
}

void add_model_rows(const Reached& reached, Table& table) {
  const OptimisationSummary& first = reached.searches.front().summary;
  table.rows.push_back({reached.what, "none: the model", "hanging", 1e3 * first.initial_distance_m, "", ""});
  for (const ModelSearch& search : reached.searches) {
    const std::string after = search.method + ", " + std::to_string(search.summary.iterations) + " iterations, " +
                              std::to_string(search.summary.evaluations) + " equilibria";
    table.rows.push_back({reached.what, "none: the model", after, 1e3 * search.summary.final_distance_m, "", ""});
  }
}

nlohmann::ordered_json numbers_of(const ModelSearch& search) {
  const OptimisationSummary& summary = search.summary;
  return {{"final_distance_m", summary.final_distance_m},
          {"iterations", summary.iterations},
          {"evaluations", summary.evaluations},
          {"cpu_s", summary.cpu_s},
          {"commands", std::vector<double>(summary.commands.begin(), summary.commands.end())},
          {"stop_reason", summary.stop_reason}};
}

nlohmann::ordered_json numbers_of(const Reached& reached) {
  nlohmann::ordered_json methods;
  for (const ModelSearch& search : reached.searches) methods[search.method] = numbers_of(search);
  return {{"start_distance_m", reached.searches.front().summary.initial_distance_m},
          {"final_distance_m", reached.expected_m()},
          {"methods", methods},
          {"distance_before_m", reached.as_believed.true_m.front()},
          {"nearest_reachable_m", reached.nearest_m},
          {"replay_m", reached.as_believed.true_m.at(1)},
          {"closed_loop_m", reached.as_believed.true_m.back()},
          {"model_expects_m", reached.expected_m()},
          {"cameras_off", numbers_of(reached.as_believed)},
          {"cameras_calibrated", numbers_of(reached.calibrated)}};
}

Plot draw(const Reached& reached, const std::string& name) {
  Plot plot{name, "Distance of the tip from " + reached.what + ": 0 is the replay, then corrections", {}, {}};
  plot.x.label = "corrections";
  plot.y.label = "distance [mm]";
  plot.y.min = 0;
  plot.y.guides = {1e3 * reached.nearest_m};
  plot.series = {line("true, cameras 2 mm off", reached.as_believed.true_m, SeriesStyle::lines_points),
                 line("measured, cameras 2 mm off", reached.as_believed.measured_m, SeriesStyle::dashes_points),
                 line("true, cameras calibrated", reached.calibrated.true_m, SeriesStyle::lines_points),
                 line("measured, cameras calibrated", reached.calibrated.measured_m, SeriesStyle::dashes_points)};
  return plot;
}

std::string words(const Reached& reached) {
  std::ostringstream text;
  text.precision(3);
  text << "Of " << reached.what << " the tip is " << 1e3 * reached.as_believed.true_m.front()
       << " mm away, after the model's policy " << 1e3 * reached.as_believed.true_m.at(1) << " mm (the model expects "
       << 1e3 * reached.expected_m() << "), after closed loop " << 1e3 * reached.as_believed.true_m.back()
       << " mm with cameras 2 mm off and " << 1e3 * reached.calibrated.true_m.back()
       << " mm with calibrated ones; this robot can come within " << 1e3 * reached.nearest_m << " mm. ";
  return text.str();
}

ExperimentResult run(const ExperimentContext& context, const std::string& name) {
  const BallSettings settings = read_ball_settings(context, name);
  std::vector<Reached> all = {reach(settings, "the ball", settings.ball_m, context)};
  if (settings.within_reach_m)
    all.push_back(reach(settings, "a place within reach", *settings.within_reach_m, context));
  ExperimentResult result;
  result.table.columns = {{"target"},        {"cameras"},       {"robot"},
                          {"distance [mm]"}, {"measured [mm]"}, {"beyond nearest [mm]", 3}};
  result.numbers = numbers_of(all.front());
  for (const Reached& reached : all) {
    const bool first = &reached == &all.front();
    add_model_rows(reached, result.table);
    add_rows(reached, reached.as_believed, "2 mm off", result.table);
    add_rows(reached, reached.calibrated, "calibrated", result.table);
    for (const Attempt* attempt : {&reached.as_believed, &reached.calibrated}) {
      if (attempt->end == "settled") continue;
      result.converged = false;
      result.message = reached.what + ": closed loop ended with '" + attempt->end + "'";
    }
    if (!first) result.numbers["within_reach"] = numbers_of(reached);
    result.plots.push_back(draw(reached, first ? name : name + "_within_reach"));
    result.we_find += words(reached);
  }
  result.we_find += "Distances are true ones, of plant's own marker; the controller knows measured ones.";
  return result;
}

std::string model_words(const nlohmann::ordered_json& numbers) {
  std::ostringstream text;
  text.precision(4);
  text << "On the model the distance goes from " << 1e3 * numbers["start_distance_m"].get<double>() << " mm to ";
  for (const auto& [method, found] : numbers["methods"].items())
    text << 1e3 * found["final_distance_m"].get<double>() << " mm by " << method << " (" << found["evaluations"]
         << " equilibria, " << found["cpu_s"].get<double>() << " s CPU, " << found["stop_reason"].get<std::string>()
         << "), ";
  return text.str() + "where the source ends at 13.95 mm. ";
}

}  // namespace

ExperimentResult run_source_ball_experiment(const ExperimentContext& context) {
  ExperimentResult result = run(context, "7.3.3");
  result.title =
      "Spinebot and the ball of the source: a policy of the model, replayed on the emulated rig, closed loop";
  result.source_reports =
      "The ball is 60 mm from Spinebot's centre. On the model, descent stopped at derivatives below 1e-6 or at 1000 "
      "iterations takes the tip's distance from 38.15 mm to 13.95 mm; nearer it does not come, as the robot intersects "
      "itself "
      "near the tip. Played on the robot, it points at the ball, with some discrepancies; no distance was measured "
      "there.";
  result.we_differ =
      "The ball's place follows from the two printed distances and our Spinebot, whose dimensions but the cables' "
      "length are "
      "chosen; our model does not notice intersecting itself either; and the robot it is played on is our own model "
      "with "
      "other numbers, on an emulated rig.";
  result.we_find = model_words(result.numbers) + result.we_find;
  return result;
}

ExperimentResult run_ball_experiment(const ExperimentContext& context) {
  ExperimentResult result = run(context, "ball");
  result.title =
      "Spinebot and the demonstration's ball: a policy of the model, replayed on the emulated rig, closed loop";
  return result;
}

}  // namespace soft_robot_lab
