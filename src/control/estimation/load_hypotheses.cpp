// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "estimator_parts.h"

namespace soft_robot_lab {
namespace {

constexpr double kLogOddsOfTwo = -4.6;  // two pushes at once are taken for a hundred times as rare as one
constexpr double kWorthASecond = 0.05;  // the same, beyond which two pushes are tried
constexpr std::size_t kStarts = 3;      // places from which one push is followed
constexpr double kApart = 0.08;         // of the body's size, between these
constexpr std::size_t kFirsts = 24;     // places tried for the first of two pushes
constexpr double kFirstsApart = 0.03;   // of the body's size
constexpr std::size_t kLikely = 300;    // places that a load is described by
constexpr std::size_t kSeconds = 600;   // places tried for the second, about
constexpr int kMostSolves = 12;
constexpr double kLeastStep = 0.01;  // of a force: smaller changes are not followed
constexpr double kStage = 0.04;      // of the body's size: markers move about so far in a stage
constexpr int kMostStages = 6;
constexpr double kSettled = 0.05;                               // of a log probability
constexpr double kFrameShift_m = 0.005, kFrameTurn_rad = 0.05;  // standard deviations of a displaced frame

Eigen::VectorXd without(const LoadSolution& at, std::size_t load, const std::vector<LoadPlace>& places) {
  Eigen::VectorXd gap = at.linear.gap;
  for (std::size_t i = 0; i < at.loads.size(); ++i)
    if (i != load) gap -= at.linear.compliance_at(places[at.loads[i].place].at).transpose() * at.loads[i].force_n;
  return gap;
}

}  // namespace

LinearisedLoads LoadEstimator::Parts::linearise(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                                                const std::vector<LoadPlace>& places,
                                                const std::vector<PlacedLoad>& loads) {
  const Eigen::MatrixXd all = model.marker_compliances();
  LinearisedLoads linear{model.state().positions_m, Eigen::MatrixXd(all.rows(), seen.coordinates()), {}};
  for (std::size_t i = 0; i < seen.markers.size(); ++i)
    linear.compliance.middleCols<3>(3 * static_cast<Eigen::Index>(i)) = all.middleCols<3>(3 * seen.markers[i]);
  linear.compliance = linear.compliance * whitening.transpose();
  linear.gap = whitening * gap_m(seen);
  for (const PlacedLoad& load : loads)
    linear.gap += linear.compliance_at(places[load.place].at).transpose() * load.force_n;
  return linear;
}

std::optional<LoadSolution> LoadEstimator::Parts::solve(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                                                        const std::vector<LoadPlace>& places,
                                                        const std::vector<PlacedLoad>& loads) {
  std::vector<PointLoad> forces;
  for (const PlacedLoad& load : loads) forces.push_back({places[load.place].at, load.force_n});
  model.pull(forces);
  if (!model.solve_equilibrium().converged) return std::nullopt;
  LoadSolution solution;
  solution.loads = loads;
  const Eigen::VectorXd gap = whitening * gap_m(seen);
  solution.chi2 = gap.squaredNorm();
  solution.log_probability = -0.5 * solution.chi2;
  for (const PlacedLoad& load : loads)
    solution.log_probability += prior().log_density(load.force_n, places[load.place].skin ? 3 : 1);
  solution.linear = linearise(seen, whitening, places, loads);
  solution.state = model.state();
  return solution;
}

// The loads that the linearisation at a solution finds best for its gap less `left_out`: one after the other, given the
// others, each anywhere or where it is.
std::vector<PlacedLoad> LoadEstimator::Parts::better(const LoadSolution& at, const std::vector<LoadPlace>& places,
                                                     const Eigen::VectorXd& left_out, bool anywhere) const {
  LoadSolution changed{at.loads, 0.0, 0.0, at.linear, {}};
  changed.linear.gap -= left_out;
  const int sweeps = at.loads.size() > 1 ? 3 : 1;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t i = 0; i < changed.loads.size(); ++i) {
      const Eigen::VectorXd gap = without(changed, i, places);
      if (!anywhere) {
        changed.loads[i].force_n =
            fit_places(at.linear, gap, {places[changed.loads[i].place]}, prior()).front().force_n;
        continue;
      }
      const std::vector<PlaceFit> fits = fit_places(at.linear, gap, places, prior());
      const auto best = std::max_element(fits.begin(), fits.end(), [](const PlaceFit& a, const PlaceFit& b) {
        return a.log_evidence < b.log_evidence;
      });
      changed.loads[i] = {static_cast<std::size_t>(best - fits.begin()), best->force_n};
    }
  }
  return changed.loads;
}

// Towards loads at these places in stages, so that the robot bends little in each, as it answers very differently once
// it is bent. Each stage takes away a share of the gap.
std::optional<LoadSolution> LoadEstimator::Parts::approach(const SeenCoordinates& seen,
                                                           const Eigen::MatrixXd& whitening,
                                                           const LinearisedLoads& unloaded,
                                                           const std::vector<LoadPlace>& places,
                                                           const std::vector<std::size_t>& where) {
  model.pull({});
  model.set_state(untouched);
  const double farthest_m = gap_m(seen).reshaped(3, seen.coordinates() / 3).colwise().norm().maxCoeff();
  const int stages =
      std::clamp(static_cast<int>(std::ceil(farthest_m / (kStage * model.body().size_m()))), 1, kMostStages);
  std::optional<LoadSolution> here(LoadSolution{{}, 0.0, 0.0, unloaded, untouched});
  for (const std::size_t place : where) here->loads.push_back({place, Eigen::Vector3d::Zero()});
  for (int stage = 1; stage <= stages && here; ++stage) {
    const double left = 1.0 - static_cast<double>(stage) / stages;
    const std::vector<PlacedLoad> loads = better(*here, places, left * unloaded.gap, false);
    try {
      here = solve(seen, whitening, places, loads);
    } catch (const std::runtime_error&) {  // not stable under these loads
      return std::nullopt;
    }
  }
  return here;
}

// Gauss-Newton from these places: solve under the loads, linearise there, look for better ones. A step that makes it
// worse is halved.
std::optional<LoadSolution> LoadEstimator::Parts::follow(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                                                         const LinearisedLoads& unloaded,
                                                         const std::vector<LoadPlace>& places,
                                                         const std::vector<std::size_t>& where) {
  std::optional<LoadSolution> best = approach(seen, whitening, unloaded, places, where);
  if (!best) return best;
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(best->linear.gap.size());
  std::vector<PlacedLoad> loads = better(*best, places, nothing, true);
  for (int i = 0; i < kMostSolves; ++i) {
    std::optional<LoadSolution> here;
    try {
      here = solve(seen, whitening, places, loads);
    } catch (const std::runtime_error&) {  // not stable under these loads
    }
    if (here && here->log_probability > best->log_probability) {
      const bool settled = here->log_probability < best->log_probability + kSettled;
      best = std::move(here);
      if (settled) break;
      loads = better(*best, places, nothing, true);
      continue;
    }
    model.set_state(best->state);
    double change = 0.0;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      loads[k].place = best->loads[k].place;
      const Eigen::Vector3d step_n = 0.5 * (loads[k].force_n - best->loads[k].force_n);
      loads[k].force_n = best->loads[k].force_n + step_n;
      change = std::max(change, step_n.norm() / std::max(loads[k].force_n.norm(), options.least_force_n));
    }
    if (change < kLeastStep) break;
  }
  return best;
}

double LoadEstimator::Parts::log_evidence(const LoadSolution& solution, const std::vector<LoadPlace>& places) const {
  // Each place is weighed given the others; forces together.
  double log_evidence = solution.log_probability;
  Eigen::MatrixXd compliance(0, solution.linear.gap.size());
  std::vector<double> scales_n;
  for (std::size_t i = 0; i < solution.loads.size(); ++i) {
    const std::vector<PlaceFit> fits = fit_places(solution.linear, without(solution, i, places), places, prior());
    // What the linearisation promises beyond what was found is not counted.
    log_evidence += std::min(0.0, log_mean_evidence(fits, places) - fits[solution.loads[i].place].log_evidence);
    Eigen::MatrixXd of_load = solution.linear.compliance_at(places[solution.loads[i].place].at);
    const int components = places[solution.loads[i].place].skin ? 3 : 1;
    if (components == 1) of_load = prior().down.transpose() * of_load;
    const double scale_n = prior().scale_of(solution.loads[i].force_n, components);
    scales_n.insert(scales_n.end(), static_cast<std::size_t>(components), scale_n);
    Eigen::MatrixXd wider(compliance.rows() + of_load.rows(), compliance.cols());
    wider << compliance, of_load;
    compliance = std::move(wider);
  }
  Eigen::MatrixXd information = compliance * compliance.transpose();
  for (std::size_t i = 0; i < scales_n.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    information(k, k) += 1.0 / (scales_n[i] * scales_n[i]);
  }
  return log_evidence + 0.5 * static_cast<double>(scales_n.size()) * std::log(2.0 * M_PI) -
         information.llt().matrixLLT().diagonal().array().log().sum();
}

void LoadEstimator::Parts::add_loads(const SeenCoordinates& seen, const Eigen::MatrixXd& whitening,
                                     const LinearisedLoads& unloaded, std::vector<LoadHypothesis>& all) {
  const double size_m = model.body().size_m();
  const auto best_of = [&](const std::vector<LoadPlace>& places, std::size_t starts, LoadKind kind) {
    const std::vector<PlaceFit> fits = fit_places(unloaded, unloaded.gap, places, prior());
    std::optional<LoadSolution> best;
    for (const std::size_t start : best_apart(fits, places, model.body().mesh(), kApart * size_m, starts)) {
      std::optional<LoadSolution> here = follow(seen, whitening, unloaded, places, {start});
      if (here && (!best || here->log_probability > best->log_probability)) best = std::move(here);
    }
    if (best) all.push_back({kind, log_evidence(*best, places), best->chi2, {}, -1, best});
    return best;
  };
  if (!prior().down.isZero(0.0)) best_of(hooks, 2, LoadKind::weight);
  const std::optional<LoadSolution> one = best_of(skin, kStarts, LoadKind::push);
  const double most = largest_chi2(static_cast<int>(seen.coordinates()), kWorthASecond);
  if (!one || std::any_of(all.begin(), all.end(), [&](const LoadHypothesis& each) { return each.chi2 <= most; }))
    return;
  std::optional<LoadSolution> two;
  for (const LinearisedLoads* linear : {&unloaded, &one->linear}) {
    const std::vector<PlaceFit> fits = fit_places(*linear, linear->gap, skin, prior());
    const std::vector<std::size_t> firsts = best_apart(fits, skin, model.body().mesh(), kFirstsApart * size_m, kFirsts);
    const std::vector<std::size_t> pair =
        best_pair(*linear, skin, firsts, std::max<std::size_t>(1, skin.size() / kSeconds), prior());
    if (pair.empty()) continue;
    std::optional<LoadSolution> here = follow(seen, whitening, unloaded, skin, pair);
    if (here && (!two || here->log_probability > two->log_probability)) two = std::move(here);
  }
  if (two) all.push_back({LoadKind::two_pushes, log_evidence(*two, skin) + kLogOddsOfTwo, two->chi2, {}, -1, two});
}

// What is no load, each linear in its numbers: gap = columns * numbers, numbers of unit deviation.
void LoadEstimator::Parts::add_changes(const SeenCoordinates& seen, const UnloadedChanges& changes,
                                       const Eigen::MatrixXd& whitening, const LinearisedLoads& unloaded,
                                       std::vector<LoadHypothesis>& all) const {
  const auto add = [&](LoadKind kind, const Eigen::MatrixXd& columns, int actuator) {
    const Eigen::MatrixXd white = whitening * columns;
    const Eigen::MatrixXd information =
        white.transpose() * white + Eigen::MatrixXd::Identity(columns.cols(), columns.cols());
    const Eigen::LLT<Eigen::MatrixXd> root(information);
    const Eigen::VectorXd right = white.transpose() * unloaded.gap, numbers = root.solve(right);
    const double chi2 = (unloaded.gap - white * numbers).squaredNorm();
    const double log_evidence =
        -0.5 * (unloaded.gap.squaredNorm() - right.dot(numbers)) - root.matrixLLT().diagonal().array().log().sum();
    all.push_back({kind, log_evidence, chi2, numbers, actuator, {}});
  };
  add(LoadKind::modulus, options.modulus_drift * changes.by_modulus, -1);
  for (Eigen::Index i = 0; i < changes.by_commands.cols(); ++i)
    add(LoadKind::command, options.command_drift * changes.by_commands.col(i), static_cast<int>(i));
  Eigen::MatrixXd rigid(seen.coordinates(), 6);
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& position_m : seen.positions_m) center_m += position_m;
  center_m /= static_cast<double>(seen.positions_m.size());
  for (std::size_t i = 0; i < seen.markers.size(); ++i) {
    auto rows = rigid.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    rows.leftCols<3>() = kFrameShift_m * Eigen::Matrix3d::Identity();
    for (int axis = 0; axis < 3; ++axis)
      rows.col(3 + axis) = kFrameTurn_rad * Eigen::Vector3d::Unit(axis).cross(seen.positions_m[i] - center_m);
  }
  add(LoadKind::frame, rigid, -1);
}

EstimatedLoad LoadEstimator::Parts::describe(const LoadSolution& solution, std::size_t load,
                                             const std::vector<LoadPlace>& places) const {
  const std::vector<PlaceFit> fits = fit_places(solution.linear, without(solution, load, places), places, prior());
  const std::vector<double> probabilities = place_probabilities(fits, places);
  const LoadPlace& chosen = places[solution.loads[load].place];
  EstimatedLoad result;
  if (!chosen.skin) {
    result.marker = model.markers()[static_cast<std::size_t>(chosen.marker)].name();
    result.position_m = chosen.at.at(solution.linear.positions_m);
    result.force_n = solution.loads[load].force_n;
    result.force_covariance_n2 = fits[solution.loads[load].place].covariance_n2;
    result.observable = probabilities[solution.loads[load].place] > 0.9;
    return result;
  }
  // The mean of places around a body lies inside it: the place from which the others are nearest, as they are probable.
  std::vector<std::size_t> likely(places.size());
  std::iota(likely.begin(), likely.end(), std::size_t{0});
  std::stable_sort(likely.begin(), likely.end(),
                   [&](std::size_t a, std::size_t b) { return probabilities[a] > probabilities[b]; });
  likely.resize(std::min(likely.size(), kLikely));
  std::vector<Eigen::Vector3d> at_m;
  for (const std::size_t place : likely) at_m.push_back(places[place].at.at(solution.linear.positions_m));
  double least_m = std::numeric_limits<double>::infinity();
  std::size_t middle = 0;
  for (std::size_t i = 0; i < likely.size(); ++i) {
    double away_m = 0.0;
    for (std::size_t j = 0; j < likely.size(); ++j) away_m += probabilities[likely[j]] * (at_m[i] - at_m[j]).norm();
    if (!(away_m < least_m)) continue;
    least_m = away_m;
    middle = i;
  }
  result.position_m = at_m[middle];
  result.force_n = fits[likely[middle]].force_n;
  for (std::size_t i = 0; i < likely.size(); ++i) {
    const double probability = probabilities[likely[i]];
    const Eigen::Vector3d off_m = at_m[i] - result.position_m, off_n = fits[likely[i]].force_n - result.force_n;
    result.position_covariance_m2 += probability * off_m * off_m.transpose();
    result.force_covariance_n2 += probability * (off_n * off_n.transpose() + fits[likely[i]].covariance_n2);
  }
  result.observable = std::sqrt(std::max(0.0, result.position_covariance_m2.trace())) <= options.observable_m;
  return result;
}

}  // namespace soft_robot_lab
