// SPDX-License-Identifier: BSD-3-Clause
// What the package's programs share: how they read their arguments (CLI11), their exit status, and how they end on a
// mistake.
#pragma once

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
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

// --set PATH=NUMBER, as often as wanted.
inline void add_set_option(CLI::App& app, std::vector<std::string>& words) {
  app.add_option("--set", words, "a number of the file by its path, or a parameter that it names")
      ->type_name("PATH=NUMBER")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

// An option that there is not, before words that may only look wrong because of it.
inline std::string unexpected(const CLI::App& app, const CLI::ExtrasError& error) {
  for (const std::string& word : app.remaining())
    if (word.size() > 1 && word[0] == '-') return "unknown option " + word;
  return error.what();
}

inline int refuse_arguments(const CLI::App& app, const std::string& why) {
  std::cerr << app.get_name() << ": " << why << "\n"
            << CLI::Formatter().make_usage(&app, app.get_name()) << "--help lists all arguments.\n";
  return kFailed;
}

// Reads the arguments that `app` declares. A value is the status to end with at once: help was asked for and printed,
// or an argument was wrong, which stands on the error stream.
inline std::optional<int> read_arguments(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    require_printed();
    return kGood;
  } catch (const CLI::ExtrasError& error) {
    return refuse_arguments(app, unexpected(app, error));
  } catch (const CLI::ParseError& error) {
    return refuse_arguments(app, error.what());
  }
}

// Reads the arguments that `app` declares and calls `run()`, which returns the status. What goes wrong is said on the
// error stream and ends with kFailed; results that could not be written whole are kNotGood.
template <class Run>
int run_program(CLI::App& app, int argc, char** argv, Run run) {
  try {
    if (const std::optional<int> ended = read_arguments(app, argc, argv)) return *ended;
    const int status = run();
    require_printed();
    return status;
  } catch (const WriteError& error) {
    std::cerr << app.get_name() << ": " << error.what() << "\n";
    return kNotGood;
  } catch (const std::exception& error) {
    std::cerr << app.get_name() << ": " << error.what() << "\n";
    return kFailed;
  }
}

}  // namespace soft_robot_lab
