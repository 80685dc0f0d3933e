// SPDX-License-Identifier: BSD-3-Clause
#include "choose_modes.h"

#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "held_out.h"
#include "settings/require.h"
#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

constexpr double kNarrower = 0.6;  // times each range, where the one before was too wide
constexpr int kNarrowings = 3;
constexpr int kHeldOutEquilibria = 20;
constexpr double kHeldOutTransient_s = 6.0;
constexpr double kMostLeft = 0.1;  // of equilibria, to the full model: those just where the body begins to buckle
const std::vector<int> kModes{4, 6, 8, 12, 16, 20, 25, 30, 40};
// An error is 5 to 15 times the tolerance of the cubature.
constexpr double kShareOfCubature = 1.0 / 20.0;

// The part of `progress` from one fraction to another.
TrainingProgress part(const TrainingProgress& progress, double from, double to) {
  if (!progress) return {};
  return [=](double fraction, const std::string& what) { progress(from + (to - from) * fraction, what); };
}

bool meets(const ReducedChoice& choice, double tolerance_m) {
  return choice.equilibria.unsolved <= kMostLeft * choice.equilibria.states && choice.transient.unsolved == 0 &&
         choice.largest_rms_m() <= tolerance_m;
}

[[noreturn]] void refuse(const ReducedChoice& best, double tolerance_m) {
  std::ostringstream text;
  text << "no reduced model of " << (best.model ? best.model->energy.modes() : 0)
       << " modes or fewer meets tolerance_m " << tolerance_m << ": rms " << best.equilibria.rms_m
       << " m in equilibria and " << best.transient.rms_m << " m in motion, "
       << best.equilibria.unsolved + best.transient.unsolved
       << " states unsolved; allow more, list narrower commands, or choose method newton";
  throw ToleranceNotMet(text.str());
}

CommandBox narrower(const Model& model, CommandBox box) {
  for (std::size_t i = 0; i < box.min.size(); ++i) {
    const double rest = model.actuators()[i]->limits().rest;
    for (double* end : {&box.min[i], &box.max[i]}) *end = rest + kNarrower * (*end - rest);
  }
  return box;
}

ReducedChoice choose_in_box(const std::shared_ptr<const Model>& model, const ReducedRequest& request,
                            const TrainingProgress& progress) {
  require(request.tolerance_m > 0.0, "tolerance_m", request.tolerance_m, "> 0");
  const double start_s = cpu_time_s();
  ReducedTraining training;
  training.box = request.box;
  training.cubature_tolerance_m = kShareOfCubature * request.tolerance_m;
  if (request.modes != 0) training.modes = request.modes;
  const TrainingSet set = collect_training(model, training, part(progress, 0.0, 0.6));
  const HeldOut held_out(model, request.box, kHeldOutEquilibria, kHeldOutTransient_s, part(progress, 0.6, 0.8));
  ReducedChoice best;
  for (const int modes : request.modes != 0 ? std::vector<int>{request.modes} : kModes) {
    if (progress) progress(0.8, "reduced model of " + std::to_string(modes) + " modes");
    training.modes = modes;
    ReducedChoice choice;
    choice.model = train_on(set, model, training);
    choice.equilibria = held_out.equilibria(choice.model);
    choice.transient = held_out.transient(choice.model);
    choice.cpu_s = cpu_time_s() - start_s;
    if (meets(choice, request.tolerance_m)) return choice;
    if (!best.model || choice.largest_rms_m() < best.largest_rms_m()) best = choice;
    if (choice.model->energy.modes() < modes) break;  // all that the states span
  }
  refuse(best, request.tolerance_m);
}

}  // namespace

ReducedChoice choose_modes(const std::shared_ptr<const Model>& model, const ReducedRequest& request,
                           const TrainingProgress& progress) {
  ReducedRequest asked = request;
  double done = 0.0;  // of it all; half of what is left where it may have to begin anew
  for (int left = request.may_narrow ? kNarrowings : 0; left > 0; --left) {
    try {
      const double from = done;
      done += 0.5 * (1.0 - done);
      return choose_in_box(model, asked, part(progress, from, done));
    } catch (const ToleranceNotMet&) {
      asked.box = narrower(*model, asked.box);
    }
  }
  return choose_in_box(model, asked, part(progress, done, 1.0));
}

}  // namespace soft_robot_lab
