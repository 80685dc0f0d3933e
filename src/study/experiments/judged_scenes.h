// SPDX-License-Identifier: BSD-3-Clause
// Judgements of drawn scenes in a file, a line each as they come: what takes hours can be ended, and goes on where it
// was.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drawn_rest_states.h"

namespace soft_robot_lab {

class JudgedScenes {
 public:
  // Takes what an earlier run left in the file, if that was of the same settings; else begins it anew. Throws
  // std::runtime_error where it cannot be written.
  JudgedScenes(std::string file, const std::string& settings);

  int of_earlier_run() const { return of_earlier_run_; }        // scenes
  const std::vector<JudgedScene>* find(int scene) const;        // null: not judged yet
  void add(int scene, const std::vector<JudgedScene>& judged);  // throws std::runtime_error

 private:
  std::string file_;
  std::map<int, std::vector<JudgedScene>> judged_;
  int of_earlier_run_ = 0;
};

}  // namespace soft_robot_lab
