// SPDX-License-Identifier: BSD-3-Clause
#include "path_run.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

constexpr double kLine_s = 0.012;  // from the host to the motor, at most

std::vector<double> numbers(const Eigen::VectorXd& values) { return {values.data(), values.data() + values.size()}; }

class Run {
 public:
  Run(EmulatedLab& lab, const PathPlan& plan, const PathEyes& eyes) : lab_(lab), plan_(plan), eyes_(eyes), random_(7) {
    for (const PathDrive& drive : plan.drives) names_.push_back(drive.actuator);
  }

  PathRecord go(const FollowOptions& options, const std::vector<double>& rest_commands) {
    lab_.go(names_, rest_commands);
    PathFollower follower(plan_, options);
    lab_.go(names_, numbers(PlayInverse(plan_.drives).go(plan_.samples.front().commands)));
    if (options.feedback) lab_.start_tracking(lab_.plant().markers_m());
    start_s_ = lab_.time_s();
    plant_start_s_ = lab_.plant().present().time_s;
    std::string fault;
    while (record_.last.end == PathEnd::none) {
      const double time_s = lab_.time_s() - start_s_;
      if (options.feedback) look(time_s);
      record_.last = follower.next(time_s, arrived(time_s), fault);
      if (record_.last.end == PathEnd::none || record_.last.end == PathEnd::done)
        lab_.command(names_, numbers(record_.last.commands));
      fault = pass();
      remember();
    }
    return record_;
  }

 private:
  void look(double time_s) {
    const std::optional<Eigen::Vector3d> position_m = see();
    if (!position_m) return;
    record_.seen.time_s.push_back(time_s);
    record_.seen.position_m.push_back(*position_m);
    on_their_way_.push({time_s, *position_m});
  }

  std::optional<Eigen::Vector3d> see() {
    if (eyes_.noise_m) {
      std::normal_distribution<double> noise(0.0, *eyes_.noise_m);
      const Eigen::Vector3d off_m(noise(random_), noise(random_), noise(random_));
      return lab_.plant().markers_m().at(plan_.marker) + off_m;
    }
    const MeasuredMarkers seen_m = lab_.track();
    const auto marker = seen_m.find(plan_.marker);
    if (marker == seen_m.end()) return std::nullopt;
    return eyes_.base_from_measured * marker->second;
  }

  std::optional<StampedMarker> arrived(double time_s) {
    std::optional<StampedMarker> newest;
    while (!on_their_way_.empty() && on_their_way_.front().stamp_s + eyes_.delay_s <= time_s) {
      newest = on_their_way_.front();
      on_their_way_.pop();
    }
    return newest;
  }

  std::string pass() {
    try {
      lab_.wait(1.0 / eyes_.frame_rate_hz);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  void remember() {
    record_.time_s.push_back(lab_.plant().present().time_s - plant_start_s_);
    record_.true_m.push_back(lab_.plant().markers_m().at(plan_.marker));
    record_.target_m.push_back(plan_.target_at(record_.time_s.back()));
  }

  EmulatedLab& lab_;
  const PathPlan& plan_;
  const PathEyes& eyes_;
  std::mt19937_64 random_;
  std::vector<std::string> names_;
  std::queue<StampedMarker> on_their_way_;
  double start_s_ = 0.0, plant_start_s_ = 0.0;
  PathRecord record_;
};

// An L6470 takes no new position while it moves, it brakes first: so many steps it speeds up, turns and brakes for
// between two commands.
double steps_between(const DriveSettings& drive, double period_s) {
  const double left_s = std::max(0.0, period_s - kLine_s);
  const double speed = driven_speed(drive), acceleration = driven_acceleration(drive);
  if (acceleration * left_s < 2.0 * speed) return 0.25 * acceleration * left_s * left_s;
  return speed * left_s - speed * speed / acceleration;
}

}  // namespace

double PathRecord::rms_m() const {
  double squares_m2 = 0.0;
  for (std::size_t i = 0; i < true_m.size(); ++i) squares_m2 += (true_m[i] - target_m[i]).squaredNorm();
  return std::sqrt(squares_m2 / static_cast<double>(true_m.size()));
}

double PathRecord::rms_within_m(const Eigen::Vector3d& normal) const {
  double squares_m2 = 0.0;
  for (std::size_t i = 0; i < true_m.size(); ++i) {
    const Eigen::Vector3d error_m = true_m[i] - target_m[i];
    squares_m2 += (error_m - error_m.dot(normal) * normal).squaredNorm();
  }
  return std::sqrt(squares_m2 / static_cast<double>(true_m.size()));
}

double PathRecord::late_by_s() const {
  double late = 0.0, speeds = 0.0;
  for (std::size_t i = 1; i < true_m.size(); ++i) {
    const Eigen::Vector3d speed_m_s = (target_m[i] - target_m[i - 1]) / std::max(1e-3, time_s[i] - time_s[i - 1]);
    late += (target_m[i] - true_m[i]).dot(speed_m_s);
    speeds += speed_m_s.squaredNorm();
  }
  return speeds > 0.0 ? late / speeds : 0.0;
}

std::vector<PathDrive> drives_of(const RigSettings& rig, const std::map<std::string, double>& backlash_m,
                                 double frame_rate_hz) {
  std::vector<PathDrive> drives;
  for (const MotorSettings& motor : rig.motors) {
    const double steps_per_value = std::abs(motor.steps_per_value);
    const auto backlash = backlash_m.find(motor.name);
    const double play = backlash == backlash_m.end() ? 0.0 : backlash->second / motor.step_m / steps_per_value;
    drives.push_back({motor.name, motor.min_value, motor.max_value,
                      steps_between(motor.drive, 1.0 / frame_rate_hz) * frame_rate_hz / steps_per_value, play});
  }
  return drives;
}

PathRecord run_path(EmulatedLab& lab, const PathPlan& plan, const FollowOptions& options, const PathEyes& eyes,
                    const std::vector<double>& rest_commands) {
  return Run(lab, plan, eyes).go(options, rest_commands);
}

}  // namespace soft_robot_lab
