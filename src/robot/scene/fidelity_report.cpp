// SPDX-License-Identifier: BSD-3-Clause
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
  text << "}\nsolver: {method: newton";
  text.precision(17);
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
  choice.self_contact = json.value("self_contact", false);
  return choice;
}

}  // namespace

const char* name_of(Integrator integrator) {
  if (integrator == Integrator::bdf2) return "bdf2";
  return integrator == Integrator::tr_bdf2 ? "tr_bdf2" : "implicit_euler";
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
  if (report.time_error_m > 0.0)
    text += " (mesh " + millimetres(report.mesh_error_m) + ", time step " + millimetres(report.time_error_m) + ")";
  if (report.tolerance_m > 0.0)
    text +=
        (report.met ? ", within the tolerance of " : ", beyond the tolerance of ") + millimetres(report.tolerance_m);
  if (report.left_out_contact_m > 0.0)
    text += "; and " + millimetres(report.left_out_contact_m) + " by contact of skin with skin, which is left out";
  return text;
}

std::string summary(const FidelityReport& report) {
  std::ostringstream text;
  text << "expected error of the markers: " << expected_error_text(report) << "; " << report.nodes << " nodes, judged "
       << (report.from_cache ? "before" : "now") << " in " << report.cpu_s << " s\n";
  if (report.choice) text << "chosen:\n" << text_of(*report.choice) << "because: " << listed(report.reasons) << "\n";
  text << "left out: " << listed(report.left_out) << "\n";
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
  json["nodes"] = report.nodes;
  json["expected_error_m"] = nullptr;
  if (report.expected_error_m) {
    json["expected_error_m"] = *report.expected_error_m;
    json["mesh_error_m"] = report.mesh_error_m;
    json["time_error_m"] = report.time_error_m;
  } else {
    json["trouble"] = report.trouble;
  }
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
  }
  json.at("left_out").get_to(report.left_out);
  report.left_out_contact_m = json.value("left_out_contact_m", 0.0);
  json.at("cpu_s").get_to(report.cpu_s);
  return report;
}

}  // namespace soft_robot_lab
