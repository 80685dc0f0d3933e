// SPDX-License-Identifier: BSD-3-Clause
#include "background_training.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace soft_robot_lab {

void BackgroundTraining::start(const std::string& scene, const SceneOptions& options) {
  stop();
  ends_ = false;
  say("training: 0 %, begins");
  thread_ = std::thread([this, scene, options] { train(scene, options); });
}

void BackgroundTraining::stop() {
  ends_ = true;
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  status_.clear();
  failed_ = false;
  trained_.reset();
}

std::shared_ptr<const SceneReduction> BackgroundTraining::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(trained_, nullptr);
}

std::string BackgroundTraining::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

bool BackgroundTraining::failed() const {
  const std::lock_guard lock(mutex_);
  return failed_;
}

void BackgroundTraining::say(const std::string& status) {
  const std::lock_guard lock(mutex_);
  status_ = status;
}

// Loads the scene a second time: the mesh comes from the cache, and the two share nothing that changes.
void BackgroundTraining::train(const std::string& scene, SceneOptions options) {
  options.reduced = ReducedUse::trained;
  options.interrupt = [this] { return ends_.load(); };
  options.on_warnings = {};
  options.progress = [this](double share, const std::string& what) {
    say("training: " + std::to_string(std::lround(100.0 * share)) + " %, " + what);
  };
  try {
    std::shared_ptr<const SceneReduction> trained = load_scene(scene, options).reduction;
    const std::lock_guard lock(mutex_);
    status_.clear();
    trained_ = std::move(trained);
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    status_ = std::string("not trained: ") + error.what();
    failed_ = true;
  }
}

}  // namespace soft_robot_lab
