// SPDX-License-Identifier: BSD-3-Clause
// fidelity_bank FILE [--choices] [SCENE...]: true errors and counted costs of a scene's meshes, and what `fidelity`
// chooses for several tolerances, as a table for fidelity_bank_test. Scenes that are not named keep their rows; with
// --choices true errors are those of the file.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "mechanics/mesh/subdivide.h"
#include "mechanics/simulation/solve_cost.h"
#include "robot/scene/fidelity_bank.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace {

using namespace soft_robot_lab;
using Json = nlohmann::ordered_json;

constexpr double kLargestSize_m = 0.08, kSmaller = 0.84, kMoreNodes = 1.12;
constexpr int kMostSubdivided = 3800;
const std::vector<double> kTolerances_m{0.0001, 0.0003, 0.001, 0.002, 0.005};

struct Solved {
  bool converged = false;
  int nodes = 0;
  double cost_s = 0.0;
  Eigen::Matrix3Xd markers_m;
};

SceneOptions options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = SOFT_ROBOT_LAB_CACHE;
  options.actuator_factory = make_actuator;
  return options;
}

YamlNode scene_of(const BankScene& scene, const std::string& more) {
  return YamlNode::parse(scene.text + more, std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/" + scene.name + ".yaml");
}

Solved solved(Scene scene) {
  Solved result;
  const RunReport report = run_scene(scene);
  result.converged = report.solve.converged;
  result.nodes = scene.simulation->body().mesh().node_count();
  result.cost_s = solve_cost(*scene.simulation->model()).of(report.solve);
  result.markers_m.resize(3, static_cast<Eigen::Index>(scene.simulation->markers().size()));
  for (Eigen::Index i = 0; i < result.markers_m.cols(); ++i)
    result.markers_m.col(i) = scene.simulation->marker_position(static_cast<int>(i));
  return result;
}

Scene with_size(const BankScene& scene, double size_m) {
  SceneOptions sized = options();
  sized.overrides.set({"body", "element_size_m"}, size_m);
  return load_scene(scene_of(scene, ""), sized);
}

double error_m(const Solved& solved, const Eigen::Matrix3Xd& truth_m) {
  return (solved.markers_m - truth_m).colwise().norm().maxCoeff();
}

// What finer meshes lead to: a mesh, the same with every element cut into eight, and the rest of the way by an order
// between 1 and 2. `unsure_m`: half the way between what these orders say.
Eigen::Matrix3Xd truth(const BankScene& scene, double size_m, Json& row) {
  SceneOptions finer = options();
  finer.overrides.set({"body", "element_size_m"}, size_m);
  const Solved finest = solved(load_scene(scene_of(scene, ""), finer));
  finer.change_mesh = [](TetMesh& mesh) {
    complete_boundary(mesh);
    mesh = subdivide(mesh).mesh;
  };
  const Solved beyond = solved(load_scene(scene_of(scene, ""), finer));
  row["reference_nodes"] = beyond.nodes;
  row["reference_converged"] = beyond.converged && finest.converged;
  row["unsure_m"] = error_m(finest, beyond.markers_m) / 3.0;
  return beyond.markers_m + 2.0 / 3.0 * (beyond.markers_m - finest.markers_m);
}

// Scenes at these sizes, the coarsest first.
std::vector<std::pair<double, Solved>> candidates(const BankScene& scene) {
  std::vector<std::pair<double, Solved>> all;
  double last_nodes = 0.0;
  for (double size_m = kLargestSize_m; size_m > 1e-4; size_m *= kSmaller) {
    try {
      Scene sized = with_size(scene, size_m);
      const int nodes = sized.simulation->body().mesh().node_count();
      if (nodes > scene.most_nodes) break;
      if (nodes < kMoreNodes * last_nodes) continue;
      last_nodes = nodes;
      all.emplace_back(size_m, solved(std::move(sized)));
    } catch (const std::invalid_argument& error) {
      std::cerr << scene.name << " at " << size_m << " m: " << error.what() << "\n";
    }
  }
  return all;
}

Json choice(const BankScene& scene, double tolerance_m, const Eigen::Matrix3Xd& truth_m) {
  const std::string wish = "fidelity: {tolerance_m: " + std::to_string(tolerance_m) +
                           ", max_nodes: " + std::to_string(scene.most_nodes) + "}\n";
  Scene chosen = load_scene(scene_of(scene, wish), options());
  const FidelityReport report = *chosen.fidelity;
  Json row;
  row["tolerance_m"] = tolerance_m;
  row["met"] = report.met;
  row["nodes"] = report.nodes;
  if (report.near_buckling) row["near_buckling"] = true;
  row["expected_m"] = report.expected_error_m.value_or(-1.0);
  const Solved result = solved(std::move(chosen));
  row["error_m"] = result.converged ? error_m(result, truth_m) : -1.0;
  row["cost_s"] = result.cost_s;
  row["judging_cost_s"] = report.cost.choosing_s;
  std::cerr << scene.name << " " << row.dump() << "\n";
  return row;
}

Json matrix_json(const Eigen::Matrix3Xd& matrix) {
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}

Eigen::Matrix3Xd matrix_from(const Json& json) {
  const auto numbers = json.get<std::vector<double>>();
  return Eigen::Map<const Eigen::Matrix3Xd>(numbers.data(), 3, static_cast<Eigen::Index>(numbers.size() / 3));
}

void forget_choices() {
  std::filesystem::create_directories(SOFT_ROBOT_LAB_CACHE);
  for (const auto& file : std::filesystem::directory_iterator(SOFT_ROBOT_LAB_CACHE))
    if (file.path().string().find(".fidelity.json") != std::string::npos) std::filesystem::remove(file.path());
}

Json meshes_of(const BankScene& scene) {
  Json row;
  row["name"] = scene.name;
  const std::vector<std::pair<double, Solved>> all = candidates(scene);
  double finest_m = all.front().first;
  for (const auto& [size_m, solved] : all)
    if (solved.nodes <= kMostSubdivided) finest_m = size_m;
  const Eigen::Matrix3Xd truth_m = truth(scene, finest_m, row);
  for (const auto& [size_m, solved] : all)
    if (solved.converged)
      row["meshes"].push_back({{"element_size_m", size_m},
                               {"nodes", solved.nodes},
                               {"error_m", error_m(solved, truth_m)},
                               {"cost_s", solved.cost_s}});
  row["truth_m"] = matrix_json(truth_m);
  return row;
}

void choose(const BankScene& scene, Json& row) {
  row["choices"] = Json::array();
  for (const double tolerance_m : kTolerances_m)
    row["choices"].push_back(choice(scene, tolerance_m, matrix_from(row["truth_m"])));
}

Json read(const std::string& file) {
  std::ifstream stream(file);
  return stream ? Json::parse(stream) : Json{{"scenes", Json::array()}};
}

bool is_named(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "fidelity_bank FILE [SCENE...]\n";
    return 2;
  }
  const std::string file = argv[1];
  const bool choices_alone = argc > 2 && std::string(argv[2]) == "--choices";
  const std::vector<std::string> names(argv + (choices_alone ? 3 : 2), argv + argc);
  Json table = read(file);
  Json& rows = table["scenes"];
  forget_choices();
  for (const BankScene& scene : bank_scenes()) {
    if (!is_named(names, scene.name)) continue;
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Json& r) { return r["name"] == scene.name; });
    if (choices_alone && row == rows.end()) continue;
    if (!choices_alone) {
      const Json measured = meshes_of(scene);
      if (row == rows.end()) row = rows.insert(rows.end(), measured);
      *row = measured;
    }
    choose(scene, *row);
    std::ofstream(file) << table.dump(1) << "\n";
  }
}
