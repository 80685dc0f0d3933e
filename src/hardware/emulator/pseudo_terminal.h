// SPDX-License-Identifier: BSD-3-Clause
// A pseudo-terminal that stands for a USB serial device: it appears under a name of our choice, and vanishes when
// unplugged.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace soft_robot_lab {

class PseudoTerminal {
 public:
  explicit PseudoTerminal(std::string link) : link_(std::move(link)) {}
  ~PseudoTerminal() { unplug(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  void plug();  // throws std::runtime_error
  void unplug();
  bool plugged() const { return master_ >= 0; }
  std::vector<std::uint8_t> read();                    // what the host has written; never waits
  void write(const std::vector<std::uint8_t>& bytes);  // what nobody reads in time is lost, as on a serial line

 private:
  void remove_link() const;

  std::string link_;
  int master_ = -1;
  int slave_ = -1;  // kept open: else reading fails while no host has the device open
};

}  // namespace soft_robot_lab
