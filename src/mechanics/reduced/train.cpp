// SPDX-License-Identifier: BSD-3-Clause
#include "train.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/LU>

#include "mechanics/elements/elements.h"
#include "mechanics/newton/multiplier_problem.h"
#include "mechanics/simulation/require.h"
#include "mechanics/simulation/workspace.h"
#include "pod.h"
#include "point_cubature.h"
#include "reduced_newton.h"
#include "reduced_simulation.h"
#include "snapshots.h"

namespace soft_robot_lab {
namespace {

constexpr int kStages = 4;            // of a ramp
constexpr int kStepsPerSnapshot = 2;  // of a transient
constexpr std::size_t kCubatureStates = 100;
constexpr std::size_t kHeldOut = 5000;  // first number of the held-out commands; training has smaller ones
constexpr unsigned kTrainingSeed = 1, kHeldOutSeed = 2;

void require_supported(const Model& model) {
  const Body& body = model.body();
  const char* what = nullptr;
  if (!body.obstacles().empty()) what = "contact";
  if (body.viscosity().rayleigh_mass_per_s > 0.0 || body.viscosity().of_strain()) what = "viscosity";
  if (body.material().model != MaterialModel::neo_hookean) what = "a material other than neo_hookean";
  if (body.linear_volume() != LinearVolume::element) what = "vertex-averaged volumes";
  if (model.options().method != SolverOptions::Method::newton) what = "training with a method other than newton";
  if (model.options().integrator != Integrator::implicit_euler) what = "an integrator other than implicit_euler";
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

struct Collected {
  std::vector<Snapshot> snapshots;
  int failed = 0;
};

void add_ramp(const std::vector<double>& target, Simulation& simulation, Collected& all) {
  simulation.reset();
  const std::vector<double> rest = simulation.state().commands();
  for (int stage = 1; stage <= kStages; ++stage) {
    std::vector<double> commands = rest;
    for (std::size_t a = 0; a < rest.size(); ++a) commands[a] += (target[a] - rest[a]) * stage / kStages;
    command(commands, simulation);
    if (simulation.solve_equilibrium().converged)
      all.snapshots.push_back(snapshot_of(simulation, 0.0));
    else
      ++all.failed;
  }
}

// Calls `after_step(converged)` after each.
template <class AfterStep>
void run_transient(const CommandBox& box, double duration_s, unsigned seed, Simulation& simulation,
                   const AfterStep& after_step) {
  const std::vector<std::vector<double>> targets = transient_commands(box, duration_s, seed);
  const double h = simulation.options().time_step_s;
  const int steps = static_cast<int>(std::lround(duration_s / h));
  simulation.reset();
  for (int i = 0; i < steps; ++i) {
    const auto hold = static_cast<std::size_t>(i * h / kTransientHold_s);
    command(targets[std::min(hold, targets.size() - 1)], simulation);
    after_step(i, simulation.step().converged);
  }
}

Collected collect(const std::shared_ptr<const Model>& model, const ReducedTraining& training) {
  Collected all;
  Simulation simulation(model);
  for (int i = 0; i < training.ramps; ++i)
    add_ramp(commands_in(training.box, static_cast<std::size_t>(i)), simulation, all);
  const double h = model->options().time_step_s;
  run_transient(training.box, training.transient_s, kTrainingSeed, simulation, [&](int i, bool converged) {
    if (!converged) ++all.failed;
    if (converged && i % kStepsPerSnapshot == 0) all.snapshots.push_back(snapshot_of(simulation, 1.0 / (h * h)));
  });
  if (all.snapshots.empty()) throw std::invalid_argument("no solve of a reduced model's training converged");
  return all;
}

const Eigen::VectorXd& element_volumes_m3(const Model& model) {
  return model.tables().newton->elements->rest_volumes_m3();
}

Eigen::VectorXd masses_of_axes_kg(const Body& body) {
  const Eigen::RowVectorXd masses = body.node_masses_kg().transpose();
  const Eigen::Matrix3Xd all = masses.replicate<3, 1>();
  return Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
}

// A third as many pressures as modes: more of them lock, fewer leave the volume free.
ReducedBasis basis_of(const std::vector<Snapshot>& snapshots, const Model& model, int modes) {
  const auto count = static_cast<Eigen::Index>(snapshots.size());
  Eigen::MatrixXd displacements(snapshots[0].displacement_m.size(), count);
  Eigen::MatrixXd multipliers(snapshots[0].multipliers_pa.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    displacements.col(i) = snapshots[static_cast<std::size_t>(i)].displacement_m;
    multipliers.col(i) = snapshots[static_cast<std::size_t>(i)].multipliers_pa;
  }
  ReducedBasis basis;
  basis.modes = pod(displacements, masses_of_axes_kg(model.body()), modes);
  const int pressures = std::max(1, static_cast<int>(std::lround(static_cast<double>(basis.modes.cols()) / 3.0)));
  basis.pressures = pod(multipliers, element_volumes_m3(model), pressures);
  return basis;
}

// How each point moves the body, rms in m, in the first Newton step at a snapshot's projection.
Eigen::MatrixXd point_motions(const ReducedModel& model, const Snapshot& at, const Eigen::VectorXd& masses_kg,
                              const Eigen::VectorXd& volumes_m3) {
  const ReducedUnknowns unknowns{model.basis.modes.transpose() * masses_kg.cwiseProduct(at.displacement_m),
                                 model.basis.pressures.transpose() * volumes_m3.cwiseProduct(at.multipliers_pa),
                                 at.tensions_n};
  const ReducedCables::Values cables = model.cables.at(unknowns.q, unknowns.tensions_n, at.drives);
  const Eigen::MatrixXd inner = reduced_matrix(model, unknowns, cables, at.inertia_per_s2);
  const Eigen::Index n = unknowns.q.size();
  const Eigen::MatrixXd matrix = bordered(inner, cables, unknowns.tensions_n);
  return matrix.inverse().topLeftCorner(n, n) * model.energy.point_forces(unknowns.q) / std::sqrt(model.mass_kg);
}

void choose_points(const std::vector<Snapshot>& snapshots, double tolerance_m, ReducedModel& model) {
  const Eigen::VectorXd masses_kg = masses_of_axes_kg(model.full->body());
  const Eigen::VectorXd& volumes_m3 = element_volumes_m3(*model.full);
  const std::size_t states = std::min(kCubatureStates, snapshots.size());
  const Eigen::Index n = model.energy.modes();
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(states) * n, static_cast<Eigen::Index>(model.energy.points().size()));
  for (std::size_t i = 0; i < states; ++i)
    rows.middleRows(static_cast<Eigen::Index>(i) * n, n) =
        point_motions(model, snapshots[i * snapshots.size() / states], masses_kg, volumes_m3);
  model.energy.keep_points(sparse_weights(rows, tolerance_m * std::sqrt(static_cast<double>(states))));
}

class ErrorSum {
 public:
  void add(bool solved, const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
    ++error_.states;
    if (!solved) {
      ++error_.unsolved;
      return;
    }
    const Eigen::RowVectorXd squares = (a - b).colwise().squaredNorm();
    squares_ += squares.mean();
    error_.max_m = std::max(error_.max_m, std::sqrt(squares.maxCoeff()));
  }
  ReducedError result() const {
    ReducedError error = error_;
    error.rms_m = std::sqrt(squares_ / std::max(1, error.states - error.unsolved));
    return error;
  }

 private:
  ReducedError error_;
  double squares_ = 0.0;
};

}  // namespace

std::shared_ptr<const ReducedModel> train(const std::shared_ptr<const Model>& model, const ReducedTraining& training) {
  require_valid(*model, training);
  ReducedCables(*model, Eigen::MatrixXd(3 * model->body().mesh().node_count(), 0));  // refuses others before the work
  const Collected all = collect(model, training);
  auto reduced = std::make_shared<ReducedModel>(model, training.box, basis_of(all.snapshots, *model, training.modes));
  reduced->snapshots = static_cast<int>(all.snapshots.size());
  reduced->failed_solves = all.failed;
  if (training.cubature_tolerance_m > 0.0) choose_points(all.snapshots, training.cubature_tolerance_m, *reduced);
  return reduced;
}

ReducedError held_out_equilibria(const std::shared_ptr<const ReducedModel>& reduced, int count) {
  ErrorSum sum;
  Simulation full(reduced->full);
  ReducedSimulation fast(reduced);
  for (int i = 0; i < count; ++i) {
    const std::vector<double> commands = commands_in(reduced->box, kHeldOut + static_cast<std::size_t>(i));
    full.reset();
    fast.reset();
    command(commands, full);
    command(commands, fast);
    const bool exact = full.solve_equilibrium().converged, solved = fast.solve_equilibrium().converged;
    sum.add(exact && solved, full.state().positions_m, fast.positions_m());
  }
  return sum.result();
}

ReducedError held_out_projection(const std::shared_ptr<const ReducedModel>& reduced, double duration_s) {
  ErrorSum sum;
  Simulation full(reduced->full);
  const Eigen::VectorXd masses_kg = masses_of_axes_kg(full.body());
  run_transient(reduced->box, duration_s, kHeldOutSeed, full, [&](int /*step*/, bool converged) {
    const Eigen::VectorXd moved = snapshot_of(full, 0.0).displacement_m;
    const Eigen::VectorXd q = reduced->basis.modes.transpose() * masses_kg.cwiseProduct(moved);
    sum.add(converged, full.state().positions_m, reduced->positions_m(q));
  });
  return sum.result();
}

ReducedError held_out_transient(const std::shared_ptr<const ReducedModel>& reduced, double duration_s) {
  ErrorSum sum;
  Simulation full(reduced->full);
  ReducedSimulation fast(reduced);
  run_transient(reduced->box, duration_s, kHeldOutSeed, full, [&](int /*step*/, bool converged) {
    command(full.state().commands(), fast);
    const bool solved = fast.step().converged;  // before the arguments below, whose order is free
    sum.add(solved && converged, full.state().positions_m, fast.positions_m());
  });
  return sum.result();
}

}  // namespace soft_robot_lab
