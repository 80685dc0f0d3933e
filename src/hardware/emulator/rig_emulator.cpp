// SPDX-License-Identifier: BSD-3-Clause
// rig_emulator: the rig's real firmware on an emulated board, with emulated stepper drivers, motors and faults,
// or valves, regulators, air and faults. A program of its own, as simavr is GPL.
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
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
#include "settings/command_line.h"
#include "settings/outlast_launch.h"

namespace soft_robot_lab {
namespace {

struct Arguments {
  std::string device, rig;
  int motors = 2;
  std::uint64_t seed = 1;
  bool lock_step = false;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option(
         "--device", arguments.device,
         "in real time: the board's serial line is this pseudo-terminal, and the Unix socket PATH.control takes "
         "commands, one a line: shafts, stall 0 on, unplug, ...")
      .type_name("PATH");
  app.add_flag("--lock-step", arguments.lock_step,
               "the same commands come from the standard input, and time passes only with the command: "
               "run MICROSECONDS [BYTES_IN_HEX]");
  app.add_option("--motors", arguments.motors, "how many there are").type_name("N").show_default();
  app.add_option("--rig", arguments.rig, "the motors or pressure channels that this file lists").type_name("FILE");
  app.add_option("--seed", arguments.seed, "of what is random").type_name("N").show_default();
  app.allow_extras();
}

void check(const CommandLine& app, const Arguments& arguments) {
  for (const std::string& word : app.extras())  // roslaunch's own are for nodes
    if (word.find(":=") == std::string::npos) throw std::invalid_argument("unknown argument " + word);
  if (arguments.lock_step == !arguments.device.empty())
    throw std::invalid_argument("give either --device or --lock-step");
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

EmulatedRig make_rig(const Arguments& arguments) {
  if (arguments.rig.empty()) return EmulatedRig(arguments.motors, arguments.seed);
  const RigSettings settings = load_rig(arguments.rig);
  if (!settings.channels.empty()) return EmulatedRig(settings.channels, arguments.seed);
  return EmulatedRig(static_cast<int>(settings.motors.size()), arguments.seed);
}

int serve(const Arguments& arguments) {
  std::FILE* out = take_standard_output();
  EmulatedRig rig = make_rig(arguments);
  if (arguments.lock_step) {
    serve_in_lock_step(rig, out);
  } else {
    serve_in_real_time(rig, arguments.device);
  }
  return kGood;
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  CommandLine app("The rig's firmware on an emulated board, with emulated stepper drivers or air, and faults.",
                  "rig_emulator");
  Arguments arguments;
  declare(app, arguments);
  const auto begin = std::chrono::steady_clock::now();
  const int status = run_program(app, argc, argv, [&] {
    check(app, arguments);
    return serve(arguments);
  });
  if (status != kGood) outlast_launch(argc, argv, begin);
  return status;
}
