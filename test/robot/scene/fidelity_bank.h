// SPDX-License-Identifier: BSD-3-Clause
// Scenes by which the choice of fidelity is judged: test/data/fidelity_bank.json has their true errors and costs.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace soft_robot_lab {

struct BankScene {
  std::string name;
  std::string text;       // a scene; includes start at config/
  int most_nodes = 5000;  // of the meshes that are tried
};

inline std::string robot_scene(const std::string& robot, const std::string& commands) {
  const std::string include = "include: robots/" + robot + "/robot.yaml\n";
  return commands.empty() ? include : include + "run: {mode: equilibrium, commands: [{time_s: 0, " + commands + "}]}\n";
}

// A bar of 60 x 12 x 12 mm, clamped at x = 0, with two cables.
inline std::string small_bar(const std::string& rest) {
  return R"(body:
  solid: {box: {size_m: [0.06, 0.012, 0.012], center_m: [0.03, 0, 0]}}
  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]
gravity_m_s2: [0, 0, -9.81]
markers: [{name: tip, position_m: [0.06, 0, 0]}, {name: middle, position_m: [0.03, 0, 0]}]
)" + rest;
}

inline std::string small_cables(const std::string& more) {
  const std::string common = ", via_points: given, sheath_radius_m: 0.001, plug_radius_m: 0.003" + more + "}\n";
  return "cables:\n  - {name: up, points_m: [[0, 0, 0.004], [0.06, 0, 0.004]]" + common +
         "  - {name: down, points_m: [[0, 0, -0.004], [0.06, 0, -0.004]]" + common;
}

// A post of 10 x 10 mm, clamped below.
inline std::string post(double height_m, const std::string& rest) {
  std::ostringstream text;
  text << "body:\n  solid: {box: {size_m: [0.01, 0.01, " << height_m << "], center_m: [0, 0, " << 0.5 * height_m
       << "]}}\n"
       << R"(  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.45, density_kg_m3: 1070}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 1.0e-6]}}]
markers: [{name: top, position_m: [0, 0, )"
       << height_m << "]}]\n"
       << rest;
  return text.str();
}

// Of 100 mm under a weight, over that of buckling, pi^2 E I / (4 L^2); and that part of it sideways.
inline std::string loaded_column(double load, double aside = 0.0) {
  constexpr double kBuckles_n = 0.05432;
  std::ostringstream text;
  text << "loads: [{box: {min_m: [-1, -1, 0.099999], max_m: [1, 1, 1]}, force_n: [" << aside * load * kBuckles_n
       << ", 0, " << -load * kBuckles_n << "]}]\n";
  return post(0.1, text.str());
}

// It stands up to a height of 0.118 m (Greenhill 1881).
inline std::string standing_post(double height_m) { return post(height_m, "gravity_m_s2: [0, 0, -9.81]\n"); }

// A bar of 80 x 10 x 10 mm with a cable on each of two sides, both pulled alike.
inline std::string antagonists(double contraction) {
  std::ostringstream text;
  text << R"(body:
  solid: {box: {size_m: [0.08, 0.01, 0.01], center_m: [0.04, 0, 0]}}
  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]
markers: [{name: tip, position_m: [0.08, 0, 0]}]
cables:
  - {name: up, points_m: [[0, 0.003, 0], [0.08, 0.003, 0]], via_points: given, plug_radius_m: 0.002}
  - {name: down, points_m: [[0, -0.003, 0], [0.08, -0.003, 0]], via_points: given, plug_radius_m: 0.002}
run: {commands: [{time_s: 0, up: )"
       << contraction << ", down: " << contraction << "}]}\n";
  return text.str();
}

// A bar of 80 x 12 x 12 mm with a cable near each of its long sides.
inline std::string four_cables(const std::string& commands) {
  std::string text = R"(body:
  solid: {box: {size_m: [0.08, 0.012, 0.012], center_m: [0.04, 0, 0]}}
  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]
markers: [{name: tip, position_m: [0.08, 0, 0]}]
cables:
)";
  const char* const sides[4] = {"0.004, 0", "-0.004, 0", "0, 0.004", "0, -0.004"};
  for (int i = 0; i < 4; ++i)
    text += "  - {name: c" + std::to_string(i) + ", points_m: [[0, " + sides[i] + "], [0.08, " + sides[i] +
            "]], via_points: given, plug_radius_m: 0.002}\n";
  return text + "run: {commands: [{time_s: 0, " + commands + "}]}\n";
}

inline std::vector<BankScene> bank_scenes() {
  return {
      {"hanging_bar", robot_scene("hanging_bar", "cable: 0.95")},
      {"finger_a1", robot_scene("finger_a1", "tendon: 0.85")},
      {"finger_a2", robot_scene("finger_a2", "left: 0.97, upper: 0.93")},
      {"hollow_cuboid", robot_scene("hollow_cuboid", "main: 1.5")},
      {"spinebot", robot_scene("spinebot", "left: 0.9")},
      {"hammerbot", robot_scene("hammerbot", "left: 0.9")},
      {"gripper", robot_scene("gripper", "left: 0.95, right: 0.95")},
      {"tentacle", robot_scene("tentacle", "tendon_1: 1.5")},
      {"bubblefinger", robot_scene("bubblefinger", "")},
      {"cantilever", "include: scenes/cantilever.yaml\n"},
      {"sagging_bar", small_bar("")},
      {"pulled_bar", small_bar(small_cables("") + "run: {commands: [{time_s: 0, up: 0.85}]}\n")},
      {"rubbing_cables",
       small_bar(small_cables(", model: friction, friction_coefficient: 0.3, compliance_m_n: 1.0e-5") +
                 "run: {commands: [{time_s: 0, up: 0.85}]}\n")},
      {"bar_on_cylinder",
       small_bar(
           "contact:\n  friction: 0.3\n  obstacles:\n    - {name: rod, cylinder: {start_m: [0.035, -0.03, -0.012], "
           "end_m: [0.035, 0.03, -0.012], radius_m: 0.005}}\n" +
           small_cables("") + "run: {commands: [{time_s: 0, down: 0.85}]}\n"),
       1000},
      {"column_below_buckling", loaded_column(0.9), 600},
      {"column_beyond_buckling", loaded_column(1.1), 600},
      {"column_far_beyond_buckling", loaded_column(1.5), 600},
      {"column_aside", loaded_column(0.6, 0.02)},
      {"standing_post", standing_post(0.13), 600},
      {"antagonists", antagonists(0.92), 600},
  };
}

}  // namespace soft_robot_lab
