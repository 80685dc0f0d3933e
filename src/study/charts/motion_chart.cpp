// SPDX-License-Identifier: BSD-3-Clause
#include "motion_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <utility>

#include "mechanics/reduced/reduced_simulation.h"
#include "mechanics/reduced/snapshots.h"
#include "mechanics/reduced/training_set.h"
#include "speed_measurement.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr unsigned kSeed = 7;

using Frames = std::vector<Eigen::Matrix3Xd>;  // where the nodes are, frame by frame

struct Way {
  Frames frames_m;
  double cost = 0.0;
  int unsolved = 0;
};

Eigen::Matrix3Xd places_m(const Simulation& simulation) { return simulation.state().positions_m; }
Eigen::Matrix3Xd places_m(const ReducedSimulation& simulation) { return simulation.positions_m(); }

struct Apart {
  double rms_m = 0.0, largest_m = 0.0;

  Apart(const Frames& a, const Frames& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Eigen::VectorXd apart_m = (a[i] - b[i]).colwise().norm();
      sum += apart_m.squaredNorm() / static_cast<double>(apart_m.size());
      largest_m = std::max(largest_m, apart_m.maxCoeff());
    }
    rms_m = std::sqrt(sum / static_cast<double>(a.size()));
  }
};

std::vector<int> counts(const YamlNode& node, const std::string& key, std::vector<int> otherwise) {
  if (!node.has(key)) return otherwise;
  std::vector<int> values;
  for (const YamlNode& item : node.sequence(key)) values.push_back(static_cast<int>(item.as_number({1.0, 1.0e4})));
  if (values.empty()) node.fail(key + " is empty");
  return values;
}

MotionRung read_motion_rung(const YamlNode& node) {
  MotionRung rung;
  rung.name = node.text("name");
  if (const auto overrides = node.optional_child("overrides")) rung.overrides = Overrides(*overrides);
  rung.modes = node.integer_or("modes", 0, 1, 40);
  rung.steps = counts(node, "steps", rung.steps);
  rung.substeps = counts(node, "substeps", {});
  rung.quick = node.boolean_or("quick", true);
  return rung;
}

// Runs rungs. Ways of the full model, which reduced ones are held against, and training sets are kept.
class MotionBench {
 public:
  MotionBench(const ExperimentContext& context, const MotionProblem& problem)
      : context_(context), problem_(problem), reference_(full_way(problem.reference, problem.reference.steps[0], 0)) {}

  MotionRun run(const MotionRung& rung, int steps, int substeps) {
    MotionRun run{rung.name, steps, substeps, rung.modes};
    const Way way = rung.modes > 0 ? reduced_way(rung, steps, run) : full_way(rung, steps, substeps);
    const Apart apart(way.frames_m, reference_.frames_m);
    run.nodes = static_cast<int>(reference_.frames_m[0].cols());
    run.unsolved = way.unsolved;
    run.cost = way.cost;
    run.rms_m = apart.rms_m;
    run.largest_m = apart.largest_m;
    return run;
  }

 private:
  struct Trained {
    TrainingSet set;
    double cpu_s = 0.0;
  };

  CommandBox box(const Model& model) const {
    CommandBox box;
    box.min.assign(model.actuators().size(), problem_.min_command);
    box.max.assign(model.actuators().size(), problem_.max_command);
    return box;
  }

  Scene load(Overrides overrides, int steps, int substeps) const {
    overrides.set({"solver", "time_step_s"}, problem_.frame_s / steps);
    if (substeps > 0) overrides.set({"solver", "substeps"}, substeps);
    return load_scene(problem_.scene, context_.scene_options(overrides));
  }

  // New random commands again and again, from where it is.
  template <class AnySimulation>
  Way move(AnySimulation& simulation, const CommandBox& box, int steps) const {
    const std::vector<std::vector<double>> targets = transient_commands(box, problem_.duration_s, kSeed);
    const int frames = static_cast<int>(std::lround(problem_.duration_s / problem_.frame_s));
    Way way;
    const double start_s = cpu_time_s();
    for (int i = 0; i < frames; ++i) {
      const auto hold = static_cast<std::size_t>(i * problem_.frame_s / kTransientHold_s);
      command(targets[std::min(hold, targets.size() - 1)], simulation);
      for (int k = 0; k < steps; ++k) way.unsolved += simulation.step().converged ? 0 : 1;
      way.frames_m.push_back(places_m(simulation));
    }
    way.cost = (cpu_time_s() - start_s) / problem_.duration_s;
    return way;
  }

  // Short ones again, as other work on the machine only adds.
  template <class Move>
  Way cheapest(const Move& again) const {
    Way best;
    best.cost = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kRepeats; ++i) {
      Way way = again();
      if (way.cost < best.cost) best = std::move(way);
      if (best.cost * problem_.duration_s > kLong_s) break;
    }
    return best;
  }

  // All start where the body hangs at rest.
  const SimulationState& start() {
    if (start_.positions_m.size() > 0) return start_;
    const Scene scene = load({}, 1, 0);
    scene.simulation->solve_equilibrium();
    start_ = scene.simulation->state();
    start_.linearisation.reset();
    return start_;
  }

  const Way& full_way(const MotionRung& rung, int steps, int substeps) {
    std::ostringstream key;
    key << rung.overrides.text() << steps << ", " << substeps;
    const auto known = full_.find(key.str());
    if (known != full_.end()) return known->second;
    const Scene scene = load(rung.overrides, steps, substeps);
    const CommandBox commands = box(*scene.simulation->model());
    return full_[key.str()] = cheapest([&] {
             scene.simulation->set_state(start());
             return move(*scene.simulation, commands, steps);
           });
  }

  const Trained& trained(const std::shared_ptr<const Model>& model, const ReducedTraining& training, int steps) {
    const auto known = sets_.find(steps);
    if (known != sets_.end()) return known->second;
    const double start_s = cpu_time_s();
    Trained trained{collect_training(model, training, {}), 0.0};
    trained.cpu_s = cpu_time_s() - start_s;
    return sets_[steps] = std::move(trained);
  }

  Way reduced_way(const MotionRung& rung, int steps, MotionRun& run) {
    const Scene scene = load(rung.overrides, steps, 0);
    const std::shared_ptr<const Model> model = scene.simulation->model();
    ReducedTraining training;
    training.box = box(*model);
    training.modes = rung.modes;
    training.ramps = problem_.ramps;
    training.transient_s = problem_.transient_s;
    const Trained& states = trained(model, training, steps);
    const double start_s = cpu_time_s();
    ReducedSimulation simulation(train_on(states.set, model, training));
    run.training_s = states.cpu_s + cpu_time_s() - start_s;
    Way way = cheapest([&] {
      simulation.reset();
      simulation.solve_equilibrium();
      return move(simulation, training.box, steps);
    });
    run.beside_m = Apart(way.frames_m, full_way(rung, steps, 0).frames_m).rms_m;
    return way;
  }

  const ExperimentContext& context_;
  const MotionProblem& problem_;
  SimulationState start_;
  std::map<std::string, Way> full_;
  std::map<int, Trained> sets_;
  Way reference_;
};

std::string label_of(const MotionRun& run) {
  if (run.modes == 0) return run.rung;
  std::ostringstream text;
  text.precision(2);
  text << run.rung << ", trained in " << run.training_s << " CPU-s";
  return text.str();
}

}  // namespace

MotionProblem read_motion(const ExperimentContext& context, const YamlNode& node, double frame_s) {
  MotionProblem problem;
  problem.title = node.text("title");
  problem.scene = context.config_folder + "/" + node.text("scene");
  problem.frame_s = frame_s;
  problem.duration_s = node.number("duration_s", AllowedRange::positive());
  problem.min_command = node.number("min_command", AllowedRange::not_negative());
  problem.max_command = node.number("max_command", {problem.min_command});
  problem.reference = read_motion_rung(node.child("reference"));
  for (const YamlNode& item : node.sequence("ladder")) problem.rungs.push_back(read_motion_rung(item));
  return problem;
}

MotionProblem quick_part(MotionProblem problem) {
  const auto shorten = [](std::vector<int>& values) { values.resize(std::min<std::size_t>(values.size(), 1)); };
  problem.duration_s = 6 * problem.frame_s;
  problem.reference.steps = {2};
  problem.ramps = 2;
  problem.transient_s = 0.2;
  const auto slow = [](const MotionRung& rung) { return !rung.quick; };
  problem.rungs.erase(std::remove_if(problem.rungs.begin(), problem.rungs.end(), slow), problem.rungs.end());
  for (MotionRung& rung : problem.rungs) {
    shorten(rung.steps);
    shorten(rung.substeps);
  }
  return problem;
}

std::vector<MotionRun> run_motion(const ExperimentContext& context, const MotionProblem& problem) {
  MotionBench bench(context, problem);
  std::vector<MotionRun> runs;
  for (const MotionRung& rung : problem.rungs) {
    for (const int steps : rung.steps) {
      for (const int substeps : rung.substeps.empty() ? std::vector<int>{0} : rung.substeps) {
        context.report(1.0, problem.title + ": " + rung.name);
        runs.push_back(bench.run(rung, steps, substeps));
      }
    }
  }
  return runs;
}

Plot plot_motion(const MotionProblem& problem, const std::vector<MotionRun>& runs) {
  Plot plot{"speed_accuracy_motion", problem.title, {}, {}};
  plot.x = {"CPU-seconds per simulated second", true};
  plot.y = {"distance of nodes, rms [mm]", true};
  plot.x.guides = {1.0};
  plot.width_px = 1100;
  std::string last;
  for (const MotionRun& run : runs) {
    if (run.rung != last) plot.series.push_back({label_of(run), {}, {}});
    last = run.rung;
    plot.series.back().x.push_back(run.cost);
    plot.series.back().y.push_back(1.0e3 * run.rms_m);
  }
  return plot;
}

nlohmann::ordered_json motion_json(const std::vector<MotionRun>& runs) {
  auto json = nlohmann::ordered_json::array();
  for (const MotionRun& run : runs) {
    json.push_back({{"method", run.rung},
                    {"steps_a_frame", run.steps},
                    {"substeps", run.substeps},
                    {"cpu_s_per_simulated_s", run.cost},
                    {"times_real_time", 1.0 / run.cost},
                    {"rms_mm", 1e3 * run.rms_m},
                    {"largest_mm", 1e3 * run.largest_m},
                    {"unsolved", run.unsolved}});
    if (run.modes == 0) continue;
    json.back()["modes"] = run.modes;
    json.back()["training_cpu_s"] = run.training_s;
    json.back()["rms_beside_newton_with_the_same_steps_mm"] = 1e3 * run.beside_m;
  }
  return json;
}

}  // namespace soft_robot_lab
