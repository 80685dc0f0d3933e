// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <sstream>

#include "reduction.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

Json error_json(const ReducedError& e) {
  return {{"states", e.states}, {"unsolved", e.unsolved}, {"rms_m", e.rms_m}, {"max_m", e.max_m}};
}

Json commands_json(const ReducedModel& model) {
  Json all = Json::object();
  for (std::size_t i = 0; i < model.box.min.size(); ++i)
    all[model.full->actuators()[i]->name()] = {model.box.min[i], model.box.max[i]};
  return all;
}

}  // namespace

Json reduction_json(const SceneReduction& reduction, const RunReport& report) {
  const ReducedChoice& choice = reduction.choice;
  const ReducedModel& model = *choice.model;
  return {{"modes", model.energy.modes()},
          {"multipliers", model.energy.pressures()},
          {"points", model.energy.points().size()},
          {"tolerance_m", reduction.request.tolerance_m},
          {"commands", commands_json(model)},
          {"held_out", {{"equilibria", error_json(choice.equilibria)}, {"transient", error_json(choice.transient)}}},
          {"training",
           {{"snapshots", model.snapshots},
            {"failed_solves", model.failed_solves},
            {"cpu_s", choice.cpu_s},
            {"from_cache", reduction.from_cache}}},
          {"audits",
           {{"states", report.audits.states},
            {"largest_estimate_m", report.audits.largest_estimate_m},
            {"limit_m", report.audits.limit_m},
            {"failed", report.audits.failed}}},
          {"left", report.left_reduced}};
}

std::string summary(const SceneReduction& reduction, const RunReport& report) {
  const ReducedChoice& choice = reduction.choice;
  std::ostringstream text;
  text << "reduced model of " << choice.model->energy.modes() << " modes and " << choice.model->energy.points().size()
       << " points, " << 1e3 * choice.largest_rms_m() << " mm rms and "
       << 1e3 * std::max(choice.equilibria.max_m, choice.transient.max_m)
       << " mm at most from newton where it was not trained; " << (reduction.from_cache ? "trained before" : "trained")
       << " in " << choice.cpu_s << " CPU-s" << (report.left_reduced ? "; newton took over" : "")
       << "; audits estimate " << 1e3 * report.audits.largest_estimate_m << " mm at most\n";
  return text.str();
}

}  // namespace soft_robot_lab
