// What the package's programs share: their exit status, and how they end on a mistake.
#pragma once

#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

namespace soft_robot_lab {

enum ExitStatus { kGood = 0, kNotGood = 1, kFailed = 2 };

inline void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  if (!file) throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
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
// kFailed. Arguments with `help` set print the usage.
template <class Parse, class Run>
int run_program(const std::string& name, const char* usage, int argc, char** argv, Parse parse, Run run) {
  decltype(parse(argc, argv)) arguments;
  try {
    arguments = parse(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << "\n" << usage;
    return kFailed;
  }
  if (arguments.help) {
    std::cout << usage;
    return kGood;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << "\n";
    return kFailed;
  }
}

}  // namespace soft_robot_lab
