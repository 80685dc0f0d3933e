// SPDX-License-Identifier: BSD-3-Clause
// An emulated rig in a process of its own, whose time passes only in run(): what a driver does with it repeats exactly.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hardware/motor/port.h"
#include "rig_control.h"

namespace soft_robot_lab {

struct LineFaults {
  std::int64_t passed, corrupted, lost, doubled, delayed;  // bytes, both ways
};

class Testbench {
 public:
  // program: rig_emulator; empty: the one beside the running program, or on PATH. Throws std::runtime_error.
  explicit Testbench(int motors, std::uint64_t seed = 1, const std::string& program = "");
  // Of the motors or pressure channels that this file lists.
  explicit Testbench(const std::string& rig_file, std::uint64_t seed = 1, const std::string& program = "");
  ~Testbench();

  double time_s() const { return time_s_; }
  void run(double duration_s);  // or until a frame has arrived, whichever is first
  // Of this rig, which must outlive them. Opening fails while the rig is unplugged.
  OpenPort ports();

  // A command of the emulator, as src/hardware/firmware/PROTOCOL.md lists them; throws std::invalid_argument when it
  // refuses.
  std::string ask(const std::string& command);
  std::vector<ShaftTruth> shafts();
  std::vector<double> pressures_pa();  // gauge, in the chambers
  LineFaults line_faults();
  void unplug();
  void replug();

 private:
  class Process;
  class LockStepPort;

  std::unique_ptr<Process> process_;
  std::vector<std::uint8_t> to_board_, to_host_;
  double time_s_ = 0.0;
  int plugged_times_ = 0;  // ports of before the last unplugging are dead
  bool plugged_ = true;
};

}  // namespace soft_robot_lab
