// SPDX-License-Identifier: BSD-3-Clause
// report BAG --output FOLDER: a recorded session as one HTML page.
#include <cstdio>
#include <stdexcept>
#include <string>

#include "settings/command_line.h"
#include "ros/session_report.h"

namespace {

using namespace soft_robot_lab;

constexpr const char* kUsage =
    "usage: report BAG --output FOLDER [--scene SCENE.yaml]\n"
    "Writes FOLDER/report.html, which holds its pictures: gap over time and by configuration, policy, trajectories, "
    "what\n"
    "the cameras saw, the scene and the versions. The pictures lie in FOLDER too, as PNG, SVG and CSV.\n"
    "--scene  the robot's file, where it is not the one that the recording names.\n"
    "Exit status: 0 written, 2 bad recording or arguments.\n";

struct Arguments {
  std::string bag, output, scene;
  bool help = false;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  Words words(count, values);
  while (words.next()) {
    const std::string word = words.word();
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--output") {
      arguments.output = words.value();
    } else if (word == "--scene") {
      arguments.scene = words.value();
    } else if (!word.empty() && word[0] == '-') {
      throw std::invalid_argument("unknown option " + word);
    } else if (arguments.bag.empty()) {
      arguments.bag = word;
    } else {
      throw std::invalid_argument("more than one recording: " + word);
    }
  }
  if (!arguments.help && arguments.bag.empty()) throw std::invalid_argument("no recording given");
  if (!arguments.help && arguments.output.empty()) throw std::invalid_argument("--output: no folder given");
  return arguments;
}

int report(const Arguments& arguments) {
  const SessionReport written = write_session_report(arguments.bag, arguments.output, arguments.scene);
  std::printf("%s: %d configurations at rest", written.page.c_str(), written.rest_periods);
  if (written.rest_periods > 0) std::printf(", rms gap %.3f mm", 1e3 * written.rest_rms_m);
  std::printf("\n");
  return kGood;
}

}  // namespace

int main(int argc, char** argv) { return run_program("report", kUsage, argc, argv, parse, report); }
