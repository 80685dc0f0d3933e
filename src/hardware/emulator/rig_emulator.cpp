// SPDX-License-Identifier: BSD-3-Clause
// rig_emulator: the rig's real firmware on an emulated board, with emulated stepper drivers, motors and faults.
// A program of its own, as simavr is GPL.
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <unistd.h>

#include "control.h"
#include "control_socket.h"
#include "emulated_rig.h"
#include "file_guard.h"
#include "pseudo_terminal.h"
#include "hardware/motor/rig_settings.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kUsage =
    "usage: rig_emulator --device PATH [--motors N | --rig FILE] [--seed N]\n"
    "       rig_emulator --lock-step [--motors N | --rig FILE] [--seed N]\n"
    "It has N motors (2), or as many as the rig's file lists.\n"
    "With --device it runs in real time: the board's serial line is the pseudo-terminal PATH, and the Unix socket\n"
    "PATH.control takes commands, one a line: shafts, stall 0 on, unplug, ... With --lock-step it takes the same\n"
    "commands from the standard input, and time passes only with the command: run MICROSECONDS [BYTES_IN_HEX].\n";

struct Arguments {
  std::string device;
  int motors = 2;
  std::uint64_t seed = 1;
  bool lock_step = false;
  bool help = false;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    const auto next = [&]() -> std::string {
      if (++i == count) throw std::invalid_argument(word + " needs a value");
      return values[i];
    };
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--lock-step") {
      arguments.lock_step = true;
    } else if (word == "--device") {
      arguments.device = next();
    } else if (word == "--motors") {
      arguments.motors = std::stoi(next());
    } else if (word == "--rig") {
      arguments.motors = static_cast<int>(load_rig(next()).motors.size());
    } else if (word == "--seed") {
      arguments.seed = std::stoull(next());
    } else if (word.find(":=") == std::string::npos) {  // roslaunch's own are for nodes
      throw std::invalid_argument("unknown argument " + word);
    }
  }
  if (!arguments.help && arguments.lock_step == !arguments.device.empty()) {
    throw std::invalid_argument("give either --device or --lock-step");
  }
  return arguments;
}

// What simavr prints must not come between the answers.
std::FILE* take_standard_output() {
  std::FILE* out = fdopen(dup(STDOUT_FILENO), "w");
  if (out == nullptr || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) throw std::runtime_error(std::strerror(errno));
  return out;
}

void serve_in_lock_step(EmulatedRig& rig, std::FILE* out) {
  std::string line;
  while (std::getline(std::cin, line)) {
    std::fputs((answer(rig, line, true) + "\n").c_str(), out);
    std::fflush(out);
  }
}

volatile std::sig_atomic_t stopped = 0;

void serve_in_real_time(EmulatedRig& rig, const std::string& device) {
  using Clock = std::chrono::steady_clock;
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int) { stopped = 1; });
  }
  FileGuard guard({device, device + ".control"});
  ControlSocket control(device + ".control");  // first: it finds out whether another emulator runs
  guard.made(1);
  PseudoTerminal terminal(device);
  const auto plug = [&] {
    terminal.plug();
    guard.made(0);
  };
  plug();
  auto start = Clock::now();
  while (stopped == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    control.serve([&rig](const std::string& line) { return answer(rig, line, false); });
    if (rig.plugged() != terminal.plugged()) {
      if (rig.plugged())
        plug();
      else
        terminal.unplug();
    }
    rig.send(terminal.read());
    double now_s = std::chrono::duration<double>(Clock::now() - start).count();
    constexpr double longest_catch_up_s = 0.1;  // a machine that slept does not make up for it
    if (now_s > rig.time_s() + longest_catch_up_s) {
      start += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(now_s - rig.time_s()));
      now_s = rig.time_s();
    }
    std::vector<std::uint8_t> heard;
    do {  // a frame at a time
      heard = rig.run(now_s);
      terminal.write(heard);
    } while (!heard.empty());
  }
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  try {
    const Arguments arguments = parse(argc, argv);
    if (arguments.help) {
      std::cout << kUsage;
      return 0;
    }
    std::FILE* out = take_standard_output();
    EmulatedRig rig(arguments.motors, arguments.seed);
    if (arguments.lock_step) {
      serve_in_lock_step(rig, out);
    } else {
      serve_in_real_time(rig, arguments.device);
    }
    return 0;
  } catch (const std::invalid_argument& error) {
    std::cerr << "rig_emulator: " << error.what() << "\n" << kUsage;
  } catch (const std::exception& error) {
    std::cerr << "rig_emulator: " << error.what() << "\n";
  }
  return 2;
}
