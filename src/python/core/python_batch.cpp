// SPDX-License-Identifier: BSD-3-Clause
#include "python_batch.h"

#include <algorithm>
#include <exception>
#include <future>
#include <stdexcept>
#include <string>

#include "python_simulation.h"
#include "robot/scene/reduction.h"
#include "settings/limits.h"
#include "settings/require.h"

namespace soft_robot_lab {

namespace {

std::vector<std::string> actuators_of(const Model& model) {
  std::vector<std::string> names;
  for (const auto& actuator : model.actuators()) names.push_back(actuator->name());
  return names;
}

std::vector<std::string> markers_of(const Model& model) {
  std::vector<std::string> names;
  for (const Marker& marker : model.markers()) names.push_back(marker.name());
  return names;
}

void require_alike(const Model& first, const Model& other, std::size_t number) {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument("overrides[" + std::to_string(number) + "]: other " + what + " than overrides[0]");
  };
  if (actuators_of(first) != actuators_of(other)) refuse("actuators");
  if (markers_of(first) != markers_of(other)) refuse("markers");
  if (first.options().time_step_s != other.options().time_step_s) refuse("time steps");
}

}  // namespace

PythonBatch::PythonBatch(std::vector<Scene> scenes, int worlds, int threads)
    : scenes_(std::move(scenes)), threads_(threads) {
  require(worlds >= 1 && worlds <= limits::kCount, "worlds", worlds, "[1, 1000000]");
  require(threads >= 1 && threads <= limits::kThreads, "threads", threads, "[1, 1000]");
  for (std::size_t i = 1; i < scenes_.size(); ++i) require_alike(model(), *scenes_[i].simulation->model(), i);
  for (int i = 0; i < worlds; ++i) become(worlds_.emplace_back(), i % static_cast<int>(scenes_.size()));
}

void PythonBatch::become(World& world, int scene) {
  const Scene& of = scenes_[static_cast<std::size_t>(scene)];
  auto simulation = std::make_unique<Simulation>(of.simulation->model());
  simulation->set_interrupt([this] { return watch().asked(); });
  world.motion = std::make_unique<SceneMotion>(*simulation, of.reduction);
  world.simulation = std::move(simulation);
  world.scene = scene;
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
        worlds_[static_cast<std::size_t>(world)].simulation->actuators()[i]->require_in_limits(
            commands(world, static_cast<Eigen::Index>(i)));
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

std::vector<SolveReport> PythonBatch::settle(const std::vector<int>& of) {
  const Use use(*this);
  std::vector<SolveReport> of_all(worlds_.size()), reports;
  std::vector<bool> asked(worlds_.size(), false);
  for (const int world : of) {
    at(world);
    asked[static_cast<std::size_t>(world)] = true;
  }
  freely([&] {
    each([&](std::size_t i) {
      if (asked[i]) of_all[i] = worlds_[i].motion->solve_equilibrium();
    });
  });
  for (const int world : of) reports.push_back(of_all[static_cast<std::size_t>(world)]);
  return reports;
}

void PythonBatch::reset(const std::vector<int>& of, const std::vector<int>& scenes) {
  const Use use(*this);
  for (const int world : of) at(world);
  if (!scenes.empty() && scenes.size() != of.size())
    throw std::invalid_argument("models: must have a number for each of the " + std::to_string(of.size()) + " worlds");
  for (const int scene : scenes)
    if (scene < 0 || scene >= static_cast<int>(scenes_.size()))
      throw std::out_of_range("model " + std::to_string(scene) + " is out of range [0, " +
                              std::to_string(scenes_.size() - 1) + "]");
  for (std::size_t i = 0; i < of.size(); ++i) {
    World& world = worlds_[static_cast<std::size_t>(of[i])];
    if (scenes.empty() || scenes[i] == world.scene)
      world.motion->reset();
    else
      become(world, scenes[i]);
  }
}

PythonState PythonBatch::state(int world) {
  const Use use(*this);
  SceneMotion& motion = at(world);
  return {motion.place(), motion.simulation().model()};
}

void PythonBatch::set_state(int world, const PythonState& state) {
  const Use use(*this);
  go_to_or_stay(at(world), state);
}

std::vector<int> PythonBatch::scene_numbers() {
  const Use use(*this);
  std::vector<int> all;
  for (const World& world : worlds_) all.push_back(world.scene);
  return all;
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

std::vector<ActuatorReading> PythonBatch::readings(int world) {
  const Use use(*this);
  return shown_readings(at(world));
}

std::vector<ContactReading> PythonBatch::contacts(int world) {
  const Use use(*this);
  at(world).show();
  return at(world).simulation().contacts();
}

}  // namespace soft_robot_lab
