// SPDX-License-Identifier: BSD-3-Clause
#include "fault_experiment.h"

#include <sstream>

#include "fault_run.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct FaultSettings {
  std::string rig;
  FaultRunOptions options;
};

FaultSettings read_fault_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("rig_faults"));
  FaultSettings settings;
  FaultRunOptions& options = settings.options;
  settings.rig = context.config_folder + "/" + node.text("rig");
  options.commands = node.integer("commands", 1, 10000000);
  options.corrupted = node.number("corrupted", {0.0, 1.0});
  options.lost = node.number("lost", {0.0, 1.0});
  options.doubled = node.number("doubled", {0.0, 1.0});
  options.unplugs = node.integer("unplugs", 0, 10000);
  options.resets = node.integer("resets", 0, 10000);
  options.brown_outs = node.integer("brown_outs", 0, 10000);
  options.seed = static_cast<std::uint64_t>(node.integer("seed", 1, 1000000));
  node.require_all_read();
  return settings;
}

Plot draw(const std::string& title, const FaultRunResult& found) {
  Plot plot{"rig_faults", title, {"what became of the commands"}, {"commands"}, {}};
  const std::vector<std::pair<std::string, std::int64_t>> ends = {{"acknowledged", found.acknowledged},
                                                                  {"superseded", found.superseded},
                                                                  {"refused", found.refused},
                                                                  {"unaccounted", found.unaccounted}};
  Series series{"", {}, {}, SeriesStyle::bars};
  for (const auto& [name, count] : ends) {
    const auto place = static_cast<double>(series.x.size());
    plot.x.ticks.emplace_back(place, name);
    series.x.push_back(place);
    series.y.push_back(static_cast<double>(count));
    series.point_labels.push_back(std::to_string(count));
  }
  plot.y.min = 0.0;
  plot.x.min = -0.5;
  plot.x.max = 3.5;
  plot.series.push_back(series);
  return plot;
}

}  // namespace

ExperimentResult run_fault_experiment(const ExperimentContext& context) {
  FaultSettings settings = read_fault_settings(context);
  settings.options.progress = [&](double fraction) { context.report(fraction, "commands"); };
  const FaultRunResult found = run_with_faults(load_rig(settings.rig), settings.options);

  ExperimentResult result;
  result.title = std::to_string(found.commands) + " random commands over a bad line";
  result.table.columns = {{"count of"}, {"number", 9}};
  const std::vector<std::pair<std::string, std::int64_t>> rows = {
      {"commands", found.commands},
      {"commands acknowledged", found.acknowledged},
      {"commands superseded by newer ones", found.superseded},
      {"commands refused", found.refused},
      {"commands unaccounted for", found.unaccounted},
      {"bytes corrupted", found.corrupted},
      {"bytes lost", found.lost},
      {"bytes doubled", found.doubled},
      {"times unplugged", found.unplugs},
      {"resets of the board", found.resets},
      {"power cuts", found.brown_outs},
      {"positions compared with the shaft, at rest", found.checks},
      {"positions wrong and not declared so", found.wrong_unflagged},
      {"positions declared unknown", found.unknown_declared},
      {"motions that did not end", found.stuck}};
  for (const auto& [name, count] : rows) result.table.rows.push_back({name, static_cast<double>(count)});
  result.plots.push_back(draw(result.title, found));
  result.numbers = {{"commands", found.commands},
                    {"acknowledged", found.acknowledged},
                    {"superseded", found.superseded},
                    {"refused", found.refused},
                    {"corrupted", found.corrupted},
                    {"lost", found.lost},
                    {"doubled", found.doubled},
                    {"unplugs", found.unplugs},
                    {"resets", found.resets},
                    {"brown_outs", found.brown_outs},
                    {"checks", found.checks},
                    {"wrong_unflagged", found.wrong_unflagged},
                    {"unknown_declared", found.unknown_declared},
                    {"unaccounted", found.unaccounted},
                    {"stuck", found.stuck}};
  result.converged = found.wrong_unflagged == 0 && found.unaccounted == 0 && found.stuck == 0;
  if (!result.converged) result.message = "a position was wrong, a command lost, or a motion did not end";
  std::ostringstream text;
  text << "in " << static_cast<int>(found.emulated_s)
       << " s of the rig's time the position was compared with the shaft " << found.checks << " times and was wrong "
       << found.wrong_unflagged << " times; " << found.unaccounted << " commands are unaccounted for.";
  result.we_find = text.str();
  return result;
}

}  // namespace soft_robot_lab
