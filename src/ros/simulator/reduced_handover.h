// SPDX-License-Identifier: BSD-3-Clause
// Hands a scene's motion to its reduced model, once that is trained or knows the robot's state again.
#pragma once

#include <chrono>
#include <optional>

#include "robot/scene/background_training.h"
#include "robot/scene/scene_motion.h"

namespace soft_robot_lab {

class ReducedHandover {
 public:
  // Ends the training of the scene before, and begins this one's.
  void train(const std::string& scene, SceneOptions options) {
    options.method = "reduced";
    training_.start(scene, options);
  }
  void stop() { training_.stop(); }
  const BackgroundTraining& training() const { return training_; }

  // Asks twice a second at most. Returns whether a model took over that was trained just now.
  bool hand_over(SceneMotion& motion) {
    constexpr auto every = std::chrono::milliseconds(500);
    const auto now = Clock::now();
    if (motion.reduced() || (asked_ && now < *asked_ + every)) return false;
    asked_ = now;
    std::shared_ptr<const SceneReduction> trained = training_.take();
    if (trained) {
      motion.to_reduced(std::move(trained));
      return true;
    }
    motion.to_reduced();
    return false;
  }

 private:
  using Clock = std::chrono::steady_clock;

  BackgroundTraining training_;
  std::optional<Clock::time_point> asked_;
};

}  // namespace soft_robot_lab
