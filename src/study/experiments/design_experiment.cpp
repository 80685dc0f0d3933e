// SPDX-License-Identifier: BSD-3-Clause
#include "design_experiment.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <thread>

#include "robot/casting/make_mould.h"
#include "study/search/assessment.h"
#include "study/search/design_report.h"

namespace soft_robot_lab {
namespace {

struct DesignSettings {
  std::string search, record;  // files
  AssessmentSettings assessment;
};

DesignSettings read_design_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("design_spinebot"));
  DesignSettings settings{
      context.config_folder + "/" + node.text("search"), context.config_folder + "/" + node.text("record"), {}};
  node.require_all_read();
  return settings;
}

// As the search assesses its designs.
AssessmentSettings assessment_of(const SearchSettings& search) {
  AssessmentSettings settings;
  for (std::size_t i = 0; i < search.assessment.size(); ++i) {
    if (search.assessment[i] == "--one-at-a-time") settings.one_at_a_time = true;
    if (search.assessment[i] == "--steps") settings.steps = std::stoi(search.assessment[i + 1]);
    if (search.assessment[i] == "--marker") settings.marker = search.assessment[i + 1];
    if (search.assessment[i] == "--max-tension") settings.max_tension_n = std::stod(search.assessment[i + 1]);
  }
  return settings;
}

nlohmann::ordered_json assess_file(const std::string& file, const ExperimentContext& context,
                                   const SearchSettings& search) {
  const Scene scene = load_scene(file, context.scene_options());
  return assess(file, *scene.simulation, assessment_of(search));
}

std::vector<Design> find_designs(const SearchSettings& search, const ExperimentContext& context) {
  Journal journal(context.output_folder);
  const int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  DesignEvaluator evaluator(search, journal, workers,
                            [&](std::size_t done) {
                              context.report(static_cast<double>(done) / search.designs,
                                             std::to_string(done) + " designs");
                              return true;
                            },
                            {});
  search_designs(search, evaluator);
  return evaluator.designs();
}

void make_mould_of(const std::string& file, const ExperimentContext& context) {
  const std::string folder = context.output_folder + "/mould";
  require_mould_folder(folder);
  write_mould(make_mould(load_cast_robot(file, context.scene_options())), std::filesystem::path(file).stem().string(),
              folder);
}

Table table_of(const SearchSettings& search, const Design& best, const nlohmann::ordered_json& record) {
  Table table{{{"number"}, {"robot of record", 4}, {"best design", 4}}, {}};
  for (const auto& [name, value] : best.result.items())
    if (value.is_number()) table.rows.push_back({name, record.at(name).get<double>(), value.get<double>()});
  for (std::size_t i = 0; i < best.values.size(); ++i)
    table.rows.push_back({search.parameters[i].name, "", best.values[i]});
  return table;
}

}  // namespace

ExperimentResult run_design_spinebot_experiment(const ExperimentContext& context) {
  const DesignSettings settings = read_design_settings(context);
  const SearchSettings search = read_search(settings.search);
  const nlohmann::ordered_json record = assess_file(settings.record, context, search);
  const std::vector<Design> designs = find_designs(search, context);
  const std::vector<std::size_t> front = pareto_front(designs);
  if (front.empty()) throw std::runtime_error("no design is castable and rests");
  write_search_report(search, designs, context.output_folder + "/designs", context.mesher);
  const Design& best = designs[front.front()];
  const std::string file = context.output_folder + "/designs/design_" + std::to_string(front.front() + 1) + ".yaml";
  make_mould_of(file, context);

  const double before_m = record.at("reach_m"), after_m = best.result.at("reach_m");
  const auto good = std::count_if(designs.begin(), designs.end(), [](const Design& one) { return one.good; });
  ExperimentResult result;
  result.title = "Spinebot: castable designs that reach farther";
  result.table = table_of(search, best, record);
  result.numbers = {{"designs", designs.size()},   {"good", good},
                    {"record_reach_m", before_m},  {"best_reach_m", after_m},
                    {"ratio", after_m / before_m}, {"best_design", front.front() + 1}};
  std::ostringstream words;
  words.precision(3);
  words << "Of " << designs.size() << " designs " << good << " can be cast. The best one's tip comes " << 1e3 * after_m
        << " mm from where it hangs, the robot of record's " << 1e3 * before_m << " mm. Its mould is in mould.";
  result.we_find = words.str();
  return result;
}

}  // namespace soft_robot_lab
