// Spinebot and the ball: a policy found on the model, replayed on the emulated rig, then corrected in closed loop.
#include "rig/ball_experiment.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "rig/lab_settings.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/scene/scene.h"

namespace soft_robot_lab {
namespace {

struct BallSettings {
  LabFiles files;
  std::string marker;
  Eigen::Vector3d target_m;
  OptimiserOptions optimiser;
  std::vector<Eigen::VectorXd> starts;  // contractions that the search for reality's nearest begins from
};

BallSettings read_settings(const ExperimentContext& context) {
  const SettingsNode node = SettingsNode::load_file(context.settings_file("7.3.3"));
  const SettingsNode task = SettingsNode::load_file(context.config_folder + "/" + node.text("task"));
  BallSettings settings{read_lab_files(node, context), task.text("marker"), task.vector3("target_m"), {}, {}};
  settings.optimiser.method = task.choice("method", optimiser_methods());
  for (const SettingsNode& start : node.sequence("starts")) settings.starts.push_back(start.as_numbers());
  node.require_all_read();
  return settings;
}

// Within the limits of the rig's motors.
PolicyTask task_of(const BallSettings& settings) {
  PolicyTask task;
  task.poses = {{{{settings.marker, settings.target_m, 1.0}}}};
  for (const MotorSettings& motor : settings.files.lab.rig.motors)
    task.bounds.push_back({motor.name, motor.min_value, motor.max_value});
  return task;
}

PolicyAnswer search(Simulation& simulation, const BallSettings& settings) {
  const PolicyAnswer answer = find_policy(simulation, task_of(settings), settings.optimiser);
  if (!answer.success)
    throw std::runtime_error("no policy: " + (answer.summaries.empty() ? "" : answer.summaries.back().stop_reason));
  return answer;
}

// With reality's own robot, which no lab can do: the least distance that any contractions give.
double nearest_reachable_m(const BallSettings& settings, const SceneOptions& options) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Eigen::VectorXd& start : settings.starts) {
    const Scene scene = load_scene(settings.files.lab.reality.robot, options);
    Simulation& real = *scene.simulation;
    real.solve_equilibrium();
    for (Eigen::Index i = 0; i < start.size(); ++i)
      real.set_command(settings.files.lab.rig.motors.at(static_cast<std::size_t>(i)).name, start[i]);
    real.solve_equilibrium();
    nearest_m = std::min(nearest_m, search(real, settings).summaries.back().final_distance_m);
  }
  return nearest_m;
}

struct Attempt {
  std::vector<double> true_m, measured_m;  // distances at rest: hanging, after the replay, after each correction
  std::vector<double> contractions;        // at the end
  std::string end;
};

class Attempts {
 public:
  Attempts(const BallSettings& settings, const ExperimentContext& context)
      : settings_(settings),
        context_(context),
        model_(std::move(load_scene(settings.files.robot, context.scene_options()).simulation)) {
    model_->solve_equilibrium();
    const PolicyAnswer answer = search(*model_, settings);
    names_ = answer.policy.names;
    policy_ = answer.policy.steps.back().values;
    expected_m_ = answer.summaries.back().final_distance_m;
  }

  Attempt run(bool calibrated) {
    EmulatedLab lab(settings_.files.lab, context_.scene_options());
    if (calibrated) lab.calibrate(settings_.files.balls);
    Attempt attempt;
    place_model(std::vector<double>(names_.size(), 1.0));
    look(lab, attempt);
    lab.go(names_, policy_);
    place_model(policy_);
    ClosedLoop loop(*model_, task_of(settings_), ClosedLoopOptions());
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

  double expected_m() const { return expected_m_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<double>& policy() const { return policy_; }

 private:
  void place_model(const std::vector<double>& contractions) {
    for (std::size_t i = 0; i < names_.size(); ++i) model_->set_command(names_[i], contractions[i]);
    const SolveReport report = model_->solve_equilibrium();
    if (!report.converged) throw std::runtime_error("the model finds no rest: " + report.message);
  }

  double distance_m(const MarkerPlaces& places) const {
    const auto place = places.find(settings_.marker);
    return place == places.end() ? std::nan("") : (place->second - settings_.target_m).norm();
  }

  MeasuredMarkers look(EmulatedLab& lab, Attempt& attempt) const {
    const MeasuredMarkers measured = lab.measure(marker_places(*model_));
    attempt.true_m.push_back(distance_m(lab.reality().markers_m()));
    attempt.measured_m.push_back(distance_m(measured));
    context_.tell(0.5, std::to_string(attempt.true_m.size()) + " times at rest");
    return measured;
  }

  const BallSettings& settings_;
  const ExperimentContext& context_;
  std::unique_ptr<Simulation> model_;
  std::vector<std::string> names_;
  std::vector<double> policy_;
  double expected_m_ = 0.0;
};

Series line(const std::string& label, const std::vector<double>& distances_m, SeriesStyle style) {
  Series series{label, {}, {}, style};
  for (std::size_t i = 0; i < distances_m.size(); ++i) {
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

void add_rows(const Attempt& attempt, const std::string& cameras, double nearest_m, Table& table) {
  const auto cell = [](double value_m) { return std::isfinite(value_m) ? TableCell(1e3 * value_m) : TableCell(""); };
  const auto row = [&](const std::string& what, std::size_t at) {
    const double true_m = attempt.true_m.at(at);
    table.rows.push_back({cameras, what, cell(true_m), cell(attempt.measured_m.at(at)), 1e3 * (true_m - nearest_m)});
  };
  row("hanging", 0);
  row("replay", 1);
  row("closed loop, " + std::to_string(attempt.true_m.size() - 2) + " corrections", attempt.true_m.size() - 1);
}

}  // namespace

ExperimentResult run_ball_experiment(const ExperimentContext& context) {
  const BallSettings settings = read_settings(context);
  context.tell(0, "nearest that reality can reach");
  const double nearest_m = nearest_reachable_m(settings, context.scene_options());
  context.tell(0.2, "policy on the model");
  Attempts attempts(settings, context);
  const Attempt as_believed = attempts.run(false), calibrated = attempts.run(true);

  ExperimentResult result;
  result.title = "Spinebot and the ball: a policy of the model, replayed on the emulated rig, and closed loop";
  result.table.columns = {{"cameras"}, {"robot"}, {"distance [mm]"}, {"measured [mm]"}, {"beyond nearest [mm]", 3}};
  add_rows(as_believed, "2 mm off", nearest_m, result.table);
  add_rows(calibrated, "calibrated", nearest_m, result.table);
  result.numbers = {{"distance_before_m", as_believed.true_m.front()},
                    {"nearest_reachable_m", nearest_m},
                    {"replay_m", as_believed.true_m.at(1)},
                    {"closed_loop_m", as_believed.true_m.back()},
                    {"model_expects_m", attempts.expected_m()},
                    {"policy", attempts.policy()},
                    {"cameras_off", numbers_of(as_believed)},
                    {"cameras_calibrated", numbers_of(calibrated)}};
  Plot plot{"7.3.3", "Distance of the tip from the ball; 0 is the replay, then corrections", {}, {}};
  plot.x.label = "corrections";
  plot.y.label = "distance [mm]";
  plot.x.min = -0.5;
  plot.y.guides = {1e3 * nearest_m};
  plot.series = {line("true, cameras 2 mm off", as_believed.true_m, SeriesStyle::lines_points),
                 line("measured, cameras 2 mm off", as_believed.measured_m, SeriesStyle::dashes_points),
                 line("true, cameras calibrated", calibrated.true_m, SeriesStyle::lines_points),
                 line("measured, cameras calibrated", calibrated.measured_m, SeriesStyle::dashes_points)};
  result.plots = {plot};
  result.source_reports = "the tip's distance to the ball went from 38.15 mm to 13.95 mm.";
  std::ostringstream text;
  text.precision(4);
  text << "From " << 1e3 * as_believed.true_m.front() << " mm, the model's policy (it expects "
       << 1e3 * attempts.expected_m() << " mm) brings the emulated robot to " << 1e3 * as_believed.true_m.at(1)
       << " mm, closed loop to " << 1e3 * as_believed.true_m.back() << " mm with cameras 2 mm off, to "
       << 1e3 * calibrated.true_m.back() << " mm with calibrated ones. The nearest that this robot can reach at all is "
       << 1e3 * nearest_m
       << " mm. Distances are true ones, of reality's own marker; the controller knows measured ones.";
  result.we_find = text.str();
  result.converged = as_believed.end == "settled" && calibrated.end == "settled";
  if (!result.converged) result.message = "closed loop ended: " + as_believed.end + "; calibrated: " + calibrated.end;
  return result;
}

}  // namespace soft_robot_lab
