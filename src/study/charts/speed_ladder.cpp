// SPDX-License-Identifier: BSD-3-Clause
#include "speed_ladder.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "settings/reference_table.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

std::vector<double> numbers(const YamlNode& node, const std::string& key) {
  std::vector<double> values;
  for (const YamlNode& item : node.sequence(key)) values.push_back(item.as_number(AllowedRange::positive()));
  if (values.empty()) node.fail(key + " is empty");
  return values;
}

// One table in which a problem's displacements may be found.
struct Source {
  std::vector<ReferenceRow> rows;  // those that `where` lets through
  std::string x, y;
};

Source read_source(const ExperimentContext& context, const YamlNode& node) {
  Source source{{}, node.text("x"), node.text("y")};
  const YamlNode where = node.child("where");
  std::vector<std::pair<std::string, std::string>> conditions;
  for (const std::string& column : where.keys()) conditions.emplace_back(column, where.text(column));
  for (const ReferenceRow& row : read_reference(context.config_folder + "/reference", node.text("table"))) {
    const bool fits = std::all_of(conditions.begin(), conditions.end(),
                                  [&](const auto& condition) { return row.text(condition.first) == condition.second; });
    if (fits) source.rows.push_back(row);
  }
  return source;
}

Eigen::Vector3d find_reference(const std::vector<Source>& sources, const SpeedProblem& problem, const std::string& nu) {
  for (const Source& source : sources) {
    for (const ReferenceRow& row : source.rows) {
      if (row.text("nu") == nu) return {row.number(source.x), row.number(source.y), 0.0};
    }
  }
  throw std::runtime_error("no reference for " + problem.name + " at Poisson's ratio " + nu);
}

// The points of a problem, in the order of the table, and where they move; the first is that of the reference.
void read_curves(const ExperimentContext& context, const std::string& table, SpeedProblem& problem) {
  const std::vector<ReferenceRow> rows = read_reference(context.config_folder + "/reference", table);
  for (const std::string& nu : problem.poissons_ratios) {
    std::vector<double> points, moved;
    for (const ReferenceRow& row : rows) {
      if (row.text("problem") != problem.name || row.text("nu") != nu) continue;
      points.insert(points.end(), {row.number("x_m"), row.number("y_m"), row.number("z_m")});
      moved.insert(moved.end(), {row.number("ux_m"), row.number("uy_m"), row.number("uz_m")});
    }
    if (points.empty()) throw std::runtime_error("no curve in " + table + " for " + problem.name + " at " + nu);
    problem.points_m = Eigen::Map<Eigen::Matrix3Xd>(points.data(), 3, static_cast<Eigen::Index>(points.size() / 3));
    problem.curves_m.emplace_back(Eigen::Map<Eigen::Matrix3Xd>(moved.data(), 3, problem.points_m.cols()));
  }
}

SpeedProblem read_problem(const ExperimentContext& context, const YamlNode& node) {
  SpeedProblem problem;
  problem.name = node.text("name");
  problem.title = node.text("title");
  problem.scene = context.config_folder + "/" + node.text("scene");
  problem.size_m = node.number("size_m", AllowedRange::positive());
  problem.duration_s = node.number("duration_s", AllowedRange::positive());
  std::vector<Source> sources;
  for (const YamlNode& item : node.sequence("references")) sources.push_back(read_source(context, item));
  for (const YamlNode& nu : node.sequence("poissons_ratios")) {
    problem.poissons_ratios.push_back(nu.as_text());
    problem.references_m.push_back(find_reference(sources, problem, problem.poissons_ratios.back()));
  }
  read_curves(context, node.text("curves"), problem);
  return problem;
}

// At one of its Poisson's ratios.
SpeedProblem only(const SpeedProblem& problem, std::size_t ratio) {
  SpeedProblem part = problem;
  part.poissons_ratios = {problem.poissons_ratios[ratio]};
  part.references_m = {problem.references_m[ratio]};
  part.curves_m = {problem.curves_m[ratio]};
  return part;
}

SpeedRung read_rung(const YamlNode& node, bool bullet) {
  SpeedRung rung;
  rung.name = node.text("name");
  rung.bullet = bullet;
  if (const auto overrides = node.optional_child(bullet ? "settings" : "overrides"))
    rung.overrides = Overrides(*overrides);
  rung.sizes = numbers(node, "sizes");
  rung.quick = node.boolean_or("quick", true);
  for (const YamlNode& problem : node.optional_sequence("problems")) rung.problems.push_back(problem.as_text());
  if (bullet) rung.equilibrium = false;
  if (!bullet && node.has("modes")) {
    rung.settled = rung.equilibrium = false;
    for (const YamlNode& mode : node.sequence("modes")) {
      const std::string name = mode.as_text();
      if (name != "settled" && name != "equilibrium") mode.fail("'" + name + "' is not one of settled, equilibrium");
      (name == "settled" ? rung.settled : rung.equilibrium) = true;
    }
  }
  return rung;
}

NodeCosts read_nodes(const YamlNode& node, const std::vector<SpeedProblem>& problems) {
  NodeCosts costs;
  const std::string name = node.text("problem"), ratio = node.text("poissons_ratio");
  for (const SpeedProblem& problem : problems) {
    const auto& ratios = problem.poissons_ratios;
    const auto place = std::find(ratios.begin(), ratios.end(), ratio) - ratios.begin();
    if (problem.name != name || place == static_cast<std::ptrdiff_t>(ratios.size())) continue;
    costs.problem = only(problem, static_cast<std::size_t>(place));
  }
  if (costs.problem.name.empty()) node.fail("no problem '" + name + "' at a Poisson's ratio of " + ratio);
  costs.problem.duration_s = node.number("duration_s", AllowedRange::positive());
  costs.stop_after_cpu_s = node.number("stop_after_cpu_s", AllowedRange::positive());
  costs.from_nodes = node.integer("from_nodes", 1, 1000000);
  for (const YamlNode& item : node.sequence("ladder")) costs.rungs.push_back(read_rung(item, false));
  for (const YamlNode& item : node.sequence("bullet")) costs.rungs.push_back(read_rung(item, true));
  return costs;
}

ReleaseProblem read_release(const ExperimentContext& context, const YamlNode& node) {
  ReleaseProblem release;
  release.scene = context.config_folder + "/" + node.text("scene");
  release.duration_s = node.number("duration_s", AllowedRange::positive());
  release.element_size_m = node.number("element_size_m", AllowedRange::positive());
  for (const YamlNode& item : node.sequence("ladder"))
    release.rungs.push_back({item.text("name"), item.text("integrator"), numbers(item, "steps_s")});
  return release;
}

}  // namespace

SpeedLadder read_speed_ladder(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("speed_accuracy"));
  SpeedLadder ladder;
  const YamlNode settled = node.child("settled");
  ladder.time_step_s = settled.number("time_step_s", AllowedRange::positive());
  ladder.judged_s = settled.number("judged_s", AllowedRange::positive());
  ladder.stop_after_cpu_s = node.number("stop_after_cpu_s", AllowedRange::positive());
  for (const YamlNode& item : node.sequence("problems")) ladder.problems.push_back(read_problem(context, item));
  for (const YamlNode& item : node.sequence("ladder")) ladder.rungs.push_back(read_rung(item, false));
  for (const YamlNode& item : node.sequence("bullet")) ladder.rungs.push_back(read_rung(item, true));
  ladder.release = read_release(context, node.child("release"));
  for (const YamlNode& item : node.sequence("elsewhere")) {
    ElsewherePoint point{
        item.text("name"), item.text("nu"), {}, item.number("error_percent", AllowedRange::positive())};
    if (item.has("cost")) point.cost = item.number("cost", AllowedRange::positive());
    ladder.elsewhere.push_back(point);
  }
  ladder.nodes = read_nodes(node.child("nodes"), ladder.problems);
  ladder.motion = read_motion(context, node.child("motion"), ladder.time_step_s);
  ladder.rollouts = read_rollouts(context, node.child("rollouts"));
  ladder.published = read_published(node.sequence("published"));
  node.require_all_read();
  return ladder;
}

namespace {

SpeedLadder choose_named(SpeedLadder ladder, const std::vector<std::string>& names) {
  if (names.empty()) return ladder;
  std::vector<SpeedProblem> chosen;
  std::string known;
  for (const SpeedProblem& problem : ladder.problems) {
    known += (known.empty() ? "" : ", ") + problem.name;
    if (std::count(names.begin(), names.end(), problem.name)) chosen.push_back(problem);
  }
  for (const std::string& name : names) {
    const bool found = std::any_of(chosen.begin(), chosen.end(), [&](const auto& one) { return one.name == name; });
    if (!found) throw std::invalid_argument("unknown problem '" + name + "'; known: " + known);
  }
  ladder.problems = std::move(chosen);
  return ladder;
}

}  // namespace

SpeedLadder choose_problems(SpeedLadder ladder, const std::vector<std::string>& names,
                            const std::vector<std::string>& poissons_ratios) {
  ladder = choose_named(std::move(ladder), names);
  if (poissons_ratios.empty()) return ladder;
  std::vector<SpeedProblem> left;
  for (const SpeedProblem& problem : ladder.problems) {
    SpeedProblem part = problem;
    part.poissons_ratios.clear();
    part.references_m.clear();
    part.curves_m.clear();
    for (std::size_t i = 0; i < problem.poissons_ratios.size(); ++i) {
      if (!std::count(poissons_ratios.begin(), poissons_ratios.end(), problem.poissons_ratios[i])) continue;
      part.poissons_ratios.push_back(problem.poissons_ratios[i]);
      part.references_m.push_back(problem.references_m[i]);
      part.curves_m.push_back(problem.curves_m[i]);
    }
    if (!part.poissons_ratios.empty()) left.push_back(part);
  }
  if (left.empty()) throw std::invalid_argument("no problem has such a Poisson's ratio");
  ladder.problems = std::move(left);
  return ladder;
}

SpeedLadder quick_part(SpeedLadder ladder) {
  SpeedProblem& first = ladder.problems.at(0);
  first.poissons_ratios = {first.poissons_ratios.front(), first.poissons_ratios.back()};
  first.references_m = {first.references_m.front(), first.references_m.back()};
  first.curves_m = {first.curves_m.front(), first.curves_m.back()};
  ladder.problems.resize(1);
  const auto shorten = [](std::vector<double>& values) { values.resize(std::min<std::size_t>(values.size(), 2)); };
  const auto slow = [](const SpeedRung& rung) { return !rung.quick; };
  ladder.rungs.erase(std::remove_if(ladder.rungs.begin(), ladder.rungs.end(), slow), ladder.rungs.end());
  for (SpeedRung& rung : ladder.rungs) shorten(rung.sizes);
  for (ReleaseRung& rung : ladder.release.rungs) shorten(rung.steps_s);
  ladder.stop_after_cpu_s = 1.0;
  ladder.release.element_size_m *= 2.0;
  ladder.nodes.rungs.erase(std::remove_if(ladder.nodes.rungs.begin(), ladder.nodes.rungs.end(), slow),
                           ladder.nodes.rungs.end());
  for (SpeedRung& rung : ladder.nodes.rungs) shorten(rung.sizes);
  ladder.motion = quick_part(std::move(ladder.motion));
  ladder.rollouts = quick_part(std::move(ladder.rollouts));
  return ladder;
}

}  // namespace soft_robot_lab
