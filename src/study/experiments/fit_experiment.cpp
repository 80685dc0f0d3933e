// SPDX-License-Identifier: BSD-3-Clause
#include "fit_experiment.h"

#include <cmath>
#include <random>
#include <sstream>

#include "control/identification/fit_parameters.h"
#include "control/identification/pose_model.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct FitSettings {
  std::string robot;
  std::vector<MeasuredPose> table, unseen;  // commands only
  double deviation_m = 0.0;                 // of an averaged marker
  FitRequest request;
  Overrides truth_mesh;
  std::vector<FitParameter> truth;  // `start`: the value
  unsigned seed = 1;
};

MeasuredPose pose_of(double left, double right) { return {{{"left", left}, {"right", right}}, {}}; }

FitSettings read_fit_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("fit"));
  FitSettings settings;
  settings.robot = context.config_folder + "/" + node.text("robot");
  std::vector<double> contractions;
  for (const YamlNode& c : node.sequence("contractions")) contractions.push_back(c.as_number(AllowedRange::positive()));
  for (const double left : contractions)
    for (const double right : contractions) settings.table.push_back(pose_of(left, right));
  for (const YamlNode& pair : node.sequence("unseen")) {
    const Eigen::VectorXd both = pair.as_numbers();
    if (both.size() != 2) pair.fail("must be [left, right]");
    settings.unseen.push_back(pose_of(both[0], both[1]));
  }
  settings.deviation_m =
      node.number("deviation_m", AllowedRange::positive()) / std::sqrt(node.integer("frames", 1, 100000));
  settings.request.model_error_m = node.number("model_error_m", AllowedRange::not_negative());
  settings.seed = static_cast<unsigned>(node.integer("seed", 1, 1000000));
  for (const YamlNode& name : node.sequence("parameters"))
    settings.request.parameters.push_back({name.as_text(), {}, {}, {}});
  const YamlNode truth = node.child("truth");
  settings.truth_mesh.set({"body", "element_size_m"}, truth.number("element_size_m", AllowedRange::positive()));
  const YamlNode values = truth.child("values");
  for (const std::string& name : values.keys()) settings.truth.push_back({name, values.number(name), {}, {}});
  node.require_all_read();
  return settings;
}

// The robot that plays the truth: the model's own parameters with other values, on another mesh.
class TrueRobot {
 public:
  TrueRobot(const ExperimentContext& context, const FitSettings& settings)
      : settings_(settings),
        options_(context.scene_options(settings.truth_mesh)),
        parameters_(settings.robot, options_, asked(settings.truth)),
        values_(values_of(parameters_, settings.truth)),
        random_(settings.seed) {}

  // Noisy where `frames` cameras look, or as it is.
  std::vector<MeasuredPose> measure(std::vector<MeasuredPose> poses, bool noisy) {
    const Scene scene = load_scene(settings_.robot, options_);
    for (MeasuredPose& pose : poses)
      for (const Marker& marker : scene.simulation->markers())
        pose.markers.push_back(
            {marker.name(), Eigen::Vector3d::Zero(), std::pow(settings_.deviation_m, 2) * Eigen::Matrix3d::Identity()});
    const std::vector<PosePrediction> at =
        PoseModel(settings_.robot, options_, poses).predict(parameters_.overrides(values_));
    const Eigen::Isometry3d measured_from_base = parameters_.measured_from_base(values_);
    std::normal_distribution<double> normal(0.0, noisy ? settings_.deviation_m : 0.0);
    for (std::size_t p = 0; p < poses.size(); ++p) {
      for (std::size_t m = 0; m < poses[p].markers.size(); ++m) {
        Eigen::Vector3d noise_m;
        for (int axis = 2; axis >= 0; --axis) noise_m[axis] = normal(random_);
        poses[p].markers[m].position_m =
            measured_from_base * at[p].markers_m.col(static_cast<Eigen::Index>(m)) + noise_m;
      }
    }
    return poses;
  }

  // By the name of a fitted value; NaN where it is not among the truth's.
  double value(const std::string& name) const {
    for (std::size_t i = 0; i < parameters_.numbers().size(); ++i)
      if (parameters_.numbers()[i].name == name) return values_[static_cast<Eigen::Index>(i)];
    return std::numeric_limits<double>::quiet_NaN();
  }

 private:
  // Parameters by their first names, all of them as they come.
  static std::vector<FitParameter> asked(const std::vector<FitParameter>& truth) {
    std::vector<FitParameter> plain;
    for (const FitParameter& one : truth) {
      const bool camera = one.name.rfind("camera_to_base.", 0) == 0;
      const std::string name = camera ? "camera_to_base" : one.name;
      if (!plain.empty() && plain.back().name == name) continue;
      plain.push_back({name, {}, {}, {}});
    }
    return plain;
  }

  static Eigen::VectorXd values_of(const FitParameters& parameters, const std::vector<FitParameter>& truth) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(parameters.numbers().size()));
    for (std::size_t i = 0; i < parameters.numbers().size(); ++i) {
      const FitNumber& number = parameters.numbers()[i];
      values[static_cast<Eigen::Index>(i)] = number.start;
      for (const FitParameter& one : truth)
        if (one.name == number.name) values[static_cast<Eigen::Index>(i)] = *one.start;
    }
    return values;
  }

  const FitSettings& settings_;
  SceneOptions options_;
  FitParameters parameters_;
  Eigen::VectorXd values_;
  std::mt19937 random_;
};

nlohmann::ordered_json to_json(const ModelGap& gap) {
  nlohmann::ordered_json json = {{"rms_m", gap.rms_m}};
  for (const auto& [marker, rms_m] : gap.marker_rms_m) json["markers"][marker] = rms_m;
  return json;
}

}  // namespace

ExperimentResult run_fit_experiment(const ExperimentContext& context) {
  const FitSettings settings = read_fit_settings(context);
  context.report(0.0, "measuring");
  TrueRobot truth(context, settings);
  const std::vector<MeasuredPose> table = truth.measure(settings.table, true),
                                  unseen = truth.measure(settings.unseen, false);
  const SceneOptions options = context.scene_options();
  FitRequest request = settings.request;
  request.progress = [&](int iteration, double rms_gap_m) {
    std::ostringstream text;
    text << "iteration " << iteration << ", rms gap " << 1e3 * rms_gap_m << " mm";
    context.report(std::min(0.9, 0.1 + 0.03 * iteration), text.str());
    return true;
  };
  const FitResult fit = fit_model(settings.robot, options, table, request);
  context.report(0.95, "unseen poses");
  const ModelGap before = model_gap(settings.robot, options, unseen);
  const ModelGap after =
      model_gap(settings.robot, context.scene_options(fit.overrides), unseen, fit.measured_from_base);

  ExperimentResult result;
  result.title = "Spinebot: the model fitted to its table of contractions";
  result.converged = fit.converged;
  result.message = fit.converged ? "" : fit.message;
  result.table.columns = {{"parameter"}, {"model's"}, {"fitted"}, {"standard deviation", 2}, {"true"}};
  for (const FittedValue& value : fit.values) {
    result.table.rows.push_back({value.name, value.start, value.value, value.deviation, truth.value(value.name)});
    result.numbers["values"][value.name] = {{"start", value.start},
                                            {"found", value.value},
                                            {"deviation", value.deviation},
                                            {"true", truth.value(value.name)},
                                            {"identifiable", value.identifiable}};
  }
  result.numbers["warnings"] = fit.warnings;
  result.numbers["fit"] = {{"before", to_json(fit.before)}, {"after", to_json(fit.after)}};
  result.numbers["unseen"] = {
      {"before", to_json(before)}, {"after", to_json(after)}, {"ratio", before.rms_m / after.rms_m}};
  result.numbers["iterations"] = fit.iterations;
  result.numbers["cpu_s"] = fit.cpu_s;
  write_fitted_scene(fit, settings.robot, context.output_folder + "/fitted.yaml");
  std::ostringstream words;
  words.precision(3);
  words << "On poses that the fit has not seen the rms gap falls from " << 1e3 * before.rms_m << " mm to "
        << 1e3 * after.rms_m << " mm, " << before.rms_m / after.rms_m
        << " times less. fitted.yaml is the robot with these values.";
  for (const std::string& warning : fit.warnings) words << " Warning: " << warning << ".";
  result.we_find = words.str();
  return result;
}

}  // namespace soft_robot_lab
