// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <sstream>

#include "fidelity.h"
#include "fidelity_json.h"

namespace soft_robot_lab {
namespace {

std::string millimetres(double metres) {
  std::ostringstream text;
  text.precision(3);
  text << 1e3 * metres << " mm";
  return text.str();
}

// As it would stand in a scene.
std::string text_of(const FidelityChoice& choice) {
  std::ostringstream text;
  text << "body: {element: quadratic";
  if (choice.element_size_m) text << ", element_size_m: " << *choice.element_size_m;
  text << "}\nsolver: {method: " << (choice.reduced ? "reduced" : "newton");
  text.precision(17);
  if (choice.reduced) text << ", tolerance_m: " << choice.reduced->tolerance_m;
  if (choice.in_time)
    text << ", integrator: " << name_of(choice.in_time->integrator) << ", time_step_s: " << choice.in_time->time_step_s;
  text << "}\n";
  if (choice.self_contact) text << "contact: {self: true}\n";
  return text.str();
}

std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : "; ") + item;
  return text;
}

Integrator integrator_of(const nlohmann::ordered_json& name) {
  for (const Integrator integrator : {Integrator::bdf2, Integrator::tr_bdf2})
    if (name == name_of(integrator)) return integrator;
  return Integrator::implicit_euler;
}

FidelityChoice choice_from_json(const nlohmann::ordered_json& json) {
  FidelityChoice choice;
  if (json.contains("element_size_m")) choice.element_size_m = json.at("element_size_m").get<double>();
  if (json.contains("integrator"))
    choice.in_time = {integrator_of(json.at("integrator")), json.at("time_step_s").get<double>()};
  if (json.contains("reduced"))
    choice.reduced = {json.at("reduced").at("tolerance_m").get<double>(), json.at("reduced").at("modes").get<int>(),
                      json.at("reduced").at("error_m").get<double>()};
  choice.self_contact = json.value("self_contact", false);
  return choice;
}

FidelityUse use_named(const nlohmann::ordered_json& name) {
  for (const FidelityUse use : {FidelityUse::motion, FidelityUse::search, FidelityUse::live})
    if (name == name_of(use)) return use;
  return FidelityUse::rest;
}

// Two digits will do for what is counted.
std::string rounded(double value) {
  std::ostringstream text;
  text.precision(2);
  if (std::abs(value) >= 10.0)
    text << std::lround(value);
  else
    text << value;
  return text.str();
}

std::string text_of(const PartEffect& effect) {
  if (!effect.trouble.empty()) return effect.part + " (" + effect.trouble + ")";
  std::string text = effect.part + ", " + millimetres(effect.moved_m);
  if (!effect.marker.empty()) text += " at " + effect.marker;
  return text;
}

std::string listed(const std::vector<PartEffect>& effects, bool may_go) {
  std::vector<std::string> texts;
  for (const PartEffect& effect : effects)
    if (effect.may_go == may_go) texts.push_back(text_of(effect));
  return listed(texts);
}

std::string method_text(const FidelityReport& report) {
  std::ostringstream text;
  if (report.choice && report.choice->reduced)
    text << "a reduced model of " << report.choice->reduced->modes << " modes";
  else
    text << "newton";
  text << " on " << report.nodes << " nodes";
  if (report.choice && report.choice->in_time)
    text << ", " << name_of(report.choice->in_time->integrator) << " by steps of "
         << rounded(1e3 * report.choice->in_time->time_step_s) << " ms";
  if (report.choice && report.choice->self_contact) text << ", with contact of skin with skin";
  return text.str();
}

std::string why_text(const FidelityReport& report) {
  if (!report.choice) return "as the scene states";
  if (report.near_buckling) return "no mesh says to which side the body goes";
  const bool within = report.expected_error_m && *report.expected_error_m <= report.tolerance_m;
  const bool fast = report.real_time == 0.0 || report.expected_real_time >= report.real_time;
  if (within && fast) return "the coarsest that is within " + millimetres(report.tolerance_m);
  if (fast && report.real_time > 0.0)
    return "the most exact of those that are fast enough, as " + millimetres(report.tolerance_m) + " and " +
           rounded(report.real_time) + " times real time cannot both be had";
  if (report.real_time > 0.0) return "the fastest, as none comes to " + rounded(report.real_time) + " times real time";
  return "the most exact, as none is within " + millimetres(report.tolerance_m);
}

std::string cost_text(const FidelityReport& report) {
  std::string text = rounded(report.cost.rest_state_s) + " s of CPU a rest state";
  if (report.expected_real_time > 0.0) text += ", " + rounded(report.expected_real_time) + " times real time in motion";
  if (report.cost.rest_state_s > 0.0)
    text += "; judging cost " + rounded(report.cost.choosing_s / report.cost.rest_state_s) + " such rest states";
  return text;
}

nlohmann::ordered_json meshes_json(const std::vector<JudgedMesh>& meshes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const JudgedMesh& mesh : meshes) {
    nlohmann::ordered_json& item = list.emplace_back();
    item["nodes"] = mesh.nodes;
    item["expected_error_m"] = nullptr;
    if (mesh.expected_error_m) item["expected_error_m"] = *mesh.expected_error_m;
  }
  return list;
}

std::vector<JudgedMesh> meshes_from_json(const nlohmann::ordered_json& list) {
  std::vector<JudgedMesh> meshes;
  for (const nlohmann::ordered_json& item : list) {
    JudgedMesh& mesh = meshes.emplace_back();
    mesh.nodes = item.at("nodes").get<int>();
    if (!item.at("expected_error_m").is_null()) mesh.expected_error_m = item.at("expected_error_m").get<double>();
  }
  return meshes;
}

nlohmann::ordered_json parts_json(const std::vector<PartEffect>& parts) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PartEffect& effect : parts) {
    nlohmann::ordered_json& item = list.emplace_back();
    item["part"] = effect.part;
    if (effect.trouble.empty()) {
      item["moves_m"] = effect.moved_m;
      item["marker"] = effect.marker;
    } else {
      item["trouble"] = effect.trouble;
    }
    item["may_go"] = effect.may_go;
  }
  return list;
}

std::vector<PartEffect> parts_from_json(const nlohmann::ordered_json& list) {
  std::vector<PartEffect> parts;
  for (const nlohmann::ordered_json& item : list)
    parts.push_back({item.at("part").get<std::string>(), item.value("moves_m", 0.0), item.value("marker", ""),
                     item.at("may_go").get<bool>(), item.value("trouble", "")});
  return parts;
}

}  // namespace

std::string text_of(const NearBuckling& sign) {
  std::ostringstream text;
  text << "near buckling: the side to which the body goes is not known, as at rest state " << sign.rest_state << ", on "
       << sign.nodes << " nodes, ";
  if (sign.apart_m > 0.0)
    text << "markers rest " << millimetres(sign.apart_m) << " from where another mesh has them";
  else if (sign.snapped_m > 0.0)
    text << "the way became unstable and a node moved by " << millimetres(sign.snapped_m);
  else
    text << "little holds the markers: " << rounded(sign.stiffness) << " of their stiffness in the rest shape";
  text << "; run it in time, or with commands and loads a fifth lower, and say with a small load aside which side is "
          "meant";
  return text.str();
}

const char* name_of(Integrator integrator) {
  if (integrator == Integrator::bdf2) return "bdf2";
  return integrator == Integrator::tr_bdf2 ? "tr_bdf2" : "implicit_euler";
}

const char* name_of(FidelityUse use) {
  if (use == FidelityUse::motion) return "motion";
  if (use == FidelityUse::search) return "search";
  return use == FidelityUse::live ? "live" : "rest";
}

std::vector<std::string> left_out(const YamlNode& settings, bool dynamic) {
  std::vector<std::string> parts;
  const auto unless = [&](bool used, const char* part) {
    if (!used) parts.emplace_back(part);
  };
  const YamlNode scene = Overrides().over(settings);  // a copy: looking is not reading
  const std::optional<YamlNode> contact = scene.optional_child("contact");
  const bool touches =
      contact && (contact->boolean_or("self", false) || !contact->optional_sequence("obstacles").empty());
  unless(dynamic, "integration in time: the question is at rest");
  unless(touches, "contact");
  unless(!scene.optional_sequence("cables").empty(), "cables");
  unless(!scene.optional_sequence("chambers").empty(), "air chambers");
  unless(!scene.optional_sequence("loads").empty(), "loads on the surface");
  unless(scene.has("gravity_m_s2"), "gravity");
  return parts;
}

std::string expected_error_text(const FidelityReport& report) {
  if (!report.expected_error_m) return "unknown: " + report.trouble;
  std::string text = millimetres(*report.expected_error_m);
  if (report.time_error_m > 0.0 || report.reduced_error_m > 0.0) {
    text += " (mesh " + millimetres(report.mesh_error_m);
    if (report.time_error_m > 0.0) text += ", time step " + millimetres(report.time_error_m);
    if (report.reduced_error_m > 0.0) text += ", reduced model " + millimetres(report.reduced_error_m);
    text += ")";
  }
  if (report.tolerance_m > 0.0)
    text +=
        (*report.expected_error_m <= report.tolerance_m ? ", within the tolerance of " : ", beyond the tolerance of ") +
        millimetres(report.tolerance_m);
  if (report.left_out_contact_m > 0.0)
    text += "; and " + millimetres(report.left_out_contact_m) + " by contact of skin with skin, which is left out";
  return text;
}

std::string sentence(const FidelityReport& report) {
  std::string text = method_text(report) + ": " + why_text(report) + "; expected error of the markers " +
                     (report.expected_error_m ? millimetres(*report.expected_error_m) : "unknown") + "; " +
                     cost_text(report);
  if (report.near_buckling) text += "; " + text_of(*report.near_buckling);
  if (report.left_out_contact_m > 0.0)
    text += "; left out: contact of skin with skin, " + millimetres(report.left_out_contact_m);
  const std::string needless = listed(report.parts, true);
  if (!needless.empty()) text += "; not needed: " + needless;
  return text;
}

std::string summary(const FidelityReport& report) {
  std::ostringstream text;
  text << "expected error of the markers: " << expected_error_text(report) << "; " << report.nodes << " nodes, judged "
       << (report.from_cache ? "before" : "now") << " in " << report.cpu_s << " s\n";
  text << "fidelity: " << sentence(report) << "\n";
  if (report.choice) text << "chosen:\n" << text_of(*report.choice) << "because: " << listed(report.reasons) << "\n";
  if (const std::string needed = listed(report.parts, false); !needed.empty()) text << "parts: " << needed << "\n";
  return text.str();
}

nlohmann::ordered_json fidelity_json(const FidelityReport& report) {
  nlohmann::ordered_json json;
  if (report.tolerance_m > 0.0) {
    json["tolerance_m"] = report.tolerance_m;
    json["met"] = report.met;
    json["choice"] = report.choice ? text_of(*report.choice) : "";
    json["reasons"] = report.reasons;
  }
  json["use"] = name_of(report.use);
  json["sentence"] = sentence(report);
  json["nodes"] = report.nodes;
  json["expected_error_m"] = nullptr;
  if (report.expected_error_m) {
    json["expected_error_m"] = *report.expected_error_m;
    json["mesh_error_m"] = report.mesh_error_m;
    json["time_error_m"] = report.time_error_m;
    if (report.reduced_error_m > 0.0) json["reduced_error_m"] = report.reduced_error_m;
  } else {
    json["trouble"] = report.trouble;
  }
  json["rest_state_cpu_s"] = report.cost.rest_state_s;
  json["judging_cpu_s"] = report.cost.choosing_s;
  if (report.expected_real_time > 0.0) {
    json["second_cpu_s"] = report.cost.per_second_s;
    json["expected_real_time"] = report.expected_real_time;
  }
  if (report.real_time > 0.0) json["real_time"] = report.real_time;
  if (const auto& sign = report.near_buckling) {
    json["near_buckling"] = {{"rest_state", sign->rest_state}, {"nodes", sign->nodes}};
    if (sign->apart_m > 0.0) json["near_buckling"]["apart_m"] = sign->apart_m;
    if (sign->snapped_m > 0.0) json["near_buckling"]["snapped_m"] = sign->snapped_m;
    if (sign->stiffness < 1.0) json["near_buckling"]["stiffness"] = sign->stiffness;
  }
  if (!report.meshes.empty()) json["meshes"] = meshes_json(report.meshes);
  json["parts"] = parts_json(report.parts);
  json["left_out"] = report.left_out;
  if (report.left_out_contact_m > 0.0) json["left_out_contact_m"] = report.left_out_contact_m;
  return json;
}

nlohmann::ordered_json kept_json(const FidelityReport& report) {
  nlohmann::ordered_json json = fidelity_json(report);
  json["cpu_s"] = report.cpu_s;
  if (!report.choice) return json;
  nlohmann::ordered_json& chosen = json["chosen"];
  chosen = nlohmann::ordered_json::object();
  if (report.choice->element_size_m) chosen["element_size_m"] = *report.choice->element_size_m;
  if (const auto& in_time = report.choice->in_time) {
    chosen["integrator"] = name_of(in_time->integrator);
    chosen["time_step_s"] = in_time->time_step_s;
  }
  if (const auto& reduced = report.choice->reduced)
    chosen["reduced"] = {
        {"tolerance_m", reduced->tolerance_m}, {"modes", reduced->modes}, {"error_m", reduced->error_m}};
  if (report.choice->self_contact) chosen["self_contact"] = true;
  return json;
}

FidelityReport fidelity_from_json(const nlohmann::ordered_json& json) {
  FidelityReport report;
  if (json.contains("tolerance_m")) {
    json.at("tolerance_m").get_to(report.tolerance_m);
    json.at("met").get_to(report.met);
    report.choice = choice_from_json(json.at("chosen"));
    json.at("reasons").get_to(report.reasons);
  }
  json.at("nodes").get_to(report.nodes);
  if (json.at("expected_error_m").is_null()) {
    json.at("trouble").get_to(report.trouble);
  } else {
    report.expected_error_m = json.at("expected_error_m").get<double>();
    json.at("mesh_error_m").get_to(report.mesh_error_m);
    json.at("time_error_m").get_to(report.time_error_m);
    report.reduced_error_m = json.value("reduced_error_m", 0.0);
  }
  report.use = use_named(json.at("use"));
  report.cost = {json.at("rest_state_cpu_s").get<double>(), json.value("second_cpu_s", 0.0),
                 json.at("judging_cpu_s").get<double>()};
  report.expected_real_time = json.value("expected_real_time", 0.0);
  report.real_time = json.value("real_time", 0.0);
  if (json.contains("near_buckling")) {
    const auto& sign = json.at("near_buckling");
    report.near_buckling = {sign.at("rest_state").get<int>(), sign.at("nodes").get<int>(), sign.value("snapped_m", 0.0),
                            sign.value("apart_m", 0.0), sign.value("stiffness", 1.0)};
  }
  if (json.contains("meshes")) report.meshes = meshes_from_json(json.at("meshes"));
  report.parts = parts_from_json(json.at("parts"));
  json.at("left_out").get_to(report.left_out);
  report.left_out_contact_m = json.value("left_out_contact_m", 0.0);
  json.at("cpu_s").get_to(report.cpu_s);
  return report;
}

}  // namespace soft_robot_lab
