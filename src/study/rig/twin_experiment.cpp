// SPDX-License-Identifier: BSD-3-Clause
#include "twin_experiment.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>

#include "control/estimation/load_estimator.h"
#include "control/estimation/push_places.h"
#include "recorder.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr double kFingertip_m = 0.003;  // over such a radius a push spreads
constexpr double kPlaceSpacing_m = 0.003;
constexpr double kPushFriction = 0.3;  // pushes lie within such a cone around the inward normal
constexpr double kGravity_m_s2 = 9.81;

// Of one robot.
struct TwinRobot {
  std::string name;
  LabFiles files;
  std::vector<Configuration> configurations;
  RecordingSettings recording = {};
  FitRequest request = {};
};

struct TwinSettings {
  int pushes = 0, pairs = 0, weights = 0;  // for each robot
  int seed = 1;
  double wait_s = 0.0;  // before a look
  AllowedRange force_n, mass_kg;
  std::vector<TwinRobot> robots;
};

AllowedRange read_range(const YamlNode& node) {
  const std::vector<YamlNode> ends = node.items();
  if (ends.size() != 2) node.fail("is not [least, most]");
  const double least = ends[0].as_number(AllowedRange::positive());
  return {least, ends[1].as_number({least, 100.0})};
}

TwinSettings read_twin_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("twin"));
  TwinSettings settings;
  settings.pushes = node.integer("pushes", 0, 1000);
  settings.pairs = node.integer("pairs", 0, 1000);
  settings.weights = node.integer("weights", 0, 1000);
  settings.seed = node.integer_or("seed", settings.seed, 0, 1000000);
  settings.wait_s = node.number("wait_s", AllowedRange::positive());
  settings.force_n = read_range(node.child("force_n"));
  settings.mass_kg = read_range(node.child("mass_kg"));
  for (const YamlNode& robot : node.sequence("robots")) {
    settings.robots.push_back({robot.text("name"), read_lab_files(robot, context), read_configurations(robot)});
    TwinRobot& read = settings.robots.back();
    read.recording = read_recording_settings(robot);
    read.request = read_fit_request(robot);
  }
  node.require_all_read();
  return settings;
}

// What truly acts on the robot.
struct TrueLoad {
  PointLoad load;
  std::string marker;  // of a weight
};

// What cameras saw of the resting robot, and where its markers were.
struct Look {
  std::vector<MeasuredMarker> seen;
  MarkerPlaces true_m;
};

struct Trial {
  std::string robot;
  LoadKind kind = LoadKind::none;  // asked
  std::vector<double> commands;
  std::vector<TrueLoad> truth;
  std::vector<Eigen::Vector3d> places_m;  // of the true loads, where the loaded robot is
  Look before, after;
  LoadEstimate untouched, touched;
  double skin_untouched_m = 0.0, skin_touched_m = 0.0;  // rms
};

class Random {
 public:
  explicit Random(int seed) : engine_(static_cast<std::uint64_t>(seed)) {}
  double between(const AllowedRange& range) { return range.min + (range.max - range.min) * share_(engine_); }
  double log_between(const AllowedRange& range) {
    return range.min * std::exp(share_(engine_) * std::log(range.max / range.min));
  }
  std::size_t one_of(const std::vector<double>& weights) {
    return std::discrete_distribution<std::size_t>(weights.begin(), weights.end())(engine_);
  }
  std::size_t below(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(share_(engine_) * count));
  }

 private:
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> share_{0.0, 1.0};
};

// A robot on the rig, its twin, and both at random commands.
class TwinBench {
 public:
  // Keeps references to robot and settings.
  TwinBench(const TwinRobot& twin, const TwinSettings& settings, const ExperimentContext& context, double from,
            double to)
      : twin_(twin), settings_(settings), recorder_(twin.files, twin.recording, context), random_(settings.seed) {
    const std::vector<MeasuredPose> poses = recorder_.record(twin.configurations, context, from, to);
    context.report(to, twin.name + ": fit");
    FitRequest request = twin.request;
    request.mass_kg = robot().body().node_masses_kg().sum();
    fit_ = fit_model(twin.files.robot, context.scene_options(twin.recording.known), poses, request);
    write_fitted_scene(fit_, twin.files.robot, context.output_folder + "/" + twin.name + ".yaml");
    model_ = load_scene(twin.files.robot, context.scene_options(fit_.overrides)).simulation;
    estimator_ = std::make_unique<LoadEstimator>(*model_, LoadEstimationOptions{});
    places_ = push_places(robot().body(), kPlaceSpacing_m);
    for (const PushPlace& place : places_) areas_m2_.push_back(place.area_m2);
    const MeshLocator locator(robot().body().mesh());
    for (const PushPlace& place : push_places(model_->body(), 4.0 * kPlaceSpacing_m)) {
      model_skin_.push_back(place.at);
      robot_skin_.push_back(locator.embed(place.at.at(model_->body().mesh().nodes_m)));
    }
  }

  Trial run(LoadKind kind) {
    Trial trial;
    trial.robot = twin_.name;
    trial.kind = kind;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < model_->actuators().size(); ++i) {
      names.push_back(model_->actuators()[i]->name());
      trial.commands.push_back(recorder_.rounded(names.back(), random_.between(commanded(i))));
    }
    lab().go(names, trial.commands);
    lab().wait(settings_.wait_s);
    follow(names, trial.commands);
    trial.before = look();
    on_clock([&] { trial.untouched = estimator_->estimate(trial.before.seen); });
    trial.skin_untouched_m = skin_rms_m(model_->state().positions_m);
    estimator_->take_offsets(trial.before.seen);
    draw_loads(trial);
    std::vector<PointLoad> loads;
    for (const TrueLoad& one : trial.truth) loads.push_back(one.load);
    lab().load(loads);
    lab().wait(settings_.wait_s);
    trial.after = look();
    on_clock([&] { trial.touched = estimator_->estimate(trial.after.seen); });
    for (const PointLoad& load : loads) trial.places_m.push_back(load.at.at(robot().state().positions_m));
    trial.skin_touched_m = skin_rms_m(estimator_->estimated_state().positions_m);
    lab().load({});
    return trial;
  }

  double cpu_s() const { return cpu_s_; }
  double time_s() const { return recorder_.time_s(); }
  const FitResult& fit() const { return fit_; }
  int failed_steps() const { return recorder_.plant().failed_steps(); }

 private:
  EmulatedLab& lab() { return recorder_.lab(); }
  const Simulation& robot() const { return recorder_.plant().simulation(); }

  // Between the least and most of the configurations that were fitted.
  AllowedRange commanded(std::size_t actuator) const {
    AllowedRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Configuration& one : twin_.configurations) {
      range.min = std::min(range.min, one.commands.at(actuator));
      range.max = std::max(range.max, one.commands.at(actuator));
    }
    return range;
  }

  template <typename Work>
  void on_clock(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    cpu_s_ += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }

  void follow(const std::vector<std::string>& names, const std::vector<double>& commands) {
    on_clock([&] {
      for (std::size_t i = 0; i < names.size(); ++i) model_->set_command(names[i], commands[i]);
      if (const SolveReport rest = model_->solve_equilibrium(); !rest.converged)
        throw std::runtime_error(twin_.name + ": the fitted model finds no rest: " + rest.message);
    });
  }

  // As a running tracker sees it, which knows from the frames before which marker is which; in the model's frame.
  // Errors of frames that stay are in the offsets, so a mean of frames is surer than one.
  Look look() {
    Look look{lab().observe(lab().plant().markers_m()), lab().plant().markers_m()};
    const double frames = twin_.files.lab.frames;
    const Eigen::Isometry3d base_from_measured = fit_.measured_from_base.inverse();
    for (MeasuredMarker& marker : look.seen) {
      marker.position_m = base_from_measured * marker.position_m;
      marker.covariance_m2 =
          base_from_measured.linear() * marker.covariance_m2 * base_from_measured.linear().transpose() / frames;
    }
    return look;
  }

  TrueLoad random_push() {
    const PushPlace& place = places_[random_.one_of(areas_m2_)];
    const TetMesh& mesh = robot().body().mesh();
    const Eigen::Vector3d rest_normal = normal_at(mesh, mesh.nodes_m, place),
                          normal = normal_at(mesh, robot().state().positions_m, place);
    const double angle = random_.between({0.0, 2.0 * M_PI}), lean = random_.between({0.0, kPushFriction});
    const Eigen::Vector3d across = normal.unitOrthogonal(),
                          along = std::cos(angle) * across + std::sin(angle) * normal.cross(across);
    const Eigen::Vector3d direction = (-normal + lean * along).normalized();
    return {{MeshLocator(mesh).embed_disc(place.at.at(mesh.nodes_m), rest_normal, kFingertip_m),
             random_.log_between(settings_.force_n) * direction},
            {}};
  }

  void draw_loads(Trial& trial) {
    if (trial.kind == LoadKind::weight) {
      const Marker& marker = robot().markers()[random_.below(robot().markers().size())];
      const MeshLocator locator(robot().body().mesh());
      const double mass_kg = random_.log_between(settings_.mass_kg);
      trial.truth.push_back(
          {{locator.embed(marker.rest_position_m()), {0.0, 0.0, -kGravity_m_s2 * mass_kg}}, marker.name()});
      return;
    }
    trial.truth.push_back(random_push());
    if (trial.kind == LoadKind::two_pushes) trial.truth.push_back(random_push());
  }

  double skin_rms_m(const Eigen::Matrix3Xd& model_m) const {
    double sum_m2 = 0.0;
    for (std::size_t i = 0; i < model_skin_.size(); ++i)
      sum_m2 += (model_skin_[i].at(model_m) - robot_skin_[i].at(robot().state().positions_m)).squaredNorm();
    return std::sqrt(sum_m2 / static_cast<double>(model_skin_.size()));
  }

  const TwinRobot& twin_;
  const TwinSettings& settings_;
  Recorder recorder_;
  FitResult fit_;
  std::unique_ptr<Simulation> model_;
  std::unique_ptr<LoadEstimator> estimator_;
  std::vector<PushPlace> places_;  // of the robot
  std::vector<double> areas_m2_;
  std::vector<EmbeddedPoint> model_skin_, robot_skin_;  // the same places
  Random random_;
  double cpu_s_ = 0.0;
};

// NaN where there are none, which JSON writes as null.
double share_of(const std::vector<double>& values, double share) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : quantile(values, share);
}

struct Score {
  int pushes = 0, missed = 0, observable = 0, pairs = 0, pairs_seen = 0, looks = 0, false_alarms = 0;
  std::vector<double> place_errors_m, force_n, force_ratio, weight_ratio, weight_kg, skin_untouched_m, skin_touched_m;

  void count(const Trial& trial) {
    ++looks;
    false_alarms += trial.untouched.kind != LoadKind::none;
    skin_untouched_m.push_back(trial.skin_untouched_m);
    skin_touched_m.push_back(trial.skin_touched_m);
    const LoadEstimate& found = trial.touched;
    if (trial.kind == LoadKind::two_pushes) {
      ++pairs;
      pairs_seen += found.kind == LoadKind::two_pushes;
    } else if (trial.kind == LoadKind::weight) {
      const double true_n = trial.truth[0].load.force_n.norm();
      const bool right = found.kind == LoadKind::weight && found.loads[0].marker == trial.truth[0].marker;
      const double off_n = right ? std::abs(found.loads[0].force_n.norm() - true_n) : true_n;
      weight_ratio.push_back(off_n / true_n);
      weight_kg.push_back(off_n / kGravity_m_s2);
    } else {
      ++pushes;
      missed += found.kind != LoadKind::push;
      if (found.kind != LoadKind::push || !found.loads[0].observable) return;
      ++observable;
      const double true_n = trial.truth[0].load.force_n.norm();
      place_errors_m.push_back((found.loads[0].position_m - trial.places_m[0]).norm());
      force_n.push_back((found.loads[0].force_n - trial.truth[0].load.force_n).norm());
      force_ratio.push_back(std::abs(found.loads[0].force_n.norm() - true_n) / true_n);
    }
  }
};

nlohmann::ordered_json triple(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json json_of(const Look& look) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MeasuredMarker& marker : look.seen) {
    const Eigen::Matrix3d& c = marker.covariance_m2;
    json.push_back({{"marker", marker.name},
                    {"position_m", triple(marker.position_m)},
                    {"covariance_m2", {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)}},
                    {"true_m", triple(look.true_m.at(marker.name))}});
  }
  return json;
}

nlohmann::ordered_json json_of(const Trial& trial) {
  const LoadEstimate& found = trial.touched;
  nlohmann::ordered_json json = {{"robot", trial.robot},
                                 {"kind", name_of(trial.kind)},
                                 {"commands", trial.commands},
                                 {"untouched", name_of(trial.untouched.kind)},
                                 {"found", name_of(found.kind)},
                                 {"probability", found.probability},
                                 {"chi2_unloaded", found.chi2_unloaded},
                                 {"chi2", found.chi2},
                                 {"message", found.message},
                                 {"seen_untouched", json_of(trial.before)},
                                 {"seen_touched", json_of(trial.after)}};
  for (std::size_t i = 0; i < trial.truth.size(); ++i)
    json["true"].push_back({{"position_m", triple(trial.places_m[i])},
                            {"force_n", triple(trial.truth[i].load.force_n)},
                            {"marker", trial.truth[i].marker}});
  for (const EstimatedLoad& load : found.loads)
    json["loads"].push_back({{"position_m", triple(load.position_m)},
                             {"position_deviation_m", std::sqrt(load.position_covariance_m2.trace())},
                             {"force_n", triple(load.force_n)},
                             {"force_deviation_n", std::sqrt(load.force_covariance_n2.trace())},
                             {"observable", load.observable},
                             {"marker", load.marker}});
  return json;
}

nlohmann::ordered_json json_of(const Score& score, double cpu_cores) {
  return {{"place_median_m", share_of(score.place_errors_m, 0.5)},
          {"place_90_m", share_of(score.place_errors_m, 0.9)},
          {"force_median_n", share_of(score.force_n, 0.5)},
          {"force_median_ratio", share_of(score.force_ratio, 0.5)},
          {"weight_median_ratio", share_of(score.weight_ratio, 0.5)},
          {"weight_median_kg", share_of(score.weight_kg, 0.5)},
          {"pushes", score.pushes},
          {"pushes_observable", score.observable},
          {"pushes_missed", score.missed},
          {"pairs", score.pairs},
          {"pairs_seen", score.pairs_seen},
          {"looks_untouched", score.looks},
          {"false_alarms", score.false_alarms},
          {"skin_untouched_median_m", share_of(score.skin_untouched_m, 0.5)},
          {"skin_touched_median_m", share_of(score.skin_touched_m, 0.5)},
          {"cpu_cores", cpu_cores}};
}

std::vector<TableCell> row_of(const std::string& name, const Score& score, double cpu_cores) {
  const auto mm = [](const std::vector<double>& values, double share) { return 1e3 * share_of(values, share); };
  return {name,
          static_cast<double>(score.pushes),
          static_cast<double>(score.observable),
          mm(score.place_errors_m, 0.5),
          mm(score.place_errors_m, 0.9),
          1e3 * share_of(score.force_n, 0.5),
          1e2 * share_of(score.force_ratio, 0.5),
          1e2 * share_of(score.weight_ratio, 0.5),
          std::to_string(score.pairs_seen) + " of " + std::to_string(score.pairs),
          std::to_string(score.false_alarms) + " of " + std::to_string(score.looks),
          mm(score.skin_untouched_m, 0.5),
          mm(score.skin_touched_m, 0.5),
          cpu_cores};
}

Plot draw(const std::vector<Trial>& trials) {
  Plot plot{"twin", "Where a push is felt", {"push [mN]"}, {"place is off by [mm]"}, {}};
  plot.x.min = plot.y.min = 0.0;
  std::map<std::string, Series> by_robot;
  for (const Trial& trial : trials) {
    if (trial.kind != LoadKind::push || trial.touched.kind != LoadKind::push || !trial.touched.loads[0].observable)
      continue;
    Series& series = by_robot.emplace(trial.robot, Series{trial.robot, {}, {}, SeriesStyle::points}).first->second;
    series.x.push_back(1e3 * trial.truth[0].load.force_n.norm());
    series.y.push_back(1e3 * (trial.touched.loads[0].position_m - trial.places_m[0]).norm());
  }
  for (auto& [name, series] : by_robot) plot.series.push_back(std::move(series));
  return plot;
}

std::string words(const Score& all) {
  std::ostringstream text;
  text.precision(3);
  text << "Of " << all.pushes << " pushes " << all.observable << " have a place that can be known; these are found "
       << 1e3 * share_of(all.place_errors_m, 0.5) << " mm off in the median and within "
       << 1e3 * share_of(all.place_errors_m, 0.9) << " mm in nine of ten, their force within "
       << 1e3 * share_of(all.force_n, 0.5) << " mN. " << all.missed
       << " pushes were not seen, or taken for something else. Of " << all.pairs << " pairs of pushes "
       << all.pairs_seen << " were seen as two. Weights are " << 1e2 * share_of(all.weight_ratio, 0.5)
       << " % off in the median. Of " << all.looks << " looks at an untouched robot " << all.false_alarms
       << " raised a false alarm.";
  return text.str();
}

}  // namespace

ExperimentResult run_twin_experiment(const ExperimentContext& context) {
  const TwinSettings settings = read_twin_settings(context);
  ExperimentResult result;
  result.title = "The live twin: what pushes the robot, and where";
  result.table.columns = {{"robot"},
                          {"pushes"},
                          {"place known"},
                          {"place off, median [mm]", 3},
                          {"90 % [mm]", 3},
                          {"force off, median [mN]", 3},
                          {"size of force off, median [%]", 3},
                          {"weight off, median [%]", 3},
                          {"pairs seen as two"},
                          {"false alarms"},
                          {"skin off, untouched [mm]", 3},
                          {"skin off, touched [mm]", 3},
                          {"cores"}};
  std::vector<Trial> trials;
  Score all;
  double cpu_s = 0.0, time_s = 0.0;
  const double share = 1.0 / static_cast<double>(settings.robots.size());
  for (std::size_t r = 0; r < settings.robots.size(); ++r) {
    const std::string& name = settings.robots[r].name;
    const double from = share * static_cast<double>(r);
    TwinBench bench(settings.robots[r], settings, context, from, from + 0.2 * share);
    const double cpu_before_s = bench.cpu_s(), time_before_s = bench.time_s();
    Score score;
    const int count = settings.pushes + settings.pairs + settings.weights;
    for (int i = 0; i < count; ++i) {
      const LoadKind kind = i < settings.pushes                    ? LoadKind::push
                            : i < settings.pushes + settings.pairs ? LoadKind::two_pushes
                                                                   : LoadKind::weight;
      context.report(from + share * (0.3 + 0.7 * i / count), name + ": " + name_of(kind));
      trials.push_back(bench.run(kind));
      score.count(trials.back());
      all.count(trials.back());
    }
    const double robot_cpu_s = bench.cpu_s() - cpu_before_s, robot_time_s = bench.time_s() - time_before_s;
    cpu_s += robot_cpu_s;
    time_s += robot_time_s;
    result.table.rows.push_back(row_of(name, score, robot_cpu_s / robot_time_s));
    result.numbers["robots"][name] = json_of(score, robot_cpu_s / robot_time_s);
    result.numbers["robots"][name]["fit_gap_m"] = {bench.fit().before.rms_m, bench.fit().after.rms_m};
    if (bench.failed_steps() > 0) {
      result.converged = false;
      result.message = name + ": " + std::to_string(bench.failed_steps()) + " time steps did not converge";
    }
  }
  result.numbers.update(json_of(all, cpu_s / time_s));
  for (const Trial& trial : trials) result.numbers["each"].push_back(json_of(trial));
  result.plots = {draw(trials)};
  result.we_differ =
      "The robots on the emulated rig are our own models with other numbers and meshes; what pushes them is a force "
      "over "
      "a fingertip of 3 mm, not a finger with a shape.";
  result.we_find = words(all);
  return result;
}

}  // namespace soft_robot_lab
