// Where methods fail: every method in every hard case, for every body of the chart.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "soft_robot_lab/scene/scene.h"

namespace soft_robot_lab {

enum class Outcome {
  survived,   // every solve converged, no element is inverted at the end, and the markers are in the right place
  recovered,  // the same at the end, but on the way a solve failed, or the start was not a shape at all
  reported,   // failed, and said so
  silent,     // failed without a word: inverted elements, or markers in the wrong place, called converged
  not_finite  // NaN or infinity left the solver
};
inline constexpr int kOutcomes = 5;
const char* name_of(Outcome outcome);
inline bool is_good(Outcome outcome) { return outcome == Outcome::survived || outcome == Outcome::recovered; }

struct StabilityBody {
  std::string name;
  std::string scene;  // file below config/
};

struct StabilityMethod {
  std::string name;
  std::string changes;       // YAML over the scene
  bool equilibrium = false;  // rest state at once; else 2 s in time
  bool ours = false;         // the default solver, which must not fail
};

struct HardCase {
  std::string name;
  std::string changes;         // YAML over the scene
  std::string cable_changes;   // YAML over each of its cables
  std::vector<double> pulls;   // contraction commanded at once, cable by cable; the others stay at rest
  bool unique = true;          // false: several rest states; any stable one counts
  std::function<void(TetMesh&)> change_mesh = nullptr;  // may be empty
  std::function<void(const Body&, Eigen::Matrix3Xd&)> start_from = nullptr;  // moves the nodes before the start; may be empty
};

// The lists of the chart (src/experiment/stability_lists.cpp). A body, a method or a case more is one line there.
std::vector<StabilityBody> stability_bodies();
std::vector<StabilityMethod> stability_methods();
std::vector<HardCase> hard_cases();

struct StabilityCell {
  std::string body, method, hard_case;
  bool ours = false;
  Outcome outcome = Outcome::reported;
  int failed_solves = 0, solves = 0;
  double off_m = 0.0;   // of the marker that is furthest from its place; 0 where there is no one place
  double cpu_s = 0.0;
  std::string message;  // of the last solve that failed, or what is wrong
};

// Runs cells. References, which several methods of a case share, are kept.
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
  Scene load(const StabilityBody& body, const StabilityMethod& method, const HardCase& hard_case) const;
  const Reference& reference(const StabilityBody& body, const HardCase& hard_case);

  SceneOptions options_;
  std::string config_folder_;
  std::vector<Reference> references_;
};

}  // namespace soft_robot_lab
