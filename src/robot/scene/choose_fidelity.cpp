// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "fidelity.h"
#include "fidelity_ladder.h"
#include "reduced_fidelity.h"
#include "robot/design/content_hash.h"
#include "settings/cpu_time.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

// Part of every key of the cache: raise it when another choice or estimate would be made of the same scene.
constexpr const char* kFidelityVersion = "soft_robot_lab fidelity 13";
constexpr double kShareOfTime = 0.5;     // of the tolerance, in a dynamic run
constexpr double kSpeedMargin = 1.5;     // for what counted costs leave out
constexpr double kWorthTraining = 2.0;   // what newton takes for a run, over training
constexpr double kShareOfReduced = 0.2;  // of the tolerance, the largest distance of a reduced model from newton
constexpr double kRmsOfLargest = 0.25;   // of a reduced model's distances, what is usual
constexpr double kMayGo = 0.1;           // of the tolerance: a part that changes less is not needed
constexpr int kMostUnknown = 2;          // rungs without an estimate, after one with: finer ones will not do either

// Whatever solver a scene names: all of them find the same rest states and motions, this one soonest.
Overrides newton() { return Overrides().set({"solver", "method"}, "newton"); }

// Near buckling no error is stated: the markers may be on another side.
void note_buckling(const std::optional<NearBuckling>& judging, const JudgedRests& rests, FidelityReport& report) {
  report.near_buckling = snap_of(rests, report.nodes);
  if (judging) keep_worse(*judging, report.near_buckling);
  if (!report.near_buckling) return;
  report.trouble = text_of(*report.near_buckling);
  report.expected_error_m.reset();
  report.met = false;
}

// Looks at one rung after the other, and keeps the one to take.
class FidelityChooser {
 public:
  FidelityChooser(const YamlNode& stated, const FidelityRequest& request, Judgement& judgement)
      : stated_(stated), request_(request), judgement_(judgement), ladder_(request, judgement) {
    report_.tolerance_m = request.tolerance_m;
    report_.use = request.use;
    report_.met = false;
    if (request.use == FidelityUse::live) report_.real_time = request.real_time;
  }

  FidelityReport choose();
  const std::optional<Rung>& taken() const { return taken_; }
  // By which to say what parts change: a coarse mesh may not see them.
  const Rung& seeing() const {
    const std::optional<Rung>& judging = ladder_.judging();
    return judging && judging->mesh.node_count() > taken_->mesh.node_count() ? *judging : *taken_;
  }

 private:
  bool look_at(Rung rung);  // true: no further one will be better
  // No mesh says to which side the body goes: a finer one than that which judges would not either.
  bool hopeless() const { return ladder_.near_buckling() && ladder_.judging_nodes() <= looked_at_nodes_; }
  void judge_in_time(const Rung& first);
  double error_m(const Rung& rung) const { return *rung.error.expected_m * time_.amplification + time_.error_m; }
  double per_second_s(const Rung& rung) const {
    return time_.stretch_s > 0.0 ? rung.rests.solve.of(time_.counts) / time_.stretch_s : 0.0;
  }
  bool too_slow(double per_second_s) const {
    return request_.use == FidelityUse::live && per_second_s * kSpeedMargin * request_.real_time > 1.0;
  }
  bool may_reduce() const;
  bool worth_training(const Rung& rung) const;
  bool reduced(const Rung& rung);
  void take(Rung rung);
  void explain();

  const YamlNode& stated_;
  const FidelityRequest& request_;
  Judgement& judgement_;
  FidelityLadder ladder_;
  FidelityReport report_;
  TimeError time_;
  bool judged_in_time_ = false, took_slow_ = false;
  int unknown_ = 0, looked_at_nodes_ = 0;
  std::string not_reduced_, ranges_;
  std::optional<Rung> taken_;
};

// The error of a time step hardly depends on the mesh, so that a coarse one will do.
void FidelityChooser::judge_in_time(const Rung& first) {
  if (judged_in_time_ || !moves(request_.use)) return;
  judged_in_time_ = true;
  const Rung& rung = ladder_.judging() ? *ladder_.judging() : first;
  if (judgement_.options.progress) judgement_.options.progress(0.0, "fidelity: judges time steps");
  const TooDear too_dear = [&](const SolveReport& counts, double duration_s) {
    return too_slow(rung.rests.solve.of(counts) / duration_s);
  };
  time_ = choose_time_step(*rung.scene, rung.mesh, *rung.error.expected_m, kShareOfTime * request_.tolerance_m,
                           too_dear, judgement_);
}

bool FidelityChooser::may_reduce() const {
  return moves(request_.use) && not_reduced_.empty() && judgement_.options.reduced != ReducedUse::refused &&
         (!time_.choice || time_.choice->integrator == Integrator::implicit_euler);
}

// Where newton is fast enough, a run has to last before training pays.
bool FidelityChooser::worth_training(const Rung& rung) const {
  if (!may_reduce()) return false;
  if (request_.use == FidelityUse::live) return too_slow(per_second_s(rung));
  const std::optional<YamlNode> run = Overrides().over(stated_).optional_child("run");
  const double duration_s = run && run->has("duration_s") ? run->number("duration_s") : 0.0;
  return duration_s * per_second_s(rung) > kWorthTraining * training_cost_s(rung.rests.cost_s, per_second_s(rung));
}

// Takes a reduced model of this rung, where it is within the tolerance or nothing better is fast enough.
bool FidelityChooser::reduced(const Rung& rung) {
  FidelityChoice choice = rung.choice;
  choice.in_time = time_.choice;
  judgement_.cost_s += training_cost_s(rung.rests.cost_s, per_second_s(rung));
  const ReducedTrial trial =
      try_reduced(stated_, choice, rung.mesh, kRmsOfLargest * kShareOfReduced * request_.tolerance_m, judgement_);
  not_reduced_ = trial.why_not;
  if (!trial.reduced) return false;
  const double all_m = error_m(rung) + trial.reduced->error_m;
  const bool within = all_m <= request_.tolerance_m;
  const bool better =
      request_.use == FidelityUse::live && (took_slow_ || all_m < report_.expected_error_m.value_or(all_m + 1.0));
  if (!within && !better) {
    not_reduced_ = "its error comes to the mesh's";
    return false;
  }
  take(rung);
  ranges_ = trial.ranges;
  report_.choice->reduced = trial.reduced;
  report_.reduced_error_m = trial.reduced->error_m;
  report_.expected_error_m = all_m;
  report_.cost.per_second_s = reduced_cost_per_second_s(trial.reduced->modes);
  report_.met = within && !too_slow(report_.cost.per_second_s);
  return true;
}

void FidelityChooser::take(Rung rung) {
  report_.nodes = rung.mesh.node_count();
  report_.choice = rung.choice;
  report_.choice->in_time = time_.choice;
  report_.trouble = rung.error.expected_m ? time_.trouble : rung.error.trouble;
  report_.cost.rest_state_s = rung.rests.cost_s;
  report_.cost.per_second_s = per_second_s(rung);
  took_slow_ = too_slow(report_.cost.per_second_s);
  if (report_.trouble.empty()) {
    report_.mesh_error_m = *rung.error.expected_m * time_.amplification;
    report_.time_error_m = time_.error_m;
    report_.expected_error_m = report_.mesh_error_m + report_.time_error_m;
  }
  taken_ = std::move(rung);
}

bool FidelityChooser::look_at(Rung rung) {
  looked_at_nodes_ = rung.mesh.node_count();
  if (!rung.error.expected_m) {
    report_.meshes.push_back({rung.mesh.node_count(), std::nullopt});
    if (!taken_) take(std::move(rung));
    return report_.expected_error_m && ++unknown_ >= kMostUnknown;
  }
  unknown_ = 0;
  judge_in_time(rung);
  const double here_m = error_m(rung);
  report_.meshes.push_back({rung.mesh.node_count(), here_m});
  const bool within = here_m <= request_.tolerance_m && time_.trouble.empty();
  const bool slow = too_slow(per_second_s(rung));
  const double for_reduced_m = (request_.use == FidelityUse::live ? 1.0 - kShareOfReduced : 1.0) * request_.tolerance_m;
  if (here_m <= for_reduced_m && time_.trouble.empty() && worth_training(rung) && reduced(rung)) return true;
  const bool better = !report_.expected_error_m || here_m < *report_.expected_error_m;
  // What is too slow serves only where all is: then the fastest.
  if (slow ? !report_.expected_error_m : better || took_slow_) {
    take(std::move(rung));
    report_.met = within && !slow;
  }
  if (within && !slow) return true;
  if (slow && !may_reduce()) return true;  // finer meshes are slower still
  return !time_.trouble.empty() || time_.error_m > request_.tolerance_m;
}

void FidelityChooser::explain() {
  const bool in_time = moves(request_.use);
  report_.reasons = {
      "element: quadratic, as linear ones need far more nodes for the same error",
      "mesh: " + std::to_string(report_.nodes) + " nodes; " + std::to_string(ladder_.count()) +
          " meshes judged, of at most " + std::to_string(request_.max_nodes) + " nodes",
      report_.choice && report_.choice->reduced
          ? "method: reduced, " + std::to_string(report_.choice->reduced->modes) + " modes for commands in " + ranges_
          : "method: newton; xpbd is slower on meshes of this size",
      in_time ? "integrator and time step: judged over the first seconds of motion"
              : "integrator and time step: not chosen, as the question is at rest"};
  if (!not_reduced_.empty()) report_.reasons.push_back("no reduced model: " + not_reduced_);
}

FidelityReport FidelityChooser::choose() {
  while (true) {
    const double enough_m =
        judged_in_time_ ? (request_.tolerance_m - time_.error_m) / time_.amplification : request_.tolerance_m;
    std::optional<Rung> rung = ladder_.next(enough_m);
    if (!rung || look_at(std::move(*rung)) || hopeless()) break;
  }
  if (taken_) note_buckling(ladder_.near_buckling(), taken_->rests, report_);
  explain();
  if (report_.cost.per_second_s > 0.0) report_.expected_real_time = 1.0 / report_.cost.per_second_s;
  return report_;
}

// The scene as it is.
FidelityReport judge(Judgement& judgement, std::optional<Rung>& rung) {
  FidelityReport report;
  report.use = judgement.use;
  rung.emplace();
  rung->scene = judgement.settings;
  rung->mesh = read_mesh(judgement.settings, judgement.options);
  show_judging(rung->mesh, 0.0, judgement.options);
  MeshJudge meshes(judgement);
  rung->error = meshes.judge(judgement.settings, rung->mesh, 0.0);
  rung->rests = meshes.rests();
  report.nodes = rung->mesh.node_count();
  report.cost.rest_state_s = rung->rests.cost_s;
  report.trouble = rung->error.trouble;
  if (!rung->error.expected_m) {
    note_buckling(meshes.near_buckling(), rung->rests, report);
    return report;
  }
  TimeError time;
  if (moves(judgement.use)) {
    if (judgement.options.progress) judgement.options.progress(0.5, "fidelity: judges time steps");
    time = estimate_time_error(judgement.settings, rung->mesh, *rung->error.expected_m, judgement);
    report.cost.per_second_s = rung->rests.solve.of(time.counts) / time.stretch_s;
    if (report.cost.per_second_s > 0.0) report.expected_real_time = 1.0 / report.cost.per_second_s;
  }
  report.trouble = time.trouble;
  if (report.trouble.empty()) {
    report.mesh_error_m = *rung->error.expected_m * time.amplification;
    report.time_error_m = time.error_m;
    report.expected_error_m = report.mesh_error_m + report.time_error_m;
  }
  note_buckling(meshes.near_buckling(), rung->rests, report);
  return report;
}

bool refuses_self_contact(const YamlNode& settings) {
  const std::optional<YamlNode> contact = settings.optional_child("contact");
  return contact && contact->has("self");
}

// Switched on where, without it, a marker would be off by more than the tolerance; else its size is stated. The mesh
// was judged without it: with it the judgement of Spinebot at 1 mm took 390 s, not 2 s.
void weigh_contact(const Rung& rung, Judgement& judgement, FidelityReport& report) {
  const std::optional<PartEffect> effect = contact_effect(*rung.scene, rung.mesh, rung.rests, judgement);
  if (!effect) return;
  if (report.choice && effect->moved_m > report.tolerance_m && !refuses_self_contact(judgement.settings)) {
    report.choice->self_contact = true;
    std::ostringstream reason;
    reason << "contact of skin with skin: without it marker " << effect->marker << " would be " << 1e3 * effect->moved_m
           << " mm off; mesh and speed were judged without it";
    report.reasons.push_back(reason.str());
    return;
  }
  report.left_out_contact_m = effect->moved_m;
  if (report.tolerance_m > 0.0) report.met = report.met && effect->moved_m <= report.tolerance_m;
}

// `seeing`: a mesh that is fine enough to see them.
void weigh_parts(const Rung& rung, const Rung& seeing, Judgement& judgement, FidelityReport& report) {
  if (rung.rests.states.empty()) return;
  weigh_contact(rung, judgement, report);
  report.parts = part_effects(*seeing.scene, seeing.mesh, seeing.rests, judgement);
  for (PartEffect& effect : report.parts) {
    if (effect.trouble.empty()) effect.trouble = seeing.rests.unseen;
    effect.may_go = effect.trouble.empty() && effect.moved_m < kMayGo * report.tolerance_m;
  }
}

std::string content_key(const YamlNode& settings, const std::string& mesh_file, bool may_reduce) {
  ContentHash hash;
  hash.add(kFidelityVersion);
  hash.add(Overrides().over(settings).dump());                     // of a copy: dumping counts as reading
  hash.add(std::filesystem::path(mesh_file).filename().string());  // a hash of the files that the solid names
  hash.add(may_reduce ? "reduced models" : "newton alone");
  return hash.hex();
}

void require_judgeable(const YamlNode& settings, const YamlNode& place) {
  const std::optional<YamlNode> run = settings.optional_child("run");
  if (run && run->text_or("mode", "equilibrium") == "modal")
    place.fail("a modal run moves no marker; there is no error to estimate");
  if (settings.optional_sequence("markers").empty())
    place.fail("an error is that of the markers; the scene needs at least one");
}

FidelityUse use_of_run(const YamlNode& settings) {
  const std::optional<YamlNode> run = settings.optional_child("run");
  return run && run->text_or("mode", "equilibrium") == "dynamic" ? FidelityUse::motion : FidelityUse::rest;
}

FidelityReport choose_or_judge(const YamlNode& settings, const std::optional<FidelityRequest>& request,
                               const SceneOptions& options) {
  // No choice may hang on the time that a machine takes.
  const YamlNode judged = newton().set({"solver", "time_limit_s"}, limits::kTime_s).over(settings);
  Judgement judgement{judged, options, request ? request->use : use_of_run(settings)};
  std::optional<Rung> rung;
  FidelityReport report;
  if (request) {
    FidelityChooser chooser(settings, *request, judgement);
    report = chooser.choose();
    if (chooser.taken()) weigh_parts(*chooser.taken(), chooser.seeing(), judgement, report);
  } else {
    report = judge(judgement, rung);
    weigh_parts(*rung, *rung, judgement, report);
  }
  report.cost.choosing_s = judgement.cost_s;
  return report;
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
  if (choice.reduced)
    overrides.set({"solver", "method"}, "reduced").set({"solver", "tolerance_m"}, choice.reduced->tolerance_m);
  return overrides;
}

std::optional<FidelityReport> settle_fidelity(const YamlNode& settings, const SceneOptions& options) {
  const std::optional<FidelityRequest> request = read_fidelity(settings);
  if (!request && !options.estimate_error) return std::nullopt;
  require_judgeable(settings, request ? settings.child("fidelity") : settings);
  const YamlNode outline = request ? outline_of(settings) : settings;
  const std::string key =
      content_key(settings, mesh_file(outline, mesher_options(options)), options.reduced != ReducedUse::refused);
  const bool kept = !options.change_mesh;  // which the key does not know
  if (std::optional<FidelityReport> known; kept && (known = find_fidelity(key, options))) return known;

  const double start_s = cpu_time_s();
  FidelityReport report = choose_or_judge(settings, request, options);
  const bool touches = report.choice && report.choice->self_contact;
  report.left_out = left_out(touches ? self_contact().over(settings) : settings, moves(report.use));
  report.cpu_s = cpu_time_s() - start_s;
  if (kept) keep_fidelity(key, report, options);
  return report;
}

}  // namespace soft_robot_lab
