// SPDX-License-Identifier: BSD-3-Clause
#include "walk.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <future>
#include <mutex>
#include <optional>
#include <stdexcept>

#include <Eigen/SVD>

#include "starts.h"

namespace soft_robot_lab {
namespace {

constexpr double kLongestStage = 0.1;  // of a command's range: a longer way is followed in stages
constexpr int kCuts = 3;               // a stage is halved so often before the body counts as buckled

using StatePointer = std::shared_ptr<const SimulationState>;

void set_commands(Simulation& simulation, const Eigen::VectorXd& commands) {
  for (Eigen::Index i = 0; i < commands.size(); ++i)
    simulation.set_command(simulation.actuators()[static_cast<std::size_t>(i)]->name(), commands[i]);
}

Eigen::VectorXd commands_of(const SimulationState& state) {
  const std::vector<double> commands = state.commands();
  return Eigen::Map<const Eigen::VectorXd>(commands.data(), static_cast<Eigen::Index>(commands.size()));
}

int stages(const Model& model, const Eigen::VectorXd& change) {
  double longest = 0.0;
  for (Eigen::Index i = 0; i < change.size(); ++i) {
    const CommandLimits& limits = model.actuators()[static_cast<std::size_t>(i)]->limits();
    longest = std::max(longest, std::abs(change[i]) / (limits.max - limits.min));
  }
  return std::max(1, static_cast<int>(std::ceil(longest / kLongestStage - 1e-9)));
}

// Only through stable shapes; false where there is no such way, and the state is then another.
bool follow(Simulation& simulation, const Eigen::VectorXd& from, const Eigen::VectorXd& to, int cuts) {
  const SimulationState before = simulation.state();
  set_commands(simulation, to);
  const SolveReport report = simulation.solve_equilibrium({0.0, true});
  if (report.converged && report.inverted_elements == 0) return true;
  if (cuts == 0) return false;
  simulation.set_state(before);
  const Eigen::VectorXd half = 0.5 * (from + to);
  return follow(simulation, from, half, cuts - 1) && follow(simulation, half, to, cuts - 1);
}

bool follow_in_stages(Simulation& simulation, const Eigen::VectorXd& to) {
  const Eigen::VectorXd from = commands_of(simulation.state());
  const int count = stages(*simulation.model(), to - from);
  const auto between = [&](int stage) { return Eigen::VectorXd(from + double(stage) / count * (to - from)); };
  for (int stage = 1; stage <= count; ++stage)
    if (!follow(simulation, between(stage - 1), stage == count ? to : between(stage), kCuts)) return false;
  return true;
}

void read(Simulation& simulation, int marker, WorkspacePoint& point) {
  const int markers = static_cast<int>(simulation.markers().size());
  point.markers_m.resize(3, markers);
  for (int m = 0; m < markers; ++m) point.markers_m.col(m) = simulation.marker_position(m);
  for (int a = 0; a < static_cast<int>(simulation.actuators().size()); ++a)
    point.actuators.push_back(simulation.actuator_state(a));
  point.jacobian_m = simulation.marker_sensitivities().middleRows<3>(3 * marker);
}

// Leaves the simulation at the point, or at its start where it failed.
WorkspacePoint seek(Simulation& simulation, const SimulationState& start, const Eigen::VectorXd& commands, int marker) {
  WorkspacePoint point;
  simulation.set_state(start);
  try {
    if (!follow_in_stages(simulation, commands)) {
      point.snapped = true;
      simulation.set_state(start);
      set_commands(simulation, commands);
      const SolveReport report = simulation.solve_equilibrium();
      if (!report.converged || report.inverted_elements > 0)
        throw std::runtime_error(report.converged ? "inverted elements" : report.message);
    }
    read(simulation, marker, point);
  } catch (const std::runtime_error& error) {
    point.failure = error.what();
    simulation.set_state(start);
  }
  return point;
}

StatePointer rest_state(const std::shared_ptr<const Model>& model) {
  Simulation simulation(model);
  const SolveReport report = simulation.solve_equilibrium();
  if (!report.converged) throw std::runtime_error("the robot does not rest at its rest commands: " + report.message);
  return std::make_shared<SimulationState>(simulation.state());
}

// Points whose start is known, the newest first, so that few states are held at a time.
class Walkers {
 public:
  explicit Walkers(const WorkspaceWalk& walk) : walk_(walk), children_(walk.starts.size()) {
    std::vector<bool> needed = walk.wanted;
    for (std::size_t point = 0; point < needed.size(); ++point)
      for (int on_way = walk.wanted[point] ? walk.starts[point] : kFromRest; on_way != kFromRest;
           on_way = walk.starts[static_cast<std::size_t>(on_way)])
        needed[static_cast<std::size_t>(on_way)] = true;
    const StatePointer rest = rest_state(walk.model);
    for (std::size_t point = needed.size(); point-- > 0;) {
      if (!needed[point]) continue;
      const int start = walk.starts[point];
      if (start == kFromRest) {
        ready_.push_back({static_cast<int>(point), rest});
      } else {
        children_[static_cast<std::size_t>(start)].push_back(static_cast<int>(point));
      }
    }
  }

  void run() {
    std::vector<std::future<void>> threads;
    for (int i = 0; i < walk_.threads; ++i) threads.push_back(std::async(std::launch::async, [this] { work(); }));
    for (std::future<void>& thread : threads) thread.wait();
    for (std::future<void>& thread : threads) thread.get();
  }

 private:
  struct Job {
    int point;
    StatePointer start;
  };

  void work() {
    try {
      Simulation simulation(walk_.model);
      while (const std::optional<Job> job = next()) {
        const WorkspacePoint found = seek(simulation, *job->start, walk_.commands.col(job->point), walk_.marker);
        finish(job->point, found, std::make_shared<SimulationState>(simulation.state()));
      }
    } catch (...) {
      stop();
      throw;
    }
  }

  std::optional<Job> next() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return stopped_ || !ready_.empty() || under_way_ == 0; });
    if (stopped_ || ready_.empty()) return std::nullopt;
    Job job = ready_.back();
    ready_.pop_back();
    ++under_way_;
    return job;
  }

  void finish(int point, const WorkspacePoint& found, const StatePointer& state) {
    const std::lock_guard<std::mutex> lock(mutex_);
    --under_way_;
    for (const int child : children_[static_cast<std::size_t>(point)]) ready_.push_back({child, state});
    changed_.notify_all();
    if (!stopped_ && walk_.wanted[static_cast<std::size_t>(point)] && !walk_.found(point, found)) stopped_ = true;
  }

  void stop() {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }

  const WorkspaceWalk& walk_;
  std::vector<std::vector<int>> children_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Job> ready_;
  int under_way_ = 0;
  bool stopped_ = false;
};

}  // namespace

void walk_workspace(const WorkspaceWalk& walk) { Walkers(walk).run(); }

double least_singular_value_m(const Eigen::MatrixXd& jacobian_m, const Eigen::VectorXd& ranges) {
  const Eigen::MatrixXd scaled = jacobian_m * ranges.asDiagonal();
  return scaled.jacobiSvd().singularValues().tail<1>()[0];
}

bool folded_between(const Eigen::Vector3d& from_m, const Eigen::MatrixXd& from_jacobian_m, const Eigen::Vector3d& to_m,
                    const Eigen::MatrixXd& to_jacobian_m, const Eigen::VectorXd& command_change) {
  constexpr double kMargin = 1.1, kSmallest_m = 1e-4;
  const Eigen::Vector3d from_leads_m = from_jacobian_m * command_change, to_leads_m = to_jacobian_m * command_change;
  const double off_m = (to_m - from_m - 0.5 * (from_leads_m + to_leads_m)).norm();
  return off_m > kMargin * 0.5 * (from_leads_m.norm() + to_leads_m.norm()) + kSmallest_m;
}

}  // namespace soft_robot_lab
