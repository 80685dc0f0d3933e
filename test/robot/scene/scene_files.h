// SPDX-License-Identifier: BSD-3-Clause
// Scene files for tests: a bar of 100 x 20 x 20 mm with two cables, and files written beside it that include it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace soft_robot_lab {

// A folder of its own, removed at the end.
class SceneFolder {
 public:
  SceneFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "scene_test_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    folder_ = name;
    write("bar.yaml", R"(body:
  solid:
    box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0, 0]}
  element_size_m: 0.02
  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]
gravity_m_s2: [0, -9.81, 0]
cables:
  - {name: left, points_m: [[0, -0.007, 0], [0.1, -0.007, 0]], via_points: given, sheath_radius_m: 0.001, plug_radius_m: 0.003}
  - {name: right, points_m: [[0, 0.007, 0], [0.1, 0.007, 0]], via_points: given, sheath_radius_m: 0.001, plug_radius_m: 0.003}
markers:
  - {name: tip, position_m: [0.1, 0, 0]}
  - {name: middle, position_m: [0.05, 0, 0]}
)");
  }
  ~SceneFolder() { std::filesystem::remove_all(folder_); }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    std::ofstream(path(name)) << text;
    return path(name);
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace soft_robot_lab
