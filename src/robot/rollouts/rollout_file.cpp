// SPDX-License-Identifier: BSD-3-Clause
#include "rollout_file.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "npz.h"

namespace soft_robot_lab {
namespace {

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) {
    if constexpr (std::is_same_v<Named, Marker>) {
      names.push_back(one.name());
    } else {
      names.push_back(one->name());
    }
  }
  return names;
}

bool stayed_reduced(const Scene& scene, const RunReport& report) {
  return scene.reduction && !report.left_reduced && !report.audits.failed;
}

// The numbers of all times, one after the other.
struct Columns {
  std::vector<double> commands, reached, markers_m;
  std::vector<bool> converged, reduced;

  void add(const RunReport& report, bool stayed) {
    for (const Eigen::Matrix2Xd& at : report.trajectory.commands) {
      const Eigen::VectorXd commanded = at.row(0), there = at.row(1);
      commands.insert(commands.end(), commanded.data(), commanded.data() + commanded.size());
      reached.insert(reached.end(), there.data(), there.data() + there.size());
    }
    for (const Eigen::Matrix3Xd& at : report.trajectory.markers_m)
      markers_m.insert(markers_m.end(), at.data(), at.data() + at.size());
    converged.push_back(report.solve.converged);
    reduced.push_back(stayed);
  }
};

// Of one marker.
nlohmann::ordered_json places_json(Eigen::Index marker, const std::vector<RunReport>& reports) {
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero(), least_m = Eigen::Vector3d::Zero(), largest_m = least_m;
  int count = 0;
  for (const RunReport& report : reports)
    for (const Eigen::Matrix3Xd& at : report.trajectory.markers_m) {
      const Eigen::Vector3d position_m = at.col(marker);
      sum_m += position_m;
      least_m = count == 0 ? position_m : least_m.cwiseMin(position_m);
      largest_m = count == 0 ? position_m : largest_m.cwiseMax(position_m);
      ++count;
    }
  const auto list = [](const Eigen::Vector3d& position_m) {
    return nlohmann::json{position_m.x(), position_m.y(), position_m.z()};
  };
  return {{"mean_m", list(sum_m / std::max(1, count))}, {"least_m", list(least_m)}, {"largest_m", list(largest_m)}};
}

}  // namespace

std::string rollouts_json(const Scene& scene, const std::vector<RunReport>& reports) {
  int run = 0, converged = 0, reduced = 0;
  for (const RunReport& report : reports) {
    if (report.trajectory.time_s.empty()) continue;
    ++run;
    converged += report.solve.converged ? 1 : 0;
    reduced += stayed_reduced(scene, report) ? 1 : 0;
  }
  nlohmann::ordered_json result = {{"rollouts", run}, {"converged", converged}, {"reduced", reduced}};
  const std::vector<std::string> markers = names_of(scene.simulation->markers());
  for (std::size_t m = 0; m < markers.size(); ++m)
    result["markers"][markers[m]] = places_json(static_cast<Eigen::Index>(m), reports);
  return result.dump(2) + "\n";
}

std::string rollouts_npz(const Scene& scene, const std::vector<RunReport>& reports) {
  const std::vector<std::string> actuators = names_of(scene.simulation->actuators());
  const std::vector<std::string> markers = names_of(scene.simulation->markers());
  Columns columns;
  std::vector<double> time_s;
  for (const RunReport& report : reports) {
    if (report.trajectory.time_s.empty()) continue;
    time_s = report.trajectory.time_s;
    columns.add(report, stayed_reduced(scene, report));
  }
  const std::size_t rollouts = columns.converged.size(), times = time_s.size();
  return npz({words_array("actuators", actuators), words_array("markers", markers),
              numbers_array("time_s", {times}, time_s),
              numbers_array("commands", {rollouts, times, actuators.size()}, columns.commands),
              numbers_array("reached", {rollouts, times, actuators.size()}, columns.reached),
              numbers_array("markers_m", {rollouts, times, markers.size(), 3}, columns.markers_m),
              flags_array("converged", columns.converged), flags_array("reduced", columns.reduced)});
}

}  // namespace soft_robot_lab
