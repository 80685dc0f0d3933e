// SPDX-License-Identifier: BSD-3-Clause
// What the package's programs share: their exit status, and how they end on a mistake.
#pragma once

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "write_file.h"

namespace soft_robot_lab {

enum ExitStatus { kGood = 0, kNotGood = 1, kFailed = 2 };

// Throws WriteError where what was printed did not get to where the standard output leads.
inline void require_printed() {
  errno = 0;
  std::cout << std::flush;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::cout && std::ferror(stdout) == 0) return;
  const bool still = errno == 0 && write(STDOUT_FILENO, "\n", 1) < 0;  // it failed before, for this reason
  throw WriteError("the standard output cannot be written" +
                   (errno != 0 || still ? std::string(": ") + std::strerror(errno) : ""));
}

// The words after a program's name, one after the other.
class Words {
 public:
  Words(int count, char** values) : count_(count), values_(values) {}

  bool next() {
    word_ = ++at_;
    return at_ < count_;
  }
  std::string word() const { return values_[word_]; }
  // The next of what follows this word; throws std::invalid_argument where nothing does.
  std::string value() {
    if (++at_ >= count_) throw std::invalid_argument(word() + " needs a value");
    return values_[at_];
  }

 private:
  int count_;
  char** values_;
  int word_ = 0, at_ = 0;
};

// Runs `run(arguments)` with what `parse(argc, argv)` read, or says on the error stream what was wrong and returns
// kFailed. Arguments with `help` set print the usage. Results that could not be written whole are kNotGood.
template <class Parse, class Run>
int run_program(const std::string& name, const char* usage, int argc, char** argv, Parse parse, Run run) {
  decltype(parse(argc, argv)) arguments;
  try {
    arguments = parse(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << "\n" << usage;
    return kFailed;
  }
  try {
    int status = kGood;
    if (arguments.help) {
      std::cout << usage;
    } else {
      status = run(arguments);
    }
    require_printed();
    return status;
  } catch (const WriteError& error) {
    std::cerr << name << ": " << error.what() << "\n";
    return kNotGood;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << "\n";
    return kFailed;
  }
}

}  // namespace soft_robot_lab
