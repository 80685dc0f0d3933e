// SPDX-License-Identifier: BSD-3-Clause
// Where methods fail: every method in every hard case, for every body of the chart.
#pragma once

#include <functional>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "session/report/plot.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

enum class Outcome {
  survived,   // every solve converged, no element is inverted at the end, the markers are in the right place, the
              // ledger of energy closes, and the swing does not grow
  recovered,  // the same at the end, but on the way a solve failed, or the start was no shape at all
  reported,   // failed, and said so: a solve did not converge, or the scene was warned that it locks
  too_slow,   // no failure, but not done within the limit of CPU time
  silent,     // failed without a word: what survived asks for is not there, though the solver called it converged
              // and nothing warned that the scene locks
  not_finite  // NaN or infinity left the solver
};
inline constexpr int kOutcomes = 6;
const char* name_of(Outcome outcome);
inline bool is_good(Outcome outcome) { return outcome == Outcome::survived || outcome == Outcome::recovered; }

struct StabilityBody {
  std::string name;
  std::string scene;     // file below config/
  Overrides overrides;   // over it
  bool chamber = false;  // driven by a chamber's beta; else by cables
  // Where obstacles come near: the middle of what may move, and from there along y to the skin.
  Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
  double half_depth_m = 0.0;
};

struct StabilityMethod {
  std::string name;
  Overrides body_overrides;      // over the scene: another element
  Overrides solver_overrides;    // the same, without which the default solver works on the same elements
  bool equilibrium = false;      // rest state at once; else in time
  bool ours = false;             // the default solver, which must not fail
  Overrides cable_changes{};     // over each cable
  Overrides chamber_changes{};   // over each chamber
  double duration_s = 2.0;       // in time: in which a body must have recovered
  double cpu_limit_s = 60.0;     // of a cell
  bool meets_obstacles = false;  // besides the default solver, which does

  const Overrides& drive_changes(const StabilityBody& body) const {
    return body.chamber ? chamber_changes : cable_changes;
  }
};

// What all bodies and methods go through. Commands are given at once, actuator by actuator; the rest stay at rest. No
// commands for a kind of body: the case is not for it.
struct HardCase {
  std::string name;
  std::vector<double> contractions;
  std::vector<double> betas;
  Overrides overrides;      // over the scene
  Overrides drive_changes;  // over each cable or chamber
  // Over the scene: obstacles, for methods that meet them.
  std::function<Overrides(const StabilityBody&)> touches = nullptr;
  bool unique = true;  // false: there are several rest states; any stable one without inverted elements counts
  std::function<void(TetMesh&)> change_mesh = nullptr;
  std::function<void(const Body&, Eigen::Matrix3Xd&)> start_from = nullptr;  // moves the nodes before the start

  const std::vector<double>& commands(const StabilityBody& body) const { return body.chamber ? betas : contractions; }
};

// Whether there is such a square: another coupling of cables is for bodies with cables.
bool fits(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case);

// The lists of the chart (src/study/charts/stability_lists.cpp): a body, a method or a case more is one entry there.
// `quick`: coarse bodies where these bear all cases, fewer cases, and our solver alone: the others take ten times as
// long.
std::vector<StabilityBody> stability_bodies(bool quick);
std::vector<StabilityMethod> stability_methods(bool quick = false);
std::vector<HardCase> hard_cases(bool quick);

struct StabilityCell {
  std::string body, method, hard_case;
  bool ours = false;
  Outcome outcome = Outcome::reported;
  int solves = 0, failed_solves = 0;
  double off_m = 0.0;  // of the marker that is furthest from where the careful path leads
  double cpu_s = 0.0;
  // Over the energy turned over; none where no ledger is kept.
  std::optional<double> closure, integrator;
  std::string message;  // what is wrong, or why the last solve failed that did
};

// Runs cells. References, which the methods of a case share, are kept.
class StabilityBench {
 public:
  // `options`: how scenes are loaded; `config_folder`: where the bodies' scenes are.
  StabilityBench(SceneOptions options, std::string config_folder);

  StabilityCell run(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case);

 private:
  struct Reference {
    std::string key;
    bool found = false;
    Eigen::Matrix3Xd markers_m;
  };
  using Track = std::vector<Eigen::Matrix3Xd>;  // where the markers are, step by step
  Scene load(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case) const;
  const Reference& reference(const StabilityBody& body, const HardCase& hard_case);
  static bool go_through(const StabilityMethod& method, Simulation& simulation, Track& track, StabilityCell& cell,
                         SolveReport& last);
  // The end of the run, its ledger, its swing: of a run that converged.
  void judge(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case, const Simulation& end,
             const Track& track, StabilityCell& cell);
  // Empty, or what is wrong with where it rests.
  std::string judge_place(const StabilityBody& body, const HardCase& hard_case, const Simulation& resting,
                          StabilityCell& cell);

  SceneOptions options_;
  std::string config_folder_;
  std::vector<Reference> references_;
};

// A grid of squares coloured by outcome: cases along x, body and method along y.
Plot stability_plot(const std::vector<StabilityCell>& cells);

// A table with one line a cell; and back, throwing std::invalid_argument.
std::string stability_csv(const std::vector<StabilityCell>& cells);
std::vector<StabilityCell> read_stability_csv(std::istream& file);

}  // namespace soft_robot_lab
