// SPDX-License-Identifier: BSD-3-Clause
// Trains a scene's reduced model in a thread of its own, while whoever asked goes on.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "reduction.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

class BackgroundTraining {
 public:
  ~BackgroundTraining() { stop(); }

  // Ends the one before. `options` as the scene itself was loaded with; their progress and interrupt are not asked.
  void start(const std::string& scene, const SceneOptions& options);
  void stop();  // waits for the thread, which ends after the present piece of work, a second or two

  // The trained model, once; null before, and where training failed.
  std::shared_ptr<const SceneReduction> take();

  // "training: 40 %, ..." or "not trained: " and why; empty where there is nothing to say.
  std::string status() const;
  bool failed() const;

 private:
  void train(const std::string& scene, SceneOptions options);
  void say(const std::string& status);

  std::thread thread_;
  std::atomic<bool> ends_{false};
  mutable std::mutex mutex_;  // guards what follows
  std::string status_;
  bool failed_ = false;
  std::shared_ptr<const SceneReduction> trained_;
};

}  // namespace soft_robot_lab
