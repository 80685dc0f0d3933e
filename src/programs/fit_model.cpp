// SPDX-License-Identifier: BSD-3-Clause
// fit_model BAG --parameters A,B,C: fits a robot's scene to a recorded session, or reports how far it is from one.
#include <iomanip>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "settings/interrupted.h"
#include "settings/write_file.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "ros/recording/recorded_session.h"
#include "session/rest_periods.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string bag, scene, output = "fitted.yaml", result;
  std::vector<std::string> set;
  std::optional<double> from_s, to_s;
  FitRequest request;
};

void declare(CommandLine& app, Arguments& arguments) {
  FitRequest& request = arguments.request;
  app.add_option("BAG", arguments.bag, "a recorded session").type_name("FILE").required();
  app.add_option_function<std::vector<std::string>>(
         "--parameters",
         [&request](const std::vector<std::string>& names) {
           for (const std::string& name : names) request.parameters.push_back({name, {}, {}, {}});
         },
         "what to fit, with commas between: youngs_modulus_pa, density_kg_m3, friction_coefficient, compliance_m_n, "
         "length_offset_m, backlash_m (each with .CABLE for one cable), camera_to_base, damping (by how the robot "
         "swings "
         "where cables let go of it), creep (by how it goes on moving where commands are held)")
      .delimiter(',')
      .one_value_at_a_time()
      .type_name("A,B,...");
  app.add_option("--scene", arguments.scene, "the robot's file, where it is not the one that the recording names")
      .type_name("FILE");
  app.add_option("--output", arguments.output, "where the fitted scene goes").type_name("FILE").show_default();
  app.add_option("--result", arguments.result, "values, deviations, gap and warnings (.json)").type_name("FILE");
  app.add_set_option(arguments.set);
  app.add_option("--from", arguments.from_s, "leave out what was before, since the first markers").type_name("SECONDS");
  app.add_option("--to", arguments.to_s,
                 "leave out what was after; else the part ends where a motor lost its place or was set to zero")
      .type_name("SECONDS");
  app.add_option("--mass", request.mass_kg,
                 "of the whole robot, weighed: stiffness is measured against weight; otherwise the scene's density "
                 "counts")
      .type_name("KG");
  app.add_option("--model-error", request.model_error_m, "by how much the model would still miss a marker's coordinate")
      .type_name("METRES")
      .show_default();
  app.footer(
      "Exit status: 0 fitted, 1 stopped before it converged (the file is still written), 2 bad recording or "
      "arguments.");
}

using Json = nlohmann::ordered_json;

Json gap_json(const ModelGap& gap) { return {{"rms_m", gap.rms_m}, {"markers", gap.marker_rms_m}}; }

Json fit_json(const FitResult& fit) {
  Json result = {{"converged", fit.converged}, {"iterations", fit.iterations}, {"cpu_s", fit.cpu_s}};
  for (const FittedValue& value : fit.values)
    result["values"][value.name] = {{"start", value.start},         {"value", value.value},
                                    {"deviation", value.deviation}, {"low", value.low},
                                    {"high", value.high},           {"identifiable", value.identifiable}};
  result["before"] = gap_json(fit.before);
  result["after"] = gap_json(fit.after);
  result["warnings"] = fit.warnings;
  return result;
}

void write_result(const Arguments& arguments, const Json& result) {
  if (!arguments.result.empty()) write_file(arguments.result, result.dump(2) + "\n");
}

int print_gap(const Arguments& arguments, const std::string& scene, const SceneOptions& options,
              const std::vector<MeasuredPose>& poses) {
  const ModelGap gap = model_gap(scene, options, poses);
  write_result(arguments, {{"before", gap_json(gap)}});
  std::cout << std::setprecision(3) << "rms gap " << 1e3 * gap.rms_m << " mm\n";
  for (const auto& [marker, rms_m] : gap.marker_rms_m) std::cout << "  " << marker << ": " << 1e3 * rms_m << " mm\n";
  return kGood;
}

int fit(const Arguments& arguments) {
  const bool fits = !arguments.request.parameters.empty();
  if (fits) {
    arguments.request.validate();
    require_writable(arguments.output);
  }
  const UsablePart part = usable_part(read_recorded_session(arguments.bag), arguments.from_s, arguments.to_s);
  if (!part.note.empty()) std::cerr << "fit_model: " << part.note << "\n";
  const Recording& recording = part.recording;
  const std::string scene = arguments.scene.empty() ? recording.scene : arguments.scene;
  if (scene.empty()) throw std::invalid_argument("the recording names no scene; give --scene");
  if (fits) require_not_read(arguments.output, scene);
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(scene, arguments.set);
  const std::vector<MeasuredPose> poses = measured_poses(recording);
  if (!fits) return print_gap(arguments, scene, options, poses);
  FitRequest request = arguments.request;
  request.progress = [](int iteration, double rms_gap_m) {
    std::cerr << "iteration " << iteration << ": rms gap " << 1e3 * rms_gap_m << " mm\n";
    return !interrupted();
  };
  heed_interrupts();
  options.interrupt = interrupted;
  const FitResult result = fit_model(scene, options, poses, request, measured_swings(recording));
  std::cout << summary(result);
  write_fitted_scene(result, scene, arguments.output);
  write_result(arguments, fit_json(result));
  std::cout << "written: " << arguments.output << "\n";
  return result.converged ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Fits numbers of the robot's scene to the markers of a recording, wherever the robot was at rest, and writes a\n"
      "scene with them. Exact derivatives, least squares with bounds; says how sure each value is, and what the\n"
      "data cannot identify. Without parameters it reports how far the scene is from the recording.",
      "fit_model");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return fit(arguments); });
}
