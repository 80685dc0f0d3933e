// SPDX-License-Identifier: BSD-3-Clause
#include "testbench.h"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "answers.h"
#include "child_process.h"
#include "settings/find_program.h"

namespace soft_robot_lab {
namespace {

std::string to_hex(const std::vector<std::uint8_t>& bytes) {
  const char* digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

void append_hex(const std::string& text, std::vector<std::uint8_t>& bytes) {
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
}

std::vector<std::string> command(const std::string& program, const std::string& option, const std::string& value,
                                 std::uint64_t seed) {
  const std::string found = program.empty() ? find_program("rig_emulator") : program;
  if (found.empty()) throw std::runtime_error("rig_emulator was not found beside this program, nor on PATH");
  return {found, "--lock-step", option, value, "--seed", std::to_string(seed)};
}

}  // namespace

class Testbench::Process : public ChildProcess {
  using ChildProcess::ChildProcess;
};

class Testbench::LockStepPort : public Port {
 public:
  explicit LockStepPort(Testbench& rig) : rig_(rig), plugged_times_(rig.plugged_times_) {
    require_plugged();
    rig_.to_host_.clear();
  }
  std::vector<std::uint8_t> read() override {
    require_plugged();
    return std::exchange(rig_.to_host_, {});
  }
  void write(const std::vector<std::uint8_t>& bytes) override {
    require_plugged();
    rig_.to_board_.insert(rig_.to_board_.end(), bytes.begin(), bytes.end());
  }

 private:
  void require_plugged() const {
    if (!rig_.plugged_ || plugged_times_ != rig_.plugged_times_) throw PortError("emulated rig: unplugged");
  }
  Testbench& rig_;
  int plugged_times_;
};

Testbench::Testbench(int motors, std::uint64_t seed, const std::string& program)
    : process_(std::make_unique<Process>(command(program, "--motors", std::to_string(motors), seed))) {}

Testbench::Testbench(const std::string& rig_file, std::uint64_t seed, const std::string& program)
    : process_(std::make_unique<Process>(command(program, "--rig", rig_file, seed))) {}

Testbench::~Testbench() = default;

std::string Testbench::ask(const std::string& line) { return unwrap(line, process_->ask(line)); }

void Testbench::run(double duration_s) {
  const auto duration_us = std::to_string(std::llround(duration_s * 1e6));
  std::istringstream answer(ask("run " + duration_us + " " + to_hex(std::exchange(to_board_, {}))));
  double time_us = 0.0;
  std::string heard;
  answer >> time_us >> heard;
  time_s_ = 1e-6 * time_us;
  append_hex(heard, to_host_);
}

std::vector<ShaftTruth> Testbench::shafts() { return read_shafts(ask("shafts")); }

std::vector<double> Testbench::pressures_pa() { return read_pressures(ask("pressures")); }

LineFaults Testbench::line_faults() {
  std::istringstream answer(ask("counts"));
  LineFaults counts{};
  answer >> counts.passed >> counts.corrupted >> counts.lost >> counts.doubled >> counts.delayed;
  return counts;
}

OpenPort Testbench::ports() {
  return [this]() -> std::unique_ptr<Port> { return std::make_unique<LockStepPort>(*this); };
}

void Testbench::unplug() {
  ask("unplug");
  plugged_ = false;
  ++plugged_times_;
  to_board_.clear();
  to_host_.clear();
}

void Testbench::replug() {
  ask("replug");
  plugged_ = true;
}

}  // namespace soft_robot_lab
