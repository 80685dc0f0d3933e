// SPDX-License-Identifier: BSD-3-Clause
#include "fit_rig_experiment.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "control/identification/creep_model.h"
#include "recorder.h"
#include "robot/scene/parameters.h"
#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {
namespace {

struct FitRigSettings {
  LabFiles files;
  std::vector<Configuration> configurations, unseen;
  RecordingSettings recording = {};
  FitRequest request = {};
};

FitRigSettings read_fit_rig_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("fit_rig"));
  FitRigSettings settings{read_lab_files(node, context), read_configurations(node),
                          read_configurations(node.child("unseen"))};
  settings.recording = read_recording_settings(node);
  settings.request = read_fit_request(node);
  node.require_all_read();
  return settings;
}

// What plant.yaml hides, by the names of fitted values.
std::map<std::string, double> hidden(const FitRigSettings& settings, const Simulation& plant) {
  std::map<std::string, double> values = {{"youngs_modulus_pa", plant.body().material().youngs_modulus_pa},
                                          {"creep.stiffness_ratio", plant.body().viscosity().hysteresis_ratio},
                                          {"creep.relaxation_time_s", plant.body().viscosity().relaxation_time_s}};
  const PlantSettings& file = settings.files.lab.plant;
  for (const MotorSettings& motor : settings.files.lab.rig.motors) {
    for (const std::string key : {"friction_coefficient", "compliance_m_n", "length_offset_m"}) {
      const bool one_each = key == "length_offset_m";
      values[one_each ? key + "." + motor.name : key] = number_at(file.robot, "cables." + motor.name + "." + key);
    }
    const auto steps = file.backlash_steps.find(motor.name);
    values["backlash_m." + motor.name] = steps == file.backlash_steps.end() ? 0.0 : steps->second * motor.step_m;
  }
  return values;
}

Table table_of(const FitResult& fit, const std::map<std::string, double>& hidden) {
  Table table{{{"parameter"}, {"model's"}, {"fitted", 4}, {"standard deviation", 2}, {"hidden"}, {"off [%]", 2}}, {}};
  for (const FittedValue& value : fit.values) {
    const auto truth = hidden.find(value.name);
    std::vector<TableCell> row = {value.name, value.start, value.value, value.deviation};
    row.push_back(truth == hidden.end() ? TableCell("") : TableCell(truth->second));
    row.push_back(truth == hidden.end() ? TableCell("") : TableCell(100.0 * (value.value / truth->second - 1.0)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Of the unseen poses, which the model goes through in time as the robot did, after all poses before them: where cables
// rub, it counts how it came there.
double unseen_gap_m(const FitRigSettings& settings, const ExperimentContext& context,
                    const std::vector<MeasuredPose>& poses, const std::vector<MeasuredPose>& unseen,
                    const FitResult& fit, const Overrides& overrides) {
  std::vector<MeasuredPose> all = poses;
  all.insert(all.end(), unseen.begin(), unseen.end());
  const SceneOptions options = context.scene_options(overrides);
  const std::vector<SimulatedHold> holds = simulate_holds(settings.files.robot, options, all, fit.backlash_m);
  const Scene loaded = load_scene(settings.files.robot, options);
  double squares_m2 = 0.0;
  int count = 0;
  for (std::size_t p = poses.size(); p < all.size(); ++p) {
    for (const MeasuredMarker& marker : all[p].markers) {
      const int index = loaded.simulation->marker_index(marker.name);
      const Eigen::Vector3d simulated_m = holds[p].mean(index, all[p].rest_from_s, all[p].held_s);
      squares_m2 += (marker.position_m - fit.measured_from_base * simulated_m).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(squares_m2 / count);
}

FitResult fit_to(const FitRigSettings& settings, const Recorder& recorder, const std::vector<MeasuredPose>& poses,
                 const ExperimentContext& context) {
  FitRequest request = settings.request;
  request.mass_kg = recorder.plant().simulation().body().node_masses_kg().sum();
  request.progress = [&](int iteration, double rms_gap_m) {
    context.report(std::min(0.95, 0.5 + 0.01 * iteration), "rms gap " + std::to_string(1e3 * rms_gap_m) + " mm");
    return true;
  };
  return fit_model(settings.files.robot, context.scene_options(settings.recording.known), poses, request);
}

}  // namespace

FitResult fit_emulated_rig(const ExperimentContext& context) {
  const FitRigSettings settings = read_fit_rig_settings(context);
  Recorder recorder(settings.files, settings.recording, context);
  const std::vector<MeasuredPose> poses = recorder.record(settings.configurations, context, 0.0, 0.4);
  return fit_to(settings, recorder, poses, context);
}

ExperimentResult run_fit_rig_experiment(const ExperimentContext& context) {
  const FitRigSettings settings = read_fit_rig_settings(context);
  context.report(0.0, "calibrating the cameras");
  Recorder recorder(settings.files, settings.recording, context);
  const std::vector<MeasuredPose> poses = recorder.record(settings.configurations, context, 0.0, 0.4);
  const std::vector<MeasuredPose> unseen = recorder.record(settings.unseen, context, 0.4, 0.5);
  const FitResult fit = fit_to(settings, recorder, poses, context);
  const double before_m = unseen_gap_m(settings, context, poses, unseen, {}, settings.recording.known);
  const double after_m = unseen_gap_m(settings, context, poses, unseen, fit, fit.overrides);

  const std::map<std::string, double> truth = hidden(settings, recorder.plant().simulation());
  ExperimentResult result;
  result.title = "Spinebot: the model fitted to one recording of the emulated rig";
  result.converged = fit.converged && recorder.plant().failed_steps() == 0;
  result.message = fit.converged ? "" : fit.message;
  result.table = table_of(fit, truth);
  for (const FittedValue& value : fit.values)
    result.numbers["values"][value.name] = {{"found", value.value}, {"deviation", value.deviation}};
  for (const auto& [name, value] : truth) result.numbers["hidden"][name] = value;
  result.numbers["fit_gap_m"] = {fit.before.rms_m, fit.after.rms_m};
  result.numbers["unseen_gap_m"] = {before_m, after_m};
  result.numbers["warnings"] = fit.warnings;
  result.numbers["cpu_s"] = fit.cpu_s;
  write_fitted_scene(fit, settings.files.robot, context.output_folder + "/fitted.yaml");
  result.we_differ = "The robot on the emulated rig is our own model with other numbers and another mesh.";
  std::ostringstream words;
  words.precision(3);
  words << "On poses that the fit has not seen the rms gap falls from " << 1e3 * before_m << " mm to " << 1e3 * after_m
        << " mm.";
  for (const std::string& warning : fit.warnings) words << " Warning: " << warning << ".";
  result.we_find = words.str();
  return result;
}

}  // namespace soft_robot_lab
