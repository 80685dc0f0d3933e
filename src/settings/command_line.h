// SPDX-License-Identifier: BSD-3-Clause
// What the package's programs share: how they read their arguments, their exit status, and how they end on a mistake.
// CLI11 stands behind, in command_line.cpp alone: it takes the compiler several times as long as a program's own lines.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "write_file.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace soft_robot_lab {

enum ExitStatus { kGood = 0, kNotGood = 1, kFailed = 2 };

// Thrown by what an argument calls, where its value does not do.
class WrongArgument : public std::runtime_error {
 public:
  WrongArgument(const std::string& name, const std::string& why) : std::runtime_error(name + ": " + why) {}
};

// One that a program declares, and what is to be said of it.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}
  Argument type_name(const std::string& name) const;
  Argument group(const std::string& heading) const;  // of the help; empty: not in it
  Argument show_default() const;
  Argument required() const;
  Argument expected(int values) const;
  Argument delimiter(char between_values) const;
  Argument one_value_at_a_time() const;  // though it can be repeated
  Argument in_order() const;             // is called where it stands, not at the end
  Argument range(int low, int high) const;
  Argument range(double low, double high) const;
  Argument positive() const;
  Argument one_of(const std::vector<std::string>& words) const;
  Argument excludes(const Argument& other) const;

 private:
  CLI::Option* option_;  // of the command line
};

class CommandLine {
 public:
  CommandLine(const std::string& what, const std::string& program);

  // Value: std::string, int, unsigned, std::uint64_t, double, an optional double, a list of strings or of ranges.
  // Numbers are within limits.h, by the unit that type_name names.
  template <class Value>
  Argument add_option(const std::string& name, Value& value, const std::string& meaning = "");
  // Value: std::string, double, a list of either.
  template <class Value>
  Argument add_option_function(const std::string& name, const std::function<void(const Value&)>& take,
                               const std::string& meaning);
  Argument add_flag(const std::string& name, bool& value, const std::string& meaning);
  Argument add_flag_callback(const std::string& name, const std::function<void()>& take, const std::string& meaning);
  // --set PATH=NUMBER, as often as wanted.
  void add_set_option(std::vector<std::string>& words);

  // Options of which at least `fewest` and at most `most` are to be given.
  CommandLine add_group(const std::string& heading, const std::string& meaning, std::size_t fewest, std::size_t most);
  void footer(const std::string& text);
  void allow_extras();  // words that nothing declares
  std::vector<std::string> extras() const;
  std::string program() const;

  // Reads the arguments. A value is the status to end with at once: help was asked for and printed, or an argument was
  // wrong, which stands on the error stream.
  std::optional<int> read(int argc, char** argv);

 private:
  explicit CommandLine(std::shared_ptr<CLI::App> app);

  std::shared_ptr<CLI::App> app_;
};

// Throws WriteError where what was printed did not get to where the standard output leads.
void require_printed();

// Reads the arguments and calls `run()`, which returns the status. What goes wrong is said on the error stream and ends
// with kFailed; results that could not be written whole are kNotGood.
int run_program(CommandLine& line, int argc, char** argv, const std::function<int()>& run);

}  // namespace soft_robot_lab
