// SPDX-License-Identifier: BSD-3-Clause
// Runs what may crash, hang or take all memory, case by case, in a process that may end so, and counts how each ended.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

namespace soft_robot_lab {

// What a case throws for an answer that a user could take for a good one.
struct Nonsense : std::logic_error {
  using std::logic_error::logic_error;
};

struct GuardLimits {
  double memory_bytes = 8.0e9;
  double cpu_s = 20.0;    // of each case
  double wall_s = 300.0;  // the same, of one that waits for something; far beyond what a loaded machine needs
};

struct GuardedCases {
  std::size_t count = 0;
  std::function<std::string(std::size_t)> name;
  std::function<void(std::size_t)> run;  // std::invalid_argument and std::runtime_error refuse, with a reason
};

// "accepted" and "refused" are good; all others are written to standard output with the case's name.
std::map<std::string, int> run_guarded(const GuardedCases& cases, const GuardLimits& limits = {});

// Prints the counts. True where all ended as they may.
bool all_good(const std::map<std::string, int>& counts);

// The program `name [PART]`, which checks every PART-th case, and its exit status: 0 all good, 1 not, 2 bad arguments.
int run_check(int argc, char** argv, const std::string& name, const std::function<bool(std::size_t part)>& check);

}  // namespace soft_robot_lab
