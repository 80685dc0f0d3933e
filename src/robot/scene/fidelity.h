// SPDX-License-Identifier: BSD-3-Clause
// The parts of the fidelity estimate. Read choose_fidelity.cpp first.
//
// Mesh error. A scene is settled on its mesh, and again, from there, on the same mesh with every element cut into eight
// (subdivide.h). With errors of order h^p the finer mesh has 2^-p of the error, so the error is the difference times
// 1 / (1 - 2^-p). p = 1, hence twice the difference, is what the robots show, with their re-entrant edges and
// cables that enter over a millimetre; smooth bodies have p = 2, for which twice is 1.5 times too much.
//
// Measured: estimate over error, where the error is the difference to two subdivisions and, beyond them, what the
// observed order leaves. (None was observed for Hammerbot at 20 %: it has buckled sideways, and the mesh decides how
// far.)
//
//   cantilever (R1), 254 elements, Poisson's ratio 0.3 / 0.499    1.6 / 1.9
//   Cook's membrane (R2), 867 elements                            0.7
//   bar with a cable (R5), 247 elements, 10 % pull                1.3
//   Spinebot, 549 elements, 5 / 10 / 20 % pull                    1.0 / 1.0 / 1.2
//   Hammerbot, 400 elements, 5 / 10 / 20 % pull                   1.0 / 0.7 / 1.8
//
// What the subdivision says, extrapolated between p = 1 and p = 2, judges other meshes too, so that most rungs of the
// ladder cost one solve of their own. Only a mesh with twice the nodes is subdivided again. The first to be
// subdivided has 300 nodes or more: coarser ones do not see a cable's plug, nor does their subdivision. Hanging bar and
// finger A.1 seemed to be within 1.3 and 1.6 mm by their own subdivisions, on 57 and 254 nodes, and were 2.2 and 4.3 mm
// off. Where a mesh of three times its nodes lies farther from what it leads to than it does itself, that one is
// subdivided in its place, as on the tentacle, whose 637 nodes led 4 mm astray.
//
// Others were tried and left. One pressure per element against four, on one mesh, do not always bracket the truth: on
// the bar they differ by a third of the error, and on Spinebot the truth lies on the other side of the first; Newton
// needs 20 to 400 iterations for the second. Two meshes of sizes h and 0.7 h: where small features rule, the mesher
// makes nearly the same mesh for both, and what differs is chance.
//
// Element: quadratic at any Poisson's ratio. At 0.3, where nothing locks, the cantilever is 8.6 % off on 1345 nodes of
// linear elements, 1.4 % on 579 nodes of quadratic ones. Method: newton, or a reduced model of it. A Newton iteration
// takes 0.04 s of CPU on 3600 nodes, 1.3 s on 25 000, 2.2 s on 54 000 and 12 s on 83 000 (which depends on the shape),
// so that within the limit on nodes there is no mesh where xpbd, 10 to 25 times slower on robots, would gain.
//
// Costs are counted (solve_cost.h), never timed: a choice must not hang on what else a machine does.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sections.h"
#include "mechanics/simulation/solve_cost.h"
#include "robot/design/content_cache.h"
#include "soft_robot_lab/robot/scene/fidelity.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {

// Where estimates and reduced models are kept.
inline ContentCache cache_of(const SceneOptions& options) {
  return ContentCache(cache_folder(mesher_options(options)));
}

inline bool moves(FidelityUse use) { return use == FidelityUse::motion || use == FidelityUse::live; }

struct FidelityRequest {
  double tolerance_m = 0.0;  // > 0
  int max_nodes = 5000;      // [100, 20000]; the estimate's own mesh has up to eight times as many
  FidelityUse use = FidelityUse::rest;
  double real_time = 1.0;  // (0, 1000]; of `live`
};

// `fidelity`; refuses keys in `body` and `solver` that it would choose itself, unless they come from an included file.
std::optional<FidelityRequest> read_fidelity(const YamlNode& scene);

// What a scene is judged for, and what that has cost.
struct Judgement {
  const YamlNode& settings;
  const SceneOptions& options;
  FidelityUse use = FidelityUse::rest;
  double cost_s = 0.0;  // counted, of all solves until now

  // Throws where the solve ended as it was asked to: nothing that follows from it would be true.
  double count(const SolveCost& cost, const SolveReport& report) {
    if (report.interrupted) refuse_interrupted(options);
    cost_s += cost.of(report);
    return cost.of(report);
  }
};

// What the scene is judged at: rest states, each the commands of all actuators in their order. Those of its run; where
// it has none, as a robot file may, each cable's contraction and each chamber's amount of gas by a fifth, one at a
// time. For `search` and `live` also places within the actuators' ranges.
std::vector<std::vector<double>> judged_commands(const Simulation& simulation, const RunSettings& run, FidelityUse use);

// Places on the skin that are compared beside the markers: a marker may stand where a difference happens to pass
// through zero.
std::vector<Eigen::Vector3d> probes_of(const TetMesh& mesh);
std::vector<Marker> markers_at(const std::vector<Eigen::Vector3d>& places_m, const TetMesh& mesh);
Eigen::Matrix3Xd positions_of(const std::vector<Marker>& markers, const Eigen::Matrix3Xd& nodes_m);

// The rest states that a scene is judged at, on one mesh.
struct JudgedRests {
  std::vector<int> numbers;  // of judged_commands(): the states found, in their order
  std::vector<SimulationState> states;
  std::vector<Eigen::Matrix3Xd> markers_m, probes_m;  // of each state
  std::vector<bool> skin_overlaps;                    // in each state, where the scene lists no such contact
  std::vector<double> snapped_m;                      // on the way to each, as the solver warns
  SolveCost solve;                                    // on this mesh
  double cost_s = 0.0;                                // counted, of one of them in the mean
  std::string trouble;  // which was not found; all but those of `search` and `live` are needed
  std::string unseen;   // at one of them: an obstacle that the contact points of this mesh do not see
};
JudgedRests judged_rests(Scene& scene, const std::vector<Eigen::Vector3d>& probes, Judgement& judgement);

// An obstacle in the silicone, between contact points; else empty.
std::string unseen_obstacle(const std::vector<SolveWarning>& warnings);

std::string text_of(const NearBuckling& sign);
void keep_worse(const NearBuckling& sign, std::optional<NearBuckling>& worst);
double snapped_m(const std::vector<SolveWarning>& warnings);  // the largest; 0: it did not
// Signs of buckling; none where there is none. `which`: places in `rests`, which was judged on this simulation's mesh;
// its state and commands change.
std::optional<NearBuckling> snap_of(const JudgedRests& rests, int nodes);
std::optional<NearBuckling> held_little(const JudgedRests& rests, const std::vector<std::size_t>& which,
                                        Simulation& simulation, Judgement& judgement);

struct MeshError {
  std::optional<double> expected_m;
  std::string trouble;  // why there is none
};

// Judges meshes of one scene, from coarse to fine. The largest distance of a marker counts, or the root mean square
// over the probes where that is more.
class MeshJudge {
 public:
  explicit MeshJudge(Judgement& judgement) : judgement_(judgement) {}

  // Of the scene on this mesh. Where the error by the meshes before is within `enough_m`, that will do. What is
  // stated hangs on the meshes that were judged before, never on `enough_m`.
  MeshError judge(const YamlNode& settings, const TetMesh& mesh, double enough_m);
  // Judges coarser meshes by this one; returns its error.
  MeshError look_ahead(const YamlNode& settings, const TetMesh& mesh);
  // Whether a far finer mesh seems to be worse than the one that judges: then that one says little.
  bool contradicted(const YamlNode& settings, const TetMesh& mesh);
  const JudgedRests& rests() const { return rests_; }  // on the last mesh
  // The worst sign of it on the meshes that judge, and on those that were cut for them.
  const std::optional<NearBuckling>& near_buckling() const { return near_buckling_; }

 private:
  // What the finest mesh until now says of the rest states.
  struct Reference {
    int nodes = 0;  // of the mesh that was subdivided for it
    std::vector<int> numbers;
    std::vector<Eigen::Matrix3Xd> markers_m, probes_m;
    std::vector<double> unsure_m, way_m;  // the second: from the rest shape
    double error_m = 0.0;                 // of that mesh
  };
  struct Known {
    Eigen::Matrix3Xd nodes_m;
    JudgedRests rests;
  };
  MeshError settle(const YamlNode& settings, const TetMesh& mesh);
  std::optional<double> error_by_reference() const;
  void note_other_side(int nodes);
  std::optional<Reference> subdivided(const YamlNode& settings, const TetMesh& mesh, std::string& trouble);

  Judgement& judgement_;
  std::vector<Eigen::Vector3d> probes_;
  std::optional<Reference> reference_;
  JudgedRests rests_;
  std::optional<Scene> scene_;  // on the last mesh
  std::vector<Known> known_;    // a mesh that is looked at twice is solved once
  std::optional<NearBuckling> near_buckling_;
};

struct TimeError {
  double error_m = 0.0;        // of the time step
  double amplification = 1.0;  // >= 1: how much more a mesh error shows in motion than at rest
  std::optional<TimeStepChoice> choice;
  SolveReport counts;      // of the judged stretch with that step
  double stretch_s = 0.0;  // its length; 0: nothing was judged
  std::string trouble;     // empty, or why there is no estimate
};

// Of the first seconds of a scene's motion (kStretch_s in time_error.cpp), on this mesh: step h against h / 2. Where no
// run moves it, it goes to the judged commands one after the other. `rest_error_m`: of this mesh at rest.
TimeError estimate_time_error(const YamlNode& settings, const TetMesh& mesh, double rest_error_m, Judgement& judgement);
// Whether a motion of so many seconds has taken more solves than the choice allows.
using TooDear = std::function<bool(const SolveReport& counts, double duration_s)>;
// The longest step, of implicit Euler or BDF2, whose error is within the tolerance; else the most exact that is not too
// dear.
TimeError choose_time_step(const YamlNode& settings, const TetMesh& mesh, double rest_error_m, double tolerance_m,
                           const TooDear& too_dear, Judgement& judgement);
// That stretch as the settings solve it: the markers at the start and after each step.
std::vector<Eigen::Matrix3Xd> judged_motion(const YamlNode& settings, const TetMesh& mesh, Judgement& judgement,
                                            std::string& trouble);

// What contact of skin with skin would change, at the rest states that a scene is judged at; where it is left out and
// skin is in other silicone there. `rests`: without it.
std::optional<PartEffect> contact_effect(const YamlNode& settings, const TetMesh& mesh, const JudgedRests& rests,
                                         Judgement& judgement);
Overrides self_contact();

// What each optional part of the scene changes, each switched off once. `rests`: with all of them.
std::vector<PartEffect> part_effects(const YamlNode& settings, const TetMesh& mesh, const JudgedRests& rests,
                                     Judgement& judgement);

// Kept by content beside the meshes.
std::optional<FidelityReport> find_fidelity(const std::string& key, const SceneOptions& options);
void keep_fidelity(const std::string& key, const FidelityReport& report, const SceneOptions& options);

// What the scene does not ask for, and so does not pay for.
std::vector<std::string> left_out(const YamlNode& settings, bool dynamic);

// Chooses and judges, or only judges; none where neither is asked for. Throws SettingsError.
std::optional<FidelityReport> settle_fidelity(const YamlNode& settings, const SceneOptions& options);

const char* name_of(Integrator integrator);  // as a scene names it
const char* name_of(FidelityUse use);

Overrides overrides_of(const FidelityChoice& choice);
Overrides overrides_of(const TimeStepChoice& choice);

}  // namespace soft_robot_lab
