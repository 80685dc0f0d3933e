// SPDX-License-Identifier: BSD-3-Clause
#include "creep_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "drive_play.h"
#include "pose_model.h"
#include "simulated_now.h"

namespace soft_robot_lab {
namespace {

// Creep is slow but where a command came just now: a strain counts as growing evenly over a step. Until then the
// scene's own steps follow a robot on its way and how it comes to rest, as friction remembers that.
constexpr double kSoon_s = 0.4, kLongStep_s = 0.25;

// The same robot in the scene's own steps and in long ones.
class TwoPaces {
 public:
  TwoPaces(const std::string& scene, const SceneOptions& options)
      : short_(load_scene(scene, options)), long_(load_in_long_steps(scene, options)) {
    const SolveReport rest = robot().solve_equilibrium();
    if (!rest.converged) throw std::runtime_error("creep starts from no rest: " + rest.message);
  }

  Simulation& robot() { return *short_.simulation; }

  SimulatedHold hold(const std::vector<double>& commands, double duration_s) {
    SimulatedHold hold{{0.0}, {places(robot())}};
    for (std::size_t i = 0; i < commands.size(); ++i) robot().set_command(robot().actuators()[i]->name(), commands[i]);
    pass(robot(), duration_s, kSoon_s, hold);
    long_.simulation->set_state(robot().state());
    pass(*long_.simulation, duration_s, duration_s, hold);
    robot().set_state(long_.simulation->state());
    return hold;
  }

 private:
  static Scene load_in_long_steps(const std::string& scene, SceneOptions options) {
    options.overrides.set({"solver", "time_step_s"}, kLongStep_s);
    return load_scene(scene, options);
  }

  // Until the end, or so long after the drives stood.
  static void pass(Simulation& robot, double end_s, double after_s, SimulatedHold& hold) {
    const double step_s = robot.options().time_step_s;
    while (hold.times_s.back() < std::min(end_s, hold.arrived_s + after_s) - 1e-9) {
      const SolveReport report = robot.step();
      if (!report.converged) throw std::runtime_error("a step of creep does not converge: " + report.message);
      hold.times_s.push_back(hold.times_s.back() + step_s);
      hold.markers_m.push_back(places(robot));
      if (!all_arrived(robot)) hold.arrived_s = hold.times_s.back();
    }
  }

  Scene short_, long_;
};

}  // namespace

Eigen::Vector3d SimulatedHold::at(int marker, double time_s) const {
  const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  if (after == times_s.end()) return markers_m.back().col(marker);
  if (after == times_s.begin()) return markers_m.front().col(marker);
  const auto next = static_cast<std::size_t>(after - times_s.begin());
  const double u = (time_s - times_s[next - 1]) / (times_s[next] - times_s[next - 1]);
  return (1.0 - u) * markers_m[next - 1].col(marker) + u * markers_m[next].col(marker);
}

Eigen::Vector3d SimulatedHold::mean(int marker, double from_s, double to_s) const {
  const int parts = std::max(1, static_cast<int>(std::ceil((to_s - from_s) / kLongStep_s)));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < parts; ++i) sum += at(marker, from_s + (i + 0.5) / parts * (to_s - from_s));
  return sum / parts;
}

std::vector<SimulatedHold> simulate_holds(const std::string& scene, const SceneOptions& options,
                                          const std::vector<MeasuredPose>& poses,
                                          const std::map<std::string, double>& backlash_m) {
  TwoPaces paces(scene, options);
  DrivePlay play(paces.robot(), backlash_m);
  play.go(commands_of(paces.robot(), MeasuredPose{}));
  std::vector<SimulatedHold> holds;
  for (const MeasuredPose& pose : poses)
    holds.push_back(paces.hold(play.go(commands_of(paces.robot(), pose)).commands, pose.held_s));
  return holds;
}

}  // namespace soft_robot_lab
