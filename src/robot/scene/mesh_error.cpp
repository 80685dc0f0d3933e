// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>

#include "fidelity.h"
#include "mechanics/mesh/subdivide.h"

namespace soft_robot_lab {
namespace {

constexpr double kFirstOrder = 2.0;  // error over difference, where half the size halves the error
// Beyond the finer mesh the way goes on by 1 or by 1 / 3 of the difference, as the order is 1 or 2.
constexpr double kBeyond = 2.0 / 3.0, kUnsure = 1.0 / 3.0;
constexpr std::size_t kMostJudged = 4;  // of a scene's rest states, those that moved furthest
constexpr double kReach = 2.0;          // nodes, over those of the subdivided mesh, up to which it judges others
// An error that much larger than on the subdivided, coarser mesh is another side of a buckled body.
constexpr double kElsewhere = 2.0;
constexpr double kOtherSide = 0.5;  // of the way from the rest shape: two meshes are apart by less
// Newton iterations a stage on the finer mesh, which begins near its rest state: where it needs more, the coarse mesh
// says little about it, and a finer one costs less than insisting.
constexpr int kFineIterations = 8;
constexpr double kFineTolerance = 1e-2;  // of its residual: what is left is far below a mesh's error

YamlNode with_little_effort(const YamlNode& settings) {
  return Overrides().set({"solver", "max_iterations"}, kFineIterations).over(settings);
}

double rms(const Eigen::Matrix3Xd& difference_m) {
  return difference_m.cols() == 0 ? 0.0 : std::sqrt(difference_m.colwise().squaredNorm().mean());
}

double distance(const Eigen::Matrix3Xd& markers_m, const Eigen::Matrix3Xd& probes_m) {
  const double largest = markers_m.cols() == 0 ? 0.0 : markers_m.colwise().norm().maxCoeff();
  return std::max(largest, rms(probes_m));
}

// Places in `all`, in their order.
std::vector<std::size_t> furthest(const JudgedRests& all, const TetMesh& mesh) {
  std::vector<std::size_t> places(all.states.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::stable_sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
    return rms(all.states[a].positions_m - mesh.nodes_m) > rms(all.states[b].positions_m - mesh.nodes_m);
  });
  places.resize(std::min(places.size(), kMostJudged));
  std::sort(places.begin(), places.end());
  return places;
}

// The coarse rest state as a start for the fine mesh, so that a buckled body stays on its side.
SimulationState carried(const SimulationState& coarse, const Subdivision& fine, SimulationState start) {
  start.positions_m = fine.carry(coarse.positions_m);
  start.take_commands(coarse);
  start.constraint_multipliers = coarse.constraint_multipliers;
  const Eigen::VectorXd& multipliers = coarse.element_multipliers_pa;
  if (start.element_multipliers_pa.size() == 8 * multipliers.size())
    for (Eigen::Index i = 0; i < start.element_multipliers_pa.size(); ++i)
      start.element_multipliers_pa[i] = multipliers[i / 8];
  return start;
}

}  // namespace

MeshError MeshJudge::settle(const YamlNode& settings, const TetMesh& mesh) {
  MeshError error;
  if (probes_.empty()) {
    TetMesh whole = mesh;
    complete_boundary(whole);
    probes_ = probes_of(whole);
  }
  scene_.emplace(build_scene(settings, mesh, judgement_.options));
  if (judgement_.options.on_warnings) judgement_.options.on_warnings(scene_->warnings);
  const auto same = [&](const Known& known) {
    return known.nodes_m.cols() == mesh.nodes_m.cols() && known.nodes_m == mesh.nodes_m;
  };
  const auto known = std::find_if(known_.begin(), known_.end(), same);
  rests_ = known != known_.end() ? known->rests : judged_rests(*scene_, probes_, judgement_);
  if (known == known_.end()) known_.push_back({mesh.nodes_m, rests_});
  error.trouble = rests_.trouble;
  return error;
}

std::optional<double> MeshJudge::error_by_reference() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < reference_->numbers.size(); ++i) {
    const auto here = std::find(rests_.numbers.begin(), rests_.numbers.end(), reference_->numbers[i]);
    if (here == rests_.numbers.end()) return std::nullopt;
    const auto at = static_cast<std::size_t>(here - rests_.numbers.begin());
    largest = std::max(largest, reference_->unsure_m[i] + distance(rests_.markers_m[at] - reference_->markers_m[i],
                                                                   rests_.probes_m[at] - reference_->probes_m[i]));
  }
  return largest;
}

// Where this mesh and the one that judges have markers so far apart that no mesh's error explains it.
void MeshJudge::note_other_side(int nodes) {
  for (std::size_t i = 0; reference_ && nodes >= reference_->nodes && i < reference_->numbers.size(); ++i) {
    const auto here = std::find(rests_.numbers.begin(), rests_.numbers.end(), reference_->numbers[i]);
    if (here == rests_.numbers.end()) continue;
    const auto at = static_cast<std::size_t>(here - rests_.numbers.begin());
    const double apart_m =
        distance(rests_.markers_m[at] - reference_->markers_m[i], rests_.probes_m[at] - reference_->probes_m[i]);
    if (apart_m > std::max(kOtherSide * reference_->way_m[i], kElsewhere * reference_->error_m))
      keep_worse({*here, nodes, 0.0, apart_m, 1.0}, near_buckling_);
  }
}

std::optional<MeshJudge::Reference> MeshJudge::subdivided(const YamlNode& settings, const TetMesh& mesh,
                                                          std::string& trouble) {
  trouble = rests_.unseen;
  if (!trouble.empty()) return std::nullopt;
  TetMesh whole = mesh;
  complete_boundary(whole);
  const std::vector<std::size_t> which = furthest(rests_, whole);
  if (const auto snap = snap_of(rests_, mesh.node_count())) keep_worse(*snap, near_buckling_);
  if (!near_buckling_) near_buckling_ = held_little(rests_, which, *scene_->simulation, judgement_);
  if (near_buckling_) {  // a finer mesh would know no more
    trouble = text_of(*near_buckling_);
    return std::nullopt;
  }
  const Subdivision subdivision = subdivide(whole);
  const Scene fine = build_scene(with_little_effort(settings), subdivision.mesh, judgement_.options);
  Simulation& simulation = *fine.simulation;
  const std::vector<Marker> probes = markers_at(probes_, simulation.body().mesh());
  const SolveCost cost = solve_cost(*simulation.model());
  const SimulationState start = simulation.state();
  const Eigen::Matrix3Xd rest_markers_m = positions_of(simulation.markers(), start.positions_m);
  const Eigen::Matrix3Xd rest_probes_m = positions_of(probes, start.positions_m);
  Reference reference;
  reference.nodes = mesh.node_count();
  for (const std::size_t at : which) {
    simulation.set_state(carried(rests_.states[at], subdivision, start));
    EquilibriumOptions roughly;
    roughly.tolerance = kFineTolerance;
    const SolveReport report = simulation.solve_equilibrium(roughly);
    judgement_.count(cost, report);
    if (!report.converged) {
      trouble = "no rest state on the finer mesh: " + report.message;
      return std::nullopt;
    }
    trouble = unseen_obstacle(report.warnings);
    if (!trouble.empty()) return std::nullopt;
    if (const double moved_m = snapped_m(report.warnings); moved_m > 0.0)
      keep_worse({rests_.numbers[at], subdivision.mesh.node_count(), moved_m, 0.0, 1.0}, near_buckling_);
    const Eigen::Matrix3Xd markers_m = positions_of(simulation.markers(), simulation.state().positions_m);
    const Eigen::Matrix3Xd probes_m = positions_of(probes, simulation.state().positions_m);
    const Eigen::Matrix3Xd of_markers = markers_m - rests_.markers_m[at], of_probes = probes_m - rests_.probes_m[at];
    reference.numbers.push_back(rests_.numbers[at]);
    reference.markers_m.emplace_back(markers_m + kBeyond * of_markers);
    reference.probes_m.emplace_back(probes_m + kBeyond * of_probes);
    reference.unsure_m.push_back(kUnsure * distance(of_markers, of_probes));
    reference.way_m.push_back(distance(markers_m - rest_markers_m, probes_m - rest_probes_m));
    reference.error_m = std::max(reference.error_m, kFirstOrder * distance(of_markers, of_probes));
  }
  return reference;
}

MeshError MeshJudge::judge(const YamlNode& settings, const TetMesh& mesh, double enough_m) {
  MeshError error = settle(settings, mesh);
  if (!error.trouble.empty()) return error;
  if (reference_) error.expected_m = error_by_reference();
  note_other_side(mesh.node_count());
  if (error.expected_m && *error.expected_m <= enough_m) return error;
  const bool finer = reference_ && mesh.node_count() > reference_->nodes;
  const bool elsewhere = finer && error.expected_m && *error.expected_m > kElsewhere * reference_->error_m;
  if (error.expected_m && !elsewhere && mesh.node_count() < kReach * reference_->nodes) return error;
  std::string trouble;
  if (std::optional<Reference> own = subdivided(settings, mesh, trouble)) {
    if (!error.expected_m || elsewhere) error.expected_m = own->error_m;
    reference_ = std::move(own);
  } else if (error.expected_m) {
    reference_->nodes = mesh.node_count();  // it has to serve further
  } else {
    error.trouble = trouble;
  }
  return error;
}

bool MeshJudge::contradicted(const YamlNode& settings, const TetMesh& mesh) {
  if (!reference_ || !settle(settings, mesh).trouble.empty()) return false;
  note_other_side(mesh.node_count());
  return error_by_reference().value_or(0.0) > reference_->error_m;
}

MeshError MeshJudge::look_ahead(const YamlNode& settings, const TetMesh& mesh) {
  MeshError error = settle(settings, mesh);
  std::optional<Reference> own;
  if (error.trouble.empty()) own = subdivided(settings, mesh, error.trouble);
  if (!own) return error;
  error.expected_m = own->error_m;
  reference_ = std::move(own);
  return error;
}

}  // namespace soft_robot_lab
