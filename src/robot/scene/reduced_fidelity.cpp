// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <sstream>

#include "reduced_fidelity.h"
#include "reduction.h"

namespace soft_robot_lab {
namespace {

// What training and judging of a reduced model take (training_set.cpp, choose_modes.cpp).
constexpr double kTrainingRests = 140.0, kTrainingMotion_s = 16.0;
constexpr double kStepsPerSecond = 60.0;
constexpr double kModeCubed_s = 1e-8;  // of a step: 45 us of 20 modes, 150 us of 30, and as much for audits

bool covers(const CommandBox& box, const std::vector<double>& commands) {
  for (std::size_t i = 0; i < commands.size(); ++i)
    if (commands[i] < box.min[i] || commands[i] > box.max[i]) return false;
  return true;
}

std::string ranges(const CommandBox& box, const Simulation& simulation) {
  std::ostringstream text;
  for (std::size_t i = 0; i < box.min.size(); ++i)
    text << (i > 0 ? ", " : "") << simulation.actuators()[i]->name() << " [" << box.min[i] << ", " << box.max[i] << "]";
  return text.str();
}

}  // namespace

double training_cost_s(double rest_state_s, double per_second_s) {
  return kTrainingRests * rest_state_s + kTrainingMotion_s * per_second_s;
}

double reduced_cost_per_second_s(int modes) { return kStepsPerSecond * kModeCubed_s * modes * modes * modes; }

ReducedTrial try_reduced(const YamlNode& stated, FidelityChoice choice, const TetMesh& mesh, double tolerance_m,
                         const Judgement& judgement) {
  ReducedTrial trial;
  choice.reduced = ReducedFidelity{tolerance_m, 0, 0.0};
  const YamlNode settings = overrides_of(choice).over(stated);
  SceneOptions options = judgement.options;
  options.reduced = ReducedUse::trained;
  if (options.progress)
    options.progress = [show = options.progress](double fraction, const std::string& what) {
      show(fraction, "fidelity: " + what);
    };
  try {
    const Scene scene = build_scene(settings, mesh, options);
    const std::shared_ptr<const SceneReduction> reduction =
        reduce(settings, scene, read_reduced(settings, scene, options.reduced).value(), options);
    const ReducedChoice& made = reduction->choice;
    if (judgement.use == FidelityUse::motion)
      for (const std::vector<double>& commands : judged_commands(*scene.simulation, scene.run, judgement.use))
        if (!covers(made.model->box, commands)) {
          trial.why_not = "it meets its tolerance only within " + ranges(made.model->box, *scene.simulation);
          return trial;
        }
    trial.reduced = ReducedFidelity{tolerance_m, static_cast<int>(made.model->energy.modes()),
                                    std::max(made.equilibria.max_m, made.transient.max_m)};
    trial.ranges = ranges(made.model->box, *scene.simulation);
  } catch (const std::invalid_argument& error) {
    trial.why_not = error.what();
  }
  return trial;
}

}  // namespace soft_robot_lab
