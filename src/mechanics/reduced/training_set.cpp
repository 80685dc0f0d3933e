// SPDX-License-Identifier: BSD-3-Clause
#include "training_set.h"

#include <set>
#include <sstream>
#include <stdexcept>

#include "mechanics/contact/contact_term.h"
#include "settings/require.h"
#include "reduced_constraints.h"

namespace soft_robot_lab {
namespace {

constexpr int kStages = 4;             // of a ramp
constexpr int kStepsPerSnapshot = 2;   // of a transient
constexpr double kShareOfRamps = 0.6;  // of the progress
constexpr unsigned kTrainingSeed = 1;

void require_supported(const Model& model) {
  const Body& body = model.body();
  const char* what = nullptr;
  if (!body.obstacles().empty()) what = "contact with obstacles";
  for (const TouchingBodies& pair : body.touching_bodies())
    if (pair.friction > 0.0) what = "friction of skin on skin";
  if (body.holds_move()) what = "held regions that move";
  if (body.viscosity().of_strain()) what = "viscosity of the strain, nor hysteresis";
  if (body.linear_volume() != LinearVolume::element) what = "vertex-averaged volumes";
  if (model.options().method != SolverOptions::Method::newton) what = "training with a method other than newton";
  if (model.options().integrator != Integrator::implicit_euler) what = "an integrator other than implicit_euler";
  if (!body.fibres().empty()) what = "fibres; choose method newton";
  for (const auto& actuator : model.actuators())
    if (!actuator->energy_terms().empty()) what = "actuators with an energy of their own; choose method newton";
  if (model.actuators().empty()) what = "a body without actuators";
  if (what) throw std::invalid_argument(std::string("a reduced model does not know ") + what);
}

void require_box(const Model& model, const CommandBox& box) {
  const std::size_t count = model.actuators().size();
  if (box.min.size() != count || box.max.size() != count)
    throw std::invalid_argument("the command box of a reduced model needs a range for each of " +
                                std::to_string(count) + " actuators");
  for (std::size_t i = 0; i < count; ++i) {
    const Actuator& actuator = *model.actuators()[i];
    const double rest = actuator.limits().rest;
    actuator.require_in_limits(box.min[i]);
    actuator.require_in_limits(box.max[i]);
    if (box.min[i] < box.max[i] && box.min[i] <= rest && rest <= box.max[i]) continue;
    std::ostringstream message;
    message << actuator.name() << ": the range [" << box.min[i] << ", " << box.max[i]
            << "] of a reduced model must have a width, and hold the rest command " << rest;
    throw std::invalid_argument(message.str());
  }
}

void require_valid(const Model& model, const ReducedTraining& training) {
  require_supported(model);
  require_box(model, training.box);
  require(training.modes >= 1 && training.modes <= 40, "modes", training.modes, "[1, 40]");
  require(training.ramps >= 1 && training.ramps <= 1000, "ramps", training.ramps, "[1, 1000]");
  require(training.transient_s >= 0.0 && training.transient_s <= 600.0, "transient_s", training.transient_s,
          "[0, 600]");
  require(training.cubature_tolerance_m >= 0.0, "cubature_tolerance_m", training.cubature_tolerance_m, ">= 0");
}

// Which faces of the skin meet.
class MetSkin {
 public:
  explicit MetSkin(const Body& body) : contact_(body) {}

  void look(const SimulationState& at) {
    if (contact_.empty()) return;
    for (const ContactTouch& touch : contact_.sums(at.positions_m, at.contact).touches)
      if (touch.on_skin()) met_.insert(contact_.skin().faces_of(touch));
  }
  std::vector<FacePair> pairs() const { return {met_.begin(), met_.end()}; }

 private:
  ContactTerm contact_;
  std::set<FacePair> met_;
};

void add_ramp(const std::vector<double>& target, Simulation& simulation, MetSkin& skin, TrainingSet& all) {
  simulation.reset();
  const std::vector<double> rest = simulation.state().commands();
  for (int stage = 1; stage <= kStages; ++stage) {
    std::vector<double> commands = rest;
    for (std::size_t a = 0; a < rest.size(); ++a) commands[a] += (target[a] - rest[a]) * stage / kStages;
    command(commands, simulation);
    if (simulation.solve_equilibrium().converged) {
      all.snapshots.push_back(snapshot_of(simulation, 0.0));
      skin.look(simulation.state());
    } else {
      ++all.failed;
    }
  }
}

}  // namespace

TrainingSet collect_training(const std::shared_ptr<const Model>& model, const ReducedTraining& training,
                             const TrainingProgress& progress) {
  require_valid(*model, training);
  ReducedConstraints(*model,
                     Eigen::MatrixXd(3 * model->body().mesh().node_count(), 0));  // refuses others before the work
  const auto show = [&](double fraction, const char* what) {
    if (progress) progress(fraction, what);
  };
  TrainingSet all;
  Simulation simulation(model);
  MetSkin skin(model->body());
  for (int i = 0; i < training.ramps; ++i) {
    show(kShareOfRamps * i / training.ramps, "equilibria to train with");
    add_ramp(commands_in(training.box, static_cast<std::size_t>(i)), simulation, skin, all);
  }
  const double h = model->options().time_step_s;
  run_transient(training.box, training.transient_s, kTrainingSeed, simulation, [&](int i, bool converged) {
    show(kShareOfRamps + (1.0 - kShareOfRamps) * i * h / training.transient_s, "motion to train with");
    if (!converged) ++all.failed;
    if (converged) skin.look(simulation.state());
    if (converged && i % kStepsPerSnapshot == 0) all.snapshots.push_back(snapshot_of(simulation, 1.0 / (h * h)));
  });
  if (all.snapshots.empty()) throw std::invalid_argument("no solve of a reduced model's training converged");
  all.met = skin.pairs();
  return all;
}

}  // namespace soft_robot_lab
