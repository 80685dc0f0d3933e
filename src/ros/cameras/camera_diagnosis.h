// SPDX-License-Identifier: BSD-3-Clause
// What is wrong with one camera of the tracker, by what came of it since it was last asked.
#pragma once

#include <string>

namespace soft_robot_lab {

class CameraDiagnosis {
 public:
  enum class Level { ok, warning, error };
  struct Finding {
    Level level = Level::ok;
    std::string message;
  };

  explicit CameraDiagnosis(std::string camera);

  void colour_came() { ++colour_; }
  void depth_came() { ++depth_; }
  void frame_came() { ++frames_, ++all_frames_; }
  void failed(const std::string& problem) { problem_ = problem; }
  // The tracker used a frame: this camera saw so many markers, and all cameras together so many.
  void tracked(std::size_t own_sights, std::size_t all_sights) { own_sights_ += own_sights, all_sights_ += all_sights; }

  // Of the last `passed_s`, and starts anew; `missing` as TrackingInput says it.
  Finding diagnose(double passed_s, const std::string& missing);
  // Colour and depth came since the last diagnosis, but not together.
  bool unpaired() const { return colour_ > 0 && depth_ > 0 && frames_ == 0; }
  long all_frames() const { return all_frames_; }

 private:
  Finding judge(const std::string& missing) const;

  std::string camera_, problem_;
  long colour_ = 0, depth_ = 0, frames_ = 0, all_frames_ = 0;
  std::size_t own_sights_ = 0, all_sights_ = 0;
  double silent_s_ = 0;
};

}  // namespace soft_robot_lab
