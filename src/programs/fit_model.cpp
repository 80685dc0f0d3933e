// SPDX-License-Identifier: BSD-3-Clause
// fit_model BAG --parameters A,B,C: fits a robot's scene to a recorded session, or reports how far it is from one.
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "settings/command_line.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "ros/recording.h"

namespace {

using namespace soft_robot_lab;

constexpr const char* kUsage =
    "usage: fit_model BAG --parameters A,B,... [--scene SCENE.yaml] [--output FITTED.yaml] [--model-error METRES]\n"
    "       [--mass KG]\n"
    "       fit_model BAG [--scene SCENE.yaml]\n"
    "Fits numbers of the robot's scene to the markers of a recording, wherever the robot was at rest, and writes a "
    "scene\n"
    "with them (fitted.yaml). Exact derivatives, least squares with bounds; says how sure each value is, and what the\n"
    "data cannot identify. Without parameters it reports how far the scene is from the recording, and fits nothing.\n"
    "--parameters   youngs_modulus_pa, density_kg_m3, friction_coefficient, compliance_m_n, length_offset_m (each "
    "with\n"
    "               .CABLE for one cable), camera_to_base, damping (by how the robot swings where cables let go of "
    "it)\n"
    "--scene        the robot's file, where it is not the one that the recording names\n"
    "--mass         of the whole robot, weighed: stiffness is measured against weight; otherwise the scene's density "
    "counts\n"
    "--model-error  by how much the model would still miss a marker's coordinate; 1e-4\n"
    "Exit status: 0 fitted, 1 stopped before it converged (the file is still written), 2 bad recording or arguments.\n";

struct Arguments {
  std::string bag, scene, output = "fitted.yaml";
  FitRequest request;
  bool help = false;
};

std::vector<FitParameter> parameters_of(const std::string& list) {
  std::vector<FitParameter> parameters;
  std::istringstream names(list);
  for (std::string name; std::getline(names, name, ',');) parameters.push_back({name, {}, {}, {}});
  return parameters;
}

double number_of(const std::string& option, const std::string& text) {
  std::size_t used = 0;
  double number = 0.0;
  try {
    number = std::stod(text, &used);
  } catch (const std::logic_error&) {  // no number, or too large a one
  }
  if (used == 0 || used != text.size()) throw std::invalid_argument(option + ": '" + text + "' is not a number");
  return number;
}

Arguments parse(int count, char** values) {
  Arguments arguments;
  Words words(count, values);
  while (words.next()) {
    const std::string word = words.word();
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--parameters") {
      arguments.request.parameters = parameters_of(words.value());
    } else if (word == "--scene") {
      arguments.scene = words.value();
    } else if (word == "--output") {
      arguments.output = words.value();
    } else if (word == "--model-error") {
      arguments.request.model_error_m = number_of(word, words.value());
    } else if (word == "--mass") {
      arguments.request.mass_kg = number_of(word, words.value());
    } else if (!word.empty() && word[0] == '-') {
      throw std::invalid_argument("unknown option " + word);
    } else if (arguments.bag.empty()) {
      arguments.bag = word;
    } else {
      throw std::invalid_argument("more than one recording: " + word);
    }
  }
  if (arguments.help) return arguments;
  if (arguments.bag.empty()) throw std::invalid_argument("no recording given");
  if (!arguments.request.parameters.empty()) arguments.request.validate();
  return arguments;
}

int print_gap(const std::string& scene, const SceneOptions& options, const std::vector<MeasuredPose>& poses) {
  const ModelGap gap = model_gap(scene, options, poses);
  std::cout << std::setprecision(3) << "rms gap " << 1e3 * gap.rms_m << " mm\n";
  for (const auto& [marker, rms_m] : gap.marker_rms_m) std::cout << "  " << marker << ": " << 1e3 * rms_m << " mm\n";
  return kGood;
}

int fit(const Arguments& arguments) {
  const bool fits = !arguments.request.parameters.empty();
  if (fits) require_writable(arguments.output);
  const Recording recording = read_recording(arguments.bag);
  const std::string scene = arguments.scene.empty() ? recording.scene : arguments.scene;
  if (scene.empty()) throw std::invalid_argument("the recording names no scene; give --scene");
  SceneOptions options;
  options.actuator_factory = make_actuator;
  const std::vector<MeasuredPose> poses = measured_poses(recording);
  if (!fits) return print_gap(scene, options, poses);
  FitRequest request = arguments.request;
  request.progress = [](int iteration, double rms_gap_m) {
    std::cerr << "iteration " << iteration << ": rms gap " << 1e3 * rms_gap_m << " mm\n";
    return true;
  };
  const FitResult result = fit_model(scene, options, poses, request, measured_swings(recording));
  std::cout << summary(result);
  write_fitted_scene(result, scene, arguments.output);
  std::cout << "written: " << arguments.output << "\n";
  return result.converged ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) { return run_program("fit_model", kUsage, argc, argv, parse, fit); }
