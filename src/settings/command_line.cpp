// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <system_error>
#include <tuple>
#include <type_traits>

#include <CLI/CLI.hpp>
#include <unistd.h>

#include "kept_files.h"
#include "limits.h"
#include "words.h"
#include "written_options.h"

namespace soft_robot_lab {
namespace {

using Ranges = std::vector<std::tuple<std::string, double, double>>;
constexpr const char* kRangesTypeName = "NAME MIN MAX";

void list_options(const CLI::App& app, std::vector<const CLI::Option*>& all) {
  for (const CLI::Option* option : app.get_options()) all.push_back(option);
  for (const CLI::App* group : app.get_subcommands([](const CLI::App*) { return true; })) list_options(*group, all);
}

// An option that there is not, before words that may only look wrong because of it.
std::string unexpected(const CLI::App& app, const CLI::ExtrasError& error) {
  for (const std::string& word : app.remaining())
    if (word.size() > 1 && word[0] == '-') return "unknown option " + word;
  return error.what();
}

// Of a list whose words are each well.
std::string unconverted(const std::string& what) {
  const std::string start = "Could not convert: ";
  const std::size_t is = what.find(" = ");
  if (what.rfind(start, 0) != 0 || is == std::string::npos) return what;
  return what.substr(start.size(), is - start.size()) + ": '" + what.substr(is + 3) + "' is not what it takes";
}

std::string is_none(const std::string& word, bool whole) {
  return "'" + word + "' is no " + (whole ? "whole " : "") + "number";
}

// What is mistyped matters more than what is missing for it.
std::optional<std::string> unknown_option(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<const CLI::Option*> known;
  list_options(app, known);
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    const auto is_it = [&](const CLI::Option* option) { return option->check_name(name); };
    if (word.rfind("--", 0) == 0 && word.size() > 2 && std::none_of(known.begin(), known.end(), is_it))
      return "unknown option " + name;
  }
  return std::nullopt;
}

int refuse_arguments(const CLI::App& app, const std::string& why) {
  std::cerr << app.get_name() << ": " << why << "\n"
            << CLI::Formatter().make_usage(&app, app.get_name()) << "--help lists all arguments.\n";
  return kFailed;
}

// What is written must be no other file that is named: a result would take the place of its scene. Empty, or the
// reason.
std::string written_over(const CLI::App& app) {
  std::vector<const CLI::Option*> all;
  list_options(app, all);
  for (const CLI::Option* written : all) {
    const std::string name = written->get_name();
    if (!is_written_option(name)) continue;
    for (const std::string& file : written->results()) {
      if (file.empty()) return name + ": is empty, must name what is written";
      for (const CLI::Option* other : all)
        for (const std::string& word : other != written ? other->results() : std::vector<std::string>{})
          if (!word.empty() && is_same_file(file, word))
            return name + ": " + file + " would be written over " + other->get_name() + "; give it a file of its own";
    }
  }
  return "";
}

// Of lists of ranges, each a name and two numbers. Of two with a name the last one would have been taken. Empty, or the
// reason.
std::string fault_of_ranges(const CLI::App& app) {
  std::vector<const CLI::Option*> all;
  list_options(app, all);
  for (const CLI::Option* option : all) {
    if (option->get_type_name() != kRangesTypeName) continue;
    std::set<std::string> names;
    for (std::size_t i = 0; i < option->results().size(); ++i) {
      const std::string& word = option->results()[i];
      if (i % 3 != 0 && !parse_number<double>(word)) return option->get_name() + ": " + is_none(word, false);
      if (i % 3 == 0 && !names.insert(word).second) return option->get_name() + ": '" + word + "' is named twice";
    }
  }
  return "";
}

// What is named here and in settings files must not be written over later, either.
void keep_named_files(const CLI::App& app) {
  std::vector<const CLI::Option*> all;
  list_options(app, all);
  std::vector<OutputName> outputs;
  std::vector<std::string> read;
  for (const CLI::Option* option : all)
    for (const std::string& word : option->results()) {
      std::error_code ignored;
      if (is_written_option(option->get_name()))
        outputs.push_back({option->get_name(), word});
      else if (std::filesystem::is_regular_file(word, ignored))
        read.push_back(word);
    }
  set_outputs(std::move(outputs));
  for (const std::string& file : read) keep_file(file);
}

struct Largest {
  double number;
  std::string unit;
};

// By what the help calls a number, as "S" of "--duration S".
Largest largest_of(const std::string& type_name) {
  static const Largest time{limits::kTime_s, " s"}, place{limits::kPlace_m, " m"}, mass{limits::kMass_kg, " kg"};
  static const std::map<std::string, Largest> largest = {{"S", time},       {"SECONDS", time}, {"M", place},
                                                         {"METRES", place}, {"X Y Z", place},  {"KG", mass}};
  const auto found = largest.find(type_name.substr(0, type_name.find(':')));
  return found == largest.end() ? Largest{limits::kNumber, ""} : found->second;
}

bool is_whole(const std::string& word) {
  const std::size_t first = word.find_first_not_of("+-");
  return first <= 1 && word.find_first_not_of("0123456789", first) == std::string::npos;
}

// Of each number that is given; NaN is in no range. CLI11 would take blanks before a number and hexadecimals, which
// parse_number does not, and nothing at all for zero.
template <class Value>
void limit_numbers(CLI::Option* option) {
  constexpr bool whole = std::is_integral_v<Value>, large = std::is_same_v<Value, std::uint64_t>;
  const auto check = [option](const std::string& word) -> std::string {
    const std::optional<double> value = parse_number<double>(word);
    if (!value && std::is_same_v<Value, Ranges>) return "";  // a name, or see fault_of_ranges()
    if (!value || (whole && !is_whole(word))) return is_none(word, whole);
    if (large) return parse_number<std::uint64_t>(word) ? "" : word + " is not in [0, 18446744073709551615]";
    const auto [largest, unit] = whole ? Largest{limits::kCount, ""} : largest_of(option->get_type_name());
    if (std::abs(*value) <= largest) return "";
    return word + " is not in [" + format_number(-largest) + ", " + format_number(largest) + "]" + unit;
  };
  if (!std::is_same_v<Value, std::string> && !std::is_same_v<Value, std::vector<std::string>>) option->check(check, "");
}

}  // namespace

Argument Argument::type_name(const std::string& name) const { return Argument(option_->type_name(name)); }
Argument Argument::group(const std::string& heading) const { return Argument(option_->group(heading)); }
Argument Argument::show_default() const { return Argument(option_->capture_default_str()); }
Argument Argument::required() const { return Argument(option_->required()); }
Argument Argument::expected(int values) const { return Argument(option_->expected(values)); }
Argument Argument::delimiter(char between_values) const { return Argument(option_->delimiter(between_values)); }
Argument Argument::one_value_at_a_time() const { return Argument(option_->allow_extra_args(false)); }
Argument Argument::in_order() const { return Argument(option_->trigger_on_parse()); }
Argument Argument::range(int low, int high) const { return Argument(option_->check(CLI::Range(low, high))); }
Argument Argument::range(double low, double high) const { return Argument(option_->check(CLI::Range(low, high))); }
Argument Argument::positive() const { return Argument(option_->check(CLI::PositiveNumber)); }
Argument Argument::one_of(const std::vector<std::string>& words) const {
  return Argument(option_->check(CLI::IsMember(words)));
}
Argument Argument::excludes(const Argument& other) const { return Argument(option_->excludes(other.option_)); }

CommandLine::CommandLine(const std::string& what, const std::string& program)
    : app_(std::make_shared<CLI::App>(what, program)) {}
CommandLine::CommandLine(std::shared_ptr<CLI::App> app) : app_(std::move(app)) {}

template <class Value>
Argument CommandLine::add_option(const std::string& name, Value& value, const std::string& meaning) {
  CLI::Option* const option = app_->add_option(name, value, meaning);
  limit_numbers<Value>(option);
  return Argument(option);
}

template <class Value>
Argument CommandLine::add_option_function(const std::string& name, const std::function<void(const Value&)>& take,
                                          const std::string& meaning) {
  CLI::Option* const option = app_->add_option_function<Value>(name, take, meaning);
  limit_numbers<Value>(option);
  return Argument(option);
}

template Argument CommandLine::add_option(const std::string&, std::string&, const std::string&);
template Argument CommandLine::add_option(const std::string&, int&, const std::string&);
template Argument CommandLine::add_option(const std::string&, unsigned&, const std::string&);
template Argument CommandLine::add_option(const std::string&, std::uint64_t&, const std::string&);
template Argument CommandLine::add_option(const std::string&, double&, const std::string&);
template Argument CommandLine::add_option(const std::string&, std::optional<double>&, const std::string&);
template Argument CommandLine::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Argument CommandLine::add_option(const std::string&, Ranges&, const std::string&);

template <class Value>
using Take = std::function<void(const Value&)>;
template Argument CommandLine::add_option_function(const std::string&, const Take<std::string>&, const std::string&);
template Argument CommandLine::add_option_function(const std::string&, const Take<double>&, const std::string&);
template Argument CommandLine::add_option_function(const std::string&, const Take<std::vector<std::string>>&,
                                                   const std::string&);
template Argument CommandLine::add_option_function(const std::string&, const Take<std::vector<double>>&,
                                                   const std::string&);

Argument CommandLine::add_flag(const std::string& name, bool& value, const std::string& meaning) {
  return Argument(app_->add_flag(name, value, meaning));
}

Argument CommandLine::add_flag_callback(const std::string& name, const std::function<void()>& take,
                                        const std::string& meaning) {
  return Argument(app_->add_flag_callback(name, take, meaning));
}

void CommandLine::add_set_option(std::vector<std::string>& words) {
  app_->add_option("--set", words, "a number of the file by its path, or a parameter that it names")
      ->type_name("PATH=NUMBER")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

CommandLine CommandLine::add_group(const std::string& heading, const std::string& meaning, std::size_t fewest,
                                   std::size_t most) {
  CLI::Option_group* const group = app_->add_option_group(heading, meaning);
  group->require_option(fewest, most);
  return CommandLine(std::shared_ptr<CLI::App>(app_, group));
}

void CommandLine::footer(const std::string& text) { app_->footer(text); }
void CommandLine::allow_extras() { app_->allow_extras(); }
std::vector<std::string> CommandLine::extras() const { return app_->remaining(); }
std::string CommandLine::program() const { return app_->get_name(); }

std::optional<int> CommandLine::read(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
    if (const std::string why = written_over(*app_); !why.empty()) return refuse_arguments(*app_, why);
    if (const std::string why = fault_of_ranges(*app_); !why.empty()) return refuse_arguments(*app_, why);
    keep_named_files(*app_);
    return std::nullopt;
  } catch (const CLI::CallForHelp&) {
    std::cout << app_->help();
    require_printed();
    return kGood;
  } catch (const CLI::ExtrasError& error) {
    return refuse_arguments(*app_, unexpected(*app_, error));
  } catch (const CLI::RequiredError& error) {
    return refuse_arguments(*app_, unknown_option(*app_, {argv + 1, argv + argc}).value_or(error.what()));
  } catch (const CLI::ConversionError& error) {
    return refuse_arguments(*app_, unconverted(error.what()));
  } catch (const CLI::ParseError& error) {
    return refuse_arguments(*app_, error.what());
  } catch (const WrongArgument& error) {
    return refuse_arguments(*app_, error.what());
  }
}

void require_printed() {
  errno = 0;
  std::cout << std::flush;
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::cout && std::ferror(stdout) == 0) return;
  const bool still = errno == 0 && write(STDOUT_FILENO, "\n", 1) < 0;  // it failed before, for this reason
  throw WriteError("the standard output cannot be written" +
                   (errno != 0 || still ? std::string(": ") + std::strerror(errno) : ""));
}

int run_program(CommandLine& line, int argc, char** argv, const std::function<int()>& run) {
  try {
    if (const std::optional<int> ended = line.read(argc, argv)) return *ended;
    const int status = run();
    require_printed();
    return status;
  } catch (const WriteError& error) {
    std::cerr << line.program() << ": " << printable(error.what()) << "\n";
    return kNotGood;
  } catch (const std::exception& error) {
    std::cerr << line.program() << ": " << reason_of(error) << "\n";
    return kFailed;
  }
}

}  // namespace soft_robot_lab
