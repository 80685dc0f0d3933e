// SPDX-License-Identifier: BSD-3-Clause
#include "search_file.h"

#include <algorithm>

#include "robot/scene/parameters.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

const std::vector<Objective> kObjectives = {{"reach_m", true},
                                            {"workspace_m", true},
                                            {"workspace_m2", true},
                                            {"workspace_m3", true},
                                            {"largest_tension_n", false},
                                            {"mass_kg", false},
                                            {"stiffness_sensitivity_m", false},
                                            {"mean_distance_m", false}};

std::vector<Objective> read_objectives(const YamlNode& file) {
  std::vector<Objective> objectives;
  for (const YamlNode& item : file.sequence("objectives")) {
    const std::string name = item.as_text();
    const auto known =
        std::find_if(kObjectives.begin(), kObjectives.end(), [&](const Objective& one) { return one.name == name; });
    std::vector<std::string> names;
    for (const Objective& one : kObjectives) names.push_back(one.name);
    if (known == kObjectives.end()) item.fail("'" + name + "' is not one of " + join(names));
    objectives.push_back(*known);
  }
  if (objectives.empty()) file.child("objectives").fail("is empty; must name at least one");
  return objectives;
}

std::vector<std::string> read_assessment(const YamlNode& file, const std::vector<Objective>& objectives) {
  std::vector<std::string> arguments = {"--steps", std::to_string(file.integer_or("steps", 5, 2, 100))};
  if (file.boolean_or("one_at_a_time", false)) arguments.emplace_back("--one-at-a-time");
  if (file.has("marker")) arguments.insert(arguments.end(), {"--marker", file.text("marker")});
  if (file.has("max_tension_n"))
    arguments.insert(arguments.end(),
                     {"--max-tension", format_number(file.number("max_tension_n", AllowedRange::positive()))});
  const std::vector<YamlNode> targets = file.optional_sequence("targets_m");
  for (const YamlNode& target : targets) {
    const Eigen::VectorXd at_m = target.as_numbers();
    if (at_m.size() != 3) target.fail("must be [x, y, z]");
    arguments.emplace_back("--target");
    for (const double value : at_m) arguments.push_back(format_number(value));
  }
  const bool needed = std::any_of(objectives.begin(), objectives.end(),
                                  [](const Objective& one) { return one.name == "mean_distance_m"; });
  if (needed && targets.empty()) file.fail("key 'targets_m' is missing; objective mean_distance_m needs it");
  return arguments;
}

void read_method(const YamlNode& file, SearchSettings& search) {
  const bool several = search.objectives.size() > 1;
  search.method = several ? file.choice_or("method", "nsga2", {"nsga2"})
                          : file.choice_or("method", "cma_es", {"cma_es", "differential_evolution"});
  search.population = file.integer_or("population", 12, several ? 8 : 5, 1000);
  if (several && search.population % 4 != 0)
    file.child("population").fail(std::to_string(search.population) + " must be a multiple of 4 for nsga2");
  search.designs = file.integer_or("designs", 200, search.population, kMostTasks);
  search.seed = file.integer_or("seed", 1, 1, 1000000);
}

}  // namespace

SearchSettings read_search(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  SearchSettings search;
  search.robot = read_scene_path(file, "robot");
  search.objectives = read_objectives(file);
  search.assessment = read_assessment(file, search.objectives);
  read_method(file, search);
  search.castable = file.boolean_or("castable", true);
  search.time_limit_s = file.number_or("time_limit_s", search.time_limit_s, {0.0, 1.0e6, true, false});
  search.parameters = read_study_parameters(file, SamplingMethod::latin_hypercube, load_settings(search.robot));
  for (const StudyParameter& parameter : search.parameters)
    if (!parameter.values.empty() || parameter.distribution != Distribution::even)
      file.child("parameters").child(parameter.name).fail("must be a range here");
  file.require_all_read();
  return search;
}

StudySettings study_of(const SearchSettings& search, const std::string& program,
                       const std::vector<std::string>& arguments) {
  StudySettings study;
  study.program = program;
  study.scene = search.robot;
  study.parameters = search.parameters;
  study.method = SamplingMethod::latin_hypercube;
  study.samples = search.population;
  study.seed = search.seed;
  study.time_limit_s = search.time_limit_s;
  study.arguments = arguments;
  return study;
}

}  // namespace soft_robot_lab
