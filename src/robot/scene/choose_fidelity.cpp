// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <sstream>

#include <Eigen/Geometry>

#include "fidelity.h"
#include "robot/design/content_hash.h"
#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

// Part of every key of the cache: raise it when another choice or estimate would be made of the same scene.
constexpr const char* kFidelityVersion = "soft_robot_lab fidelity 3";
constexpr double kOutlineSize_m = 10.0;  // larger than any robot: a mesh as coarse as the solid allows
constexpr double kExpectedOrder = 1.5;   // of the mesh error, to guess the next size; a wrong guess costs a rung
constexpr double kLeastShrinking = 0.8;  // of the size, from rung to rung
constexpr double kMostShrinking = 0.5;
constexpr double kWorthTrying = 1.15;  // more nodes than the rung before: small features may rule the mesh
constexpr double kShareOfTime = 0.5;   // of the tolerance, in a dynamic run

// Whatever solver a scene names: all of them find the same rest states and motions, this one soonest.
Overrides newton() { return Overrides().set({"solver", "method"}, "newton"); }

YamlNode outline_of(const YamlNode& settings) {
  return overrides_of(FidelityChoice{kOutlineSize_m, {}}).over(settings);
}

// The number that three digits say: a quotient of whole numbers.
double three_digits(double value) {
  const double digits = 2.0 - std::floor(std::log10(value));
  return digits >= 0.0 ? std::round(value * std::pow(10.0, digits)) / std::pow(10.0, digits)
                       : std::round(value / std::pow(10.0, -digits)) * std::pow(10.0, -digits);
}

// About two thicknesses: 4 volume / surface is the side of a long bar.
double coarsest_size_m(const TetMesh& outline) {
  double surface_m2 = 0.0;
  TetMesh whole = outline;
  complete_boundary(whole);
  const auto corner = [&](Eigen::Index face, int i) -> Eigen::Vector3d {
    return whole.nodes_m.col(whole.faces(i, face));
  };
  for (Eigen::Index f = 0; f < whole.faces.cols(); ++f)
    surface_m2 += 0.5 * (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)).norm();
  return three_digits(8.0 * volume(whole) / surface_m2);
}

void show_progress(const SceneOptions& options, double fraction, const std::string& what) {
  if (options.progress) options.progress(fraction, "fidelity: " + what);
}

std::string judging(const TetMesh& mesh) { return "judges a mesh of " + std::to_string(mesh.node_count()) + " nodes"; }

struct Rung {
  FidelityChoice choice;
  TetMesh mesh;
  MeshError error;
};

// Walks from coarse to fine. A rung on which the scene cannot be built (a load's box without a whole face) is passed
// over; where none can be built, the last complaint is thrown.
class Ladder {
 public:
  Ladder(const YamlNode& settings, const FidelityRequest& request, const SceneOptions& options)
      : settings_(settings), request_(request), options_(options), given_(settings.child("body").has("mesh")) {
    if (!given_) size_m_ = coarsest_size_m(read_mesh(outline_of(settings), options));
  }

  // The next finer rung, judged; none beyond the limit on nodes.
  std::optional<Rung> next() {
    while (!done_) {
      Rung rung;
      if (!given_) rung.choice.element_size_m = size_m_;
      const YamlNode scene = overrides_of(rung.choice).over(settings_);
      rung.mesh = read_mesh(scene, options_);
      shrink(kLeastShrinking);
      done_ = given_ || rung.mesh.node_count() > request_.max_nodes;
      if (rung.mesh.node_count() > request_.max_nodes) return beyond_limit(std::move(rung));
      if (rung.mesh.node_count() < kWorthTrying * last_nodes_) continue;
      last_nodes_ = rung.mesh.node_count();
      show_progress(options_, static_cast<double>(last_nodes_) / request_.max_nodes, judging(rung.mesh));
      if (!judged(scene, rung)) continue;
      read_for_others(scene);
      scene.require_all_read();
      return rung;
    }
    if (count_ == 0 && complaint_) std::rethrow_exception(complaint_);
    return std::nullopt;
  }

  void aim(double error_m, double tolerance_m) {  // after a rung whose size was shrunk once already
    const double factor = std::pow(tolerance_m / error_m, 1.0 / kExpectedOrder);
    shrink(std::clamp(factor, kMostShrinking, kLeastShrinking) / kLeastShrinking);
  }

  int count() const { return count_; }

 private:
  bool judged(const YamlNode& scene, Rung& rung) {
    try {
      rung.error = estimate_mesh_error(scene, rung.mesh, options_);
    } catch (const std::invalid_argument&) {
      complaint_ = std::current_exception();
      return false;
    }
    ++count_;
    return true;
  }

  // Not judged, but all there is where it is the first.
  std::optional<Rung> beyond_limit(Rung rung) const {
    if (count_ > 0) return std::nullopt;
    if (complaint_) std::rethrow_exception(complaint_);
    rung.error.trouble =
        "the coarsest mesh has " + std::to_string(rung.mesh.node_count()) + " nodes, more than max_nodes";
    return rung;
  }

  void shrink(double factor) { size_m_ = three_digits(size_m_ * factor); }

  const YamlNode& settings_;
  const FidelityRequest& request_;
  const SceneOptions& options_;
  const bool given_;  // the mesh: it is the only rung
  double size_m_ = 0.0;
  int last_nodes_ = 0, count_ = 0;
  bool done_ = false;
  std::exception_ptr complaint_;
};

void take(const Rung& rung, const TimeError& time, FidelityReport& report) {
  report.nodes = rung.mesh.node_count();
  report.choice = rung.choice;
  report.choice->in_time = time.choice;
  report.trouble = rung.error.expected_m ? time.trouble : rung.error.trouble;
  if (!report.trouble.empty()) return;
  report.mesh_error_m = *rung.error.expected_m * time.amplification;
  report.time_error_m = time.error_m;
  report.expected_error_m = report.mesh_error_m + report.time_error_m;
}

void explain(const Ladder& ladder, bool dynamic, const FidelityRequest& request, FidelityReport& report) {
  report.reasons = {"element: quadratic, as linear ones need far more nodes for the same error",
                    "mesh: " + std::to_string(report.nodes) + " nodes; " + std::to_string(ladder.count()) +
                        " meshes judged, of at most " + std::to_string(request.max_nodes) + " nodes",
                    "method: newton, the fastest on meshes of this size",
                    dynamic ? "integrator and time step: judged over the run's first seconds"
                            : "integrator and time step: not chosen, as the question is at rest"};
}

FidelityReport choose(const YamlNode& settings, const FidelityRequest& request, bool dynamic,
                      const SceneOptions& options) {
  FidelityReport report;
  report.tolerance_m = request.tolerance_m;
  report.met = false;
  std::optional<TimeError> time;
  Ladder ladder(settings, request, options);
  while (const std::optional<Rung> rung = ladder.next()) {
    const bool known = rung->error.expected_m.has_value();
    if (known && !time && dynamic) show_progress(options, 0.0, "judges time steps");
    // The error of a time step hardly depends on the mesh, so that the coarsest will do.
    if (known && !time)
      time = !dynamic ? TimeError{}
                      : choose_time_step(overrides_of(rung->choice).over(settings), rung->mesh, options,
                                         kShareOfTime * request.tolerance_m);
    const TimeError in_time = time.value_or(TimeError{});
    const double error_m = known ? *rung->error.expected_m * in_time.amplification + in_time.error_m : 0.0;
    if (!report.expected_error_m || (known && error_m < *report.expected_error_m)) take(*rung, in_time, report);
    if (!known && report.expected_error_m)
      break;  // beyond what the scene allows, such as a plug that sinks in for ever
    if (!known) continue;
    report.met = error_m <= request.tolerance_m && in_time.trouble.empty();
    if (report.met || !in_time.trouble.empty() || in_time.error_m > request.tolerance_m) break;
    ladder.aim(error_m, request.tolerance_m);
  }
  explain(ladder, dynamic, request, report);
  return report;
}

FidelityReport judge(const YamlNode& settings, bool dynamic, const SceneOptions& options) {
  FidelityReport report;
  const TetMesh mesh = read_mesh(settings, options);
  show_progress(options, 0.0, judging(mesh));
  const MeshError error = estimate_mesh_error(settings, mesh, options);
  const bool moves = dynamic && error.expected_m;
  if (moves) show_progress(options, 0.5, "judges time steps");
  take({{}, mesh, error}, moves ? estimate_time_error(settings, mesh, options) : TimeError{}, report);
  report.choice.reset();
  report.left_out_contact_m = contact_effect(settings, options).moved_m;
  return report;
}

std::string content_key(const YamlNode& settings, const std::string& mesh_file) {
  ContentHash hash;
  hash.add(kFidelityVersion);
  hash.add(Overrides().over(settings).dump());                     // of a copy: dumping counts as reading
  hash.add(std::filesystem::path(mesh_file).filename().string());  // a hash of the files that the solid names
  return hash.hex();
}

bool refuses_self_contact(const YamlNode& settings) {
  const std::optional<YamlNode> contact = settings.optional_child("contact");
  return contact && contact->has("self");
}

// Switched on where, without it, a marker would be off by more than the tolerance; else its size is stated. The mesh
// was judged without it: with it the judgement of Spinebot at 1 mm took 390 s, not 2 s.
void weigh_contact(const YamlNode& settings, const FidelityRequest& request, const SceneOptions& options,
                   FidelityReport& report) {
  if (!report.choice) return;
  const ContactEffect effect = contact_effect(overrides_of(*report.choice).over(settings), options);
  if (effect.moved_m > request.tolerance_m && !refuses_self_contact(settings)) {
    report.choice->self_contact = true;
    std::ostringstream reason;
    reason << "contact of skin with skin: without it marker " << effect.marker << " would be " << 1e3 * effect.moved_m
           << " mm off; the mesh was judged without it";
    report.reasons.push_back(reason.str());
    return;
  }
  report.left_out_contact_m = effect.moved_m;
  report.met = report.met && effect.moved_m <= request.tolerance_m;
}

bool asks_for_motion(const YamlNode& settings, const YamlNode& place) {
  const std::optional<YamlNode> run = settings.optional_child("run");
  const std::string mode = run ? run->text_or("mode", "equilibrium") : "equilibrium";
  if (mode == "modal") place.fail("a modal run moves no marker; there is no error to estimate");
  if (settings.optional_sequence("markers").empty())
    place.fail("an error is that of the markers; the scene needs at least one");
  return mode == "dynamic";
}

}  // namespace

Overrides overrides_of(const TimeStepChoice& choice) {
  return Overrides()
      .set({"solver", "integrator"}, name_of(choice.integrator))
      .set({"solver", "time_step_s"}, choice.time_step_s);
}

Overrides overrides_of(const FidelityChoice& choice) {
  Overrides overrides = newton().set({"body", "element"}, "quadratic");
  if (choice.element_size_m) overrides.set({"body", "element_size_m"}, *choice.element_size_m);
  if (choice.in_time) overrides.lay(overrides_of(*choice.in_time));
  if (choice.self_contact) overrides.lay(self_contact());
  return overrides;
}

std::optional<FidelityReport> settle_fidelity(const YamlNode& settings, const SceneOptions& options) {
  const std::optional<FidelityRequest> request = read_fidelity(settings);
  if (!request && !options.estimate_error) return std::nullopt;
  const bool dynamic = asks_for_motion(settings, request ? settings.child("fidelity") : settings);
  const YamlNode outline = request ? outline_of(settings) : settings;
  const std::string key = content_key(settings, mesh_file(outline, mesher_options(options)));
  const bool kept = !options.change_mesh;  // which the key does not know
  if (std::optional<FidelityReport> known; kept && (known = find_fidelity(key, options))) return known;

  const double start_s = cpu_time_s();
  const YamlNode judged = newton().over(settings);
  FidelityReport report = request ? choose(judged, *request, dynamic, options) : judge(judged, dynamic, options);
  if (request) weigh_contact(judged, *request, options, report);
  const bool touches = report.choice && report.choice->self_contact;
  report.left_out = left_out(touches ? self_contact().over(settings) : settings, dynamic);
  report.cpu_s = cpu_time_s() - start_s;
  if (kept) keep_fidelity(key, report, options);
  return report;
}

}  // namespace soft_robot_lab
