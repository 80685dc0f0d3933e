// SPDX-License-Identifier: BSD-3-Clause
#include "python_batch.h"

#include <algorithm>
#include <exception>
#include <future>
#include <stdexcept>

#include "robot/scene/reduction.h"
#include "settings/limits.h"
#include "settings/require.h"

namespace soft_robot_lab {

PythonBatch::PythonBatch(Scene scene, int worlds, int threads) : scene_(std::move(scene)), threads_(threads) {
  require(worlds >= 1 && worlds <= limits::kCount, "worlds", worlds, "[1, 1000000]");
  require(threads >= 1 && threads <= limits::kThreads, "threads", threads, "[1, 1000]");
  for (int i = 0; i < worlds; ++i) {
    World& world = worlds_.emplace_back();
    world.simulation = std::make_unique<Simulation>(scene_.simulation->model());
    world.simulation->set_interrupt([this] { return watch().asked(); });
    world.motion = std::make_unique<SceneMotion>(*world.simulation, scene_.reduction);
  }
}

SceneMotion& PythonBatch::at(int world) {
  if (world < 0 || world >= worlds())
    throw std::out_of_range("world " + std::to_string(world) + " is out of range [0, " + std::to_string(worlds() - 1) +
                            "]");
  return *worlds_[static_cast<std::size_t>(world)].motion;
}

void PythonBatch::each(const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> thrown(worlds_.size());
  const auto take = [&] {
    for (std::size_t i = next++; i < worlds_.size() && !watch().asked(); i = next++) {
      try {
        work(i);
      } catch (...) {
        thrown[i] = std::current_exception();
      }
    }
  };
  std::vector<std::future<void>> others;
  for (int i = 1; i < std::min(threads_, worlds()); ++i) others.push_back(std::async(std::launch::async, take));
  take();
  for (std::future<void>& other : others) other.wait();
  for (const std::exception_ptr& one : thrown)
    if (one) std::rethrow_exception(one);
}

void PythonBatch::set(const Eigen::MatrixXd& commands) {
  const Use use(*this);
  const auto& actuators = model().actuators();
  for (Eigen::Index world = 0; world < commands.rows(); ++world)
    for (std::size_t i = 0; i < actuators.size(); ++i) try {
        actuators[i]->require_in_limits(commands(world, static_cast<Eigen::Index>(i)));
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument("world " + std::to_string(world) + ": " + error.what());
      }
  for (std::size_t world = 0; world < worlds_.size(); ++world)
    for (std::size_t i = 0; i < actuators.size(); ++i)
      worlds_[world].motion->set_command(actuators[i]->name(),
                                         commands(static_cast<Eigen::Index>(world), static_cast<Eigen::Index>(i)));
}

std::vector<SolveReport> PythonBatch::step(int steps) {
  const Use use(*this);
  require(steps >= 1 && steps <= limits::kCount, "steps", steps, "[1, 1000000]");
  std::vector<SolveReport> reports(worlds_.size());
  freely([&] {
    each([&](std::size_t i) {
      reports[i].converged = true;
      for (int k = 0; k < steps && !reports[i].interrupted; ++k) add_report(worlds_[i].motion->step(), reports[i]);
    });
  });
  return reports;
}

std::vector<SolveReport> PythonBatch::settle() {
  const Use use(*this);
  std::vector<SolveReport> reports(worlds_.size());
  freely([&] { each([&](std::size_t i) { reports[i] = worlds_[i].motion->solve_equilibrium(); }); });
  return reports;
}

void PythonBatch::reset(const std::vector<int>& of) {
  const Use use(*this);
  for (const int world : of) at(world);
  for (const int world : of) at(world).reset();
}

PythonState PythonBatch::state(int world) {
  const Use use(*this);
  return {at(world).place(), scene_.simulation->model()};
}

void PythonBatch::set_state(int world, const PythonState& state) {
  const Use use(*this);
  go_to_or_stay(at(world), state);
}

Eigen::MatrixXd PythonBatch::commands(double DriveState::*which) {
  const Use use(*this);
  Eigen::MatrixXd all(worlds(), static_cast<Eigen::Index>(model().actuators().size()));
  for (int world = 0; world < worlds(); ++world)
    for (Eigen::Index i = 0; i < all.cols(); ++i)
      all(world, i) = at(world).drives()[static_cast<std::size_t>(i)].*which;
  return all;
}

std::vector<Eigen::Matrix3Xd> PythonBatch::markers_m() {
  const Use use(*this);
  std::vector<Eigen::Matrix3Xd> all(worlds_.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = worlds_[i].motion->markers_m();
  return all;
}

std::vector<double> PythonBatch::time_s() {
  const Use use(*this);
  std::vector<double> all;
  for (const World& world : worlds_) all.push_back(world.motion->time_s());
  return all;
}

std::vector<Eigen::MatrixXd> PythonBatch::sensitivities() {
  const Use use(*this);
  std::vector<Eigen::MatrixXd> all(worlds_.size());
  freely([&] {
    each([&](std::size_t i) {
      worlds_[i].motion->show();
      all[i] = worlds_[i].simulation->marker_sensitivities();
    });
  });
  return all;
}

}  // namespace soft_robot_lab
