// SPDX-License-Identifier: BSD-3-Clause
#include "study_file.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "robot/scene/parameters.h"
#include "settings/named_file.h"
#include "settings/words.h"
#include "settings/written_options.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

// What the scene refuses becomes an error at the study's line.
template <typename Check>
void check_at(const YamlNode& node, const Check& check) {
  try {
    check();
  } catch (const std::invalid_argument& error) {
    node.fail(error.what());
  }
}

void read_range(const YamlNode& node, StudyParameter& parameter) {
  const YamlNode list = node.child("range");
  const Eigen::VectorXd range = list.as_numbers();
  if (range.size() != 2) list.fail("has " + std::to_string(range.size()) + " numbers, must be [least, largest]");
  if (!(range[0] < range[1]))
    list.fail("is empty: " + format_number(range[0]) + " must be less than " + format_number(range[1]));
  parameter.min = range[0];
  parameter.max = range[1];
}

void read_values(const YamlNode& node, StudyParameter& parameter) {
  const YamlNode list = node.child("values");
  const Eigen::VectorXd values = list.as_numbers();
  if (values.size() == 0) list.fail("is empty; must hold at least one number");
  parameter.values.assign(values.data(), values.data() + values.size());
}

// A range that neither the study nor, for a named parameter, the scene gives is an error.
void read_declared_range(const YamlNode& node, const YamlNode& scene, StudyParameter& parameter) {
  for (const NamedParameter& known : read_parameters(scene)) {
    if (known.name != parameter.name) continue;
    parameter.min = known.min;
    parameter.max = known.max;
    return;
  }
  node.fail("key 'values' or 'range' is missing; only a parameter that the scene's file names has a range of its own");
}

void read_spread(const YamlNode& node, SamplingMethod method, StudyParameter& parameter) {
  if (method == SamplingMethod::grid) parameter.steps = node.integer("steps", 2, kMostTasks);
  parameter.logarithmic = node.choice_or("scale", "linear", {"linear", "logarithmic"}) == "logarithmic";
  if (parameter.logarithmic && parameter.min <= 0.0)
    node.fail("scale logarithmic needs a range above 0, not from " + format_number(parameter.min));
}

void read_distribution(const YamlNode& node, const std::string& kind, SamplingMethod method,
                       StudyParameter& parameter) {
  if (method == SamplingMethod::grid)
    node.fail("has a distribution, which a grid has no use for; choose another method");
  const YamlNode law = node.child(kind);
  const bool normal = kind == "normal";
  parameter.distribution = normal ? Distribution::normal : Distribution::log_normal;
  parameter.centre = normal ? law.number("mean") : law.number("median", AllowedRange::positive());
  parameter.deviation = law.number("deviation", AllowedRange::positive());
  parameter.min = normal ? -std::numeric_limits<double>::infinity() : 0.0;
  parameter.max = std::numeric_limits<double>::infinity();
  if (!node.has("range")) return;
  read_range(node, parameter);
  if (!(parameter.centre > parameter.min && parameter.centre < parameter.max))
    node.child("range").fail("must hold the distribution's middle " + format_number(parameter.centre));
}

// What the scene has to take.
std::vector<double> typical_values(const StudyParameter& parameter) {
  if (!parameter.values.empty()) return parameter.values;
  if (parameter.distribution != Distribution::even) return {parameter.centre};
  return {parameter.min, parameter.max};
}

StudyParameter read_study_parameter(const YamlNode& owner, const std::string& name, SamplingMethod method,
                                    const YamlNode* scene) {
  const YamlNode node = owner.child(name);
  StudyParameter parameter;
  parameter.name = name;
  if (!node.is_map())
    node.fail("must be {values: [...]}, {range: [least, largest]}, {normal: ...} or {log_normal: ...}");
  if (node.has("normal") + node.has("log_normal") + node.has("values") > 1)
    node.fail("has two of values, normal and log_normal; must have one");
  if (node.has("values") && node.has("range")) node.fail("has both values and range; must have one");
  if (node.has("values")) {
    read_values(node, parameter);
  } else if (node.has("normal") || node.has("log_normal")) {
    read_distribution(node, node.has("normal") ? "normal" : "log_normal", method, parameter);
  } else {
    node.has("range") || !scene ? read_range(node, parameter) : read_declared_range(node, *scene, parameter);
    read_spread(node, method, parameter);
  }
  for (const double value : scene ? typical_values(parameter) : std::vector<double>{})
    check_at(node, [&] { parameter_overrides(*scene, {{name, value}}); });
  return parameter;
}

SamplingMethod read_method(const YamlNode& file) {
  static const std::vector<std::string> names = {"grid", "latin_hypercube", "sobol", "sobol_indices"};
  const std::string name = file.choice_or("method", names[0], names);
  return static_cast<SamplingMethod>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::vector<std::string> read_words(const YamlNode& file, const std::string& key) {
  std::vector<std::string> words;
  for (const YamlNode& item : file.optional_sequence(key)) words.push_back(item.as_text());
  return words;
}

// The runner sets these itself, or leaves them out: nothing is written outside of the study's folder.
void refuse_own_arguments(const YamlNode& file, const std::string& program) {
  std::vector<std::string> all = written_options();
  all.insert(all.end(), {"--set", "--seed"});
  if (program == "rollouts") all.emplace_back("--threads");
  if (program == "fit_model") all.emplace_back("--scene");
  for (const YamlNode& item : file.optional_sequence("arguments"))
    for (const std::string& own : all)
      if (item.as_text().rfind(own, 0) == 0) item.fail("'" + own + "' is set by the study itself");
}

// Files are named beside the study, as a recording, wherever its tasks run.
std::vector<std::string> read_arguments(const YamlNode& file, const std::string& program) {
  refuse_own_arguments(file, program);
  std::vector<std::string> arguments = read_words(file, "arguments");
  for (std::string& argument : arguments) {
    std::error_code ignored;
    const fs::path path = fs::absolute(fs::path(file.source()).parent_path() / argument, ignored).lexically_normal();
    if (path.has_extension() && fs::is_regular_file(path, ignored)) argument = path.string();
  }
  return arguments;
}

}  // namespace

std::string read_scene_path(const YamlNode& file, const std::string& key) {
  const YamlNode node = file.child(key);
  const std::string path = named_file(node);
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) node.fail("there is no file " + path);
  return path;
}

std::vector<StudyParameter> read_study_parameters(const YamlNode& file, SamplingMethod method, const YamlNode& scene,
                                                  const std::function<bool(const std::string&)>& of_no_file) {
  const YamlNode node = file.child("parameters");
  std::vector<StudyParameter> parameters;
  for (const std::string& name : node.keys())
    parameters.push_back(read_study_parameter(node, name, method, of_no_file && of_no_file(name) ? nullptr : &scene));
  if (parameters.empty()) node.fail("must name at least one parameter");
  return parameters;
}

StudySettings read_study(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  StudySettings study;
  study.program = file.choice("program", {"simulate", "optimise", "check_casting", "rollouts", "fit_model"});
  study.scene = read_scene_path(file, "scene");
  const YamlNode scene = load_settings(study.scene);
  study.arguments = read_arguments(file, study.program);
  study.method = read_method(file);
  if (study.method != SamplingMethod::grid) study.samples = file.integer("samples", 1, kMostTasks);
  if (study.method == SamplingMethod::grid && file.has("samples"))
    file.child("samples").fail("has no use with method grid, whose parameters have values or steps");
  study.seed = file.integer_or("seed", 1, 1, 1000000);
  study.time_limit_s = file.number_or("time_limit_s", 600.0, {0.0, 1.0e6, true, false});
  study.show = read_words(file, "show");
  study.parameters = read_study_parameters(file, study.method, scene);
  file.require_all_read();
  return study;
}

}  // namespace soft_robot_lab
