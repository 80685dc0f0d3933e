// SPDX-License-Identifier: BSD-3-Clause
#include "train.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "mechanics/elements/elements.h"
#include "mechanics/complementarity/multiplier_problem.h"
#include "mechanics/simulation/workspace.h"
#include "pod.h"
#include "point_cubature.h"
#include "reduced_newton.h"
#include "training_set.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kCubatureStates = 100;

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

KnownRests rests_of(const std::vector<Snapshot>& snapshots, const ReducedModel& model) {
  std::vector<const Snapshot*> rests;
  for (const Snapshot& snapshot : snapshots)
    if (snapshot.inertia_per_s2 == 0.0) rests.push_back(&snapshot);
  const auto count = static_cast<Eigen::Index>(rests.size());
  const auto actuators = static_cast<Eigen::Index>(model.box.min.size());
  KnownRests all{Eigen::MatrixXd(actuators, count), Eigen::MatrixXd(model.energy.modes(), count),
                 Eigen::MatrixXd(model.energy.pressures(), count),
                 Eigen::MatrixXd(static_cast<Eigen::Index>(model.constraints.count()), count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Snapshot& at = *rests[static_cast<std::size_t>(i)];
    for (Eigen::Index a = 0; a < actuators; ++a) all.commands(a, i) = at.drives[static_cast<std::size_t>(a)].command;
    const ReducedUnknowns unknowns = projected(model, at);
    all.q.col(i) = unknowns.q;
    all.pressures.col(i) = unknowns.pressures;
    all.multipliers.col(i) = unknowns.multipliers;
  }
  return all;
}

// How each point moves the body, rms in m, in the first Newton step at a snapshot's projection.
Eigen::MatrixXd point_motions(const ReducedModel& model, const Snapshot& at) {
  const ReducedUnknowns unknowns = projected(model, at);
  const ReducedConstraints::Values constraints = model.constraints.at(unknowns.q, unknowns.multipliers, at.drives);
  const Eigen::MatrixXd inner = reduced_matrix(model, unknowns, constraints, at.inertia_per_s2);
  const Eigen::Index n = unknowns.q.size();
  const Eigen::MatrixXd matrix = bordered(inner, constraints, unknowns.multipliers);
  return matrix.inverse().topLeftCorner(n, n) * model.energy.point_forces(unknowns.q) / std::sqrt(model.mass_kg);
}

void choose_points(const std::vector<Snapshot>& snapshots, double tolerance_m, ReducedModel& model) {
  const std::size_t states = std::min(kCubatureStates, snapshots.size());
  const Eigen::Index n = model.energy.modes();
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(states) * n, static_cast<Eigen::Index>(model.energy.points().size()));
  for (std::size_t i = 0; i < states; ++i)
    rows.middleRows(static_cast<Eigen::Index>(i) * n, n) =
        point_motions(model, snapshots[i * snapshots.size() / states]);
  model.hyper_reduce(sparse_weights(rows, tolerance_m * std::sqrt(static_cast<double>(states))));
}

}  // namespace

std::shared_ptr<const ReducedModel> train(const std::shared_ptr<const Model>& model, const ReducedTraining& training) {
  return train_on(collect_training(model, training, {}), model, training);
}

std::shared_ptr<const ReducedModel> train_on(const TrainingSet& set, const std::shared_ptr<const Model>& model,
                                             const ReducedTraining& training) {
  auto reduced = std::make_shared<ReducedModel>(model, training.box, basis_of(set.snapshots, *model, training.modes));
  reduced->snapshots = static_cast<int>(set.snapshots.size());
  reduced->failed_solves = set.failed;
  reduced->rests = rests_of(set.snapshots, *reduced);
  if (!set.met.empty()) reduced->let_touch(with_neighbours(set.met, model->body()));
  if (training.cubature_tolerance_m > 0.0) choose_points(set.snapshots, training.cubature_tolerance_m, *reduced);
  return reduced;
}

}  // namespace soft_robot_lab
