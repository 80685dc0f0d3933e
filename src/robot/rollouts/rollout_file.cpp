// SPDX-License-Identifier: BSD-3-Clause
#include "rollout_file.h"

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

// The numbers of all times, one after the other.
struct Columns {
  std::vector<double> commands, reached, markers_m;
  std::vector<bool> converged, reduced;

  void add(const RunReport& report, bool has_reduced) {
    for (const Eigen::Matrix2Xd& at : report.trajectory.commands) {
      const Eigen::VectorXd commanded = at.row(0), there = at.row(1);
      commands.insert(commands.end(), commanded.data(), commanded.data() + commanded.size());
      reached.insert(reached.end(), there.data(), there.data() + there.size());
    }
    for (const Eigen::Matrix3Xd& at : report.trajectory.markers_m)
      markers_m.insert(markers_m.end(), at.data(), at.data() + at.size());
    converged.push_back(report.solve.converged);
    reduced.push_back(has_reduced && !report.left_reduced && !report.audits.failed);
  }
};

}  // namespace

std::string rollouts_npz(const Scene& scene, const std::vector<RunReport>& reports) {
  const std::vector<std::string> actuators = names_of(scene.simulation->actuators());
  const std::vector<std::string> markers = names_of(scene.simulation->markers());
  Columns columns;
  std::vector<double> time_s;
  for (const RunReport& report : reports) {
    if (report.trajectory.time_s.empty()) continue;
    time_s = report.trajectory.time_s;
    columns.add(report, scene.reduction != nullptr);
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
