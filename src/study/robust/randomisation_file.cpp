// SPDX-License-Identifier: BSD-3-Clause
#include "randomisation_file.h"

#include "robot/scene/parameters.h"

namespace soft_robot_lab {
namespace {

bool begins(const std::string& name, const std::string& with) { return name.rfind(with, 0) == 0; }

}  // namespace

Randomisation read_randomisation(const std::string& path, const std::string& robot) {
  const YamlNode file = YamlNode::load_file(path);
  Randomisation random;
  random.study.scene = robot;
  random.study.method = SamplingMethod::latin_hypercube;
  random.study.samples = file.integer_or("samples", 30, 2, 10000);
  random.study.seed = file.integer_or("seed", 1, 1, 1000000);
  const YamlNode scene = load_settings(robot);
  const auto of_no_file = [](const std::string& name) {
    return begins(name, "backlash_m.") || begins(name, "camera_to_base.");
  };
  for (StudyParameter& parameter : read_study_parameters(file, random.study.method, scene, of_no_file)) {
    if (begins(parameter.name, "backlash_m."))
      random.drives.push_back(std::move(parameter));
    else if (begins(parameter.name, "camera_to_base."))
      random.cameras.push_back(std::move(parameter));
    else
      random.study.parameters.push_back(std::move(parameter));
  }
  file.require_all_read();
  return random;
}

}  // namespace soft_robot_lab
