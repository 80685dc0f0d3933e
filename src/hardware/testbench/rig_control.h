// SPDX-License-Identifier: BSD-3-Clause
// A rig_emulator that runs in real time: asks it for faults and for the truth.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace soft_robot_lab {

struct ShaftTruth {
  double shaft_steps;  // full steps since zero was set
  double spool_steps;  // behind the backlash
  bool moving;
};

class LineSocket;

class RigControl {
 public:
  // The socket PATH.control beside the emulator's device PATH; throws std::runtime_error when nobody is there.
  explicit RigControl(const std::string& socket_path);
  ~RigControl();

  // Throws std::invalid_argument when it refuses, or for what is not one short line; std::runtime_error when it is
  // gone.
  std::string ask(const std::string& command);
  std::vector<ShaftTruth> shafts();
  std::vector<double> pressures_pa();  // gauge, in the chambers

 private:
  std::unique_ptr<LineSocket> lines_;
};

}  // namespace soft_robot_lab
