// SPDX-License-Identifier: BSD-3-Clause
#include "speed_runs_file.h"

#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "settings/write_file.h"

namespace soft_robot_lab {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SpeedRun, problem, poissons_ratio, rung, mode, bullet, size_m, nodes, elements,
                                   ended, error, curve, cost, cpu_s, iterations, frequency_error, message)

void write_runs(const std::string& path, const std::vector<SpeedRun>& runs) {
  write_file(path, nlohmann::json(runs).dump(1) + "\n");
}

std::vector<SpeedRun> read_runs(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  try {
    return nlohmann::json::parse(file).get<std::vector<SpeedRun>>();
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace soft_robot_lab
