// SPDX-License-Identifier: BSD-3-Clause
#include "fault_run.h"

#include <array>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "hardware/testbench/emulated_session.h"

namespace soft_robot_lab {
namespace {

enum class Mishap { unplug, reset, brown_out };

class FaultRun {
 public:
  FaultRun(const RigSettings& rig, const FaultRunOptions& options)
      : options_(options), random_(options.seed), session_(rig, options.seed, options.emulator) {}

  FaultRunResult run() {
    if (!session_.run_until_ready()) throw std::runtime_error("the emulated rig is not ready");
    std::ostringstream noise;
    noise << "noise " << options_.corrupted << ' ' << options_.lost << ' ' << options_.doubled;
    session_.rig.ask(noise.str());
    const auto mishaps = plan_mishaps();
    for (int i = 0; i < options_.commands; ++i) {
      const auto planned = mishaps.equal_range(i);
      for (auto mishap = planned.first; mishap != planned.second; ++mishap) suffer(mishap->second);
      send_command();
      session_.run(between(0.005, 0.025));
      forget_what_was_refused();
      declare();
      if (chance(rest_share)) rest_and_check();
      if (options_.progress && i % 100 == 0) options_.progress(double(i) / options_.commands);
    }
    finish();
    return result_;
  }

 private:
  static constexpr double rest_share = 0.01;
  static constexpr double beyond_limits_share = 0.03;

  // The same numbers on every platform, unlike those of std::uniform_real_distribution.
  double between(double min, double max) { return min + (max - min) * static_cast<double>(random_() >> 11) * 0x1p-53; }
  bool chance(double fraction) { return between(0.0, 1.0) < fraction; }

  std::multimap<int, Mishap> plan_mishaps() {
    std::multimap<int, Mishap> plan;
    const auto add = [&](int count, Mishap mishap) {
      for (int i = 0; i < count; ++i) plan.emplace(static_cast<int>(between(0.0, options_.commands)), mishap);
    };
    add(options_.unplugs, Mishap::unplug);
    add(options_.resets, Mishap::reset);
    add(options_.brown_outs, Mishap::brown_out);
    return plan;
  }

  void suffer(Mishap mishap) {
    expected_ = {};  // what was under way may or may not be done
    if (mishap == Mishap::unplug) {
      ++result_.unplugs;
      session_.rig.unplug();
      session_.run(between(0.01, 1.5));
      session_.rig.replug();
    } else {
      const bool reset = mishap == Mishap::reset;
      ++(reset ? result_.resets : result_.brown_outs);
      session_.rig.ask((reset ? "reset " : "brownout ") + std::to_string(between(0.05, 0.6)));
    }
    expected_ = {};
  }

  void send_command() {
    std::vector<std::string> names;
    std::vector<double> values;
    std::vector<std::size_t> motors;
    for (std::size_t i = 0; i < session_.settings.motors.size(); ++i) {
      if (!chance(0.7)) continue;
      const MotorSettings& motor = session_.settings.motors[i];
      names.push_back(motor.name);
      values.push_back(chance(beyond_limits_share) ? motor.max_value + 0.1 : between(motor.min_value, motor.max_value));
      motors.push_back(i);
    }
    ++result_.commands;
    try {
      session_.command(names, values);
    } catch (const std::invalid_argument&) {
      ++refused_here_;
      return;
    }
    for (std::size_t i = 0; i < motors.size(); ++i) {
      expected_[motors[i]] = steps_of(session_.settings.motors[motors[i]], values[i]);
    }
  }

  // Commands that were accepted and refused later leave it open where their motors go.
  void forget_what_was_refused() {
    const std::int64_t later = session_.driver().commands().refused - refused_here_;
    if (later != refused_later_) expected_ = {};
    refused_later_ = later;
  }

  // A position that is declared unknown is set to zero, as a person would.
  void declare() {
    if (!session_.driver().ready()) return;
    const auto motors = session_.driver().motors();
    bool all_known = true;
    for (std::size_t i = 0; i < motors.size(); ++i) {
      if (!motors[i].known && !declared_unknown_[i]) ++result_.unknown_declared;
      declared_unknown_[i] = !motors[i].known;
      all_known = all_known && motors[i].known;
    }
    if (all_known) return;
    expected_ = {};
    session_.run_until_rest();
    session_.driver().zero();
    session_.finish_operation();
  }

  void rest_and_check() {
    const bool rests = session_.run_until([this] { return session_.driver().ready() && session_.at_rest(); }, 30.0);
    if (!rests) ++result_.stuck;
    forget_what_was_refused();
    const auto motors = session_.driver().motors();
    const auto shafts = session_.rig.shafts();
    for (std::size_t i = 0; i < motors.size(); ++i) {
      if (!motors[i].known || !rests) continue;
      ++result_.checks;
      const bool as_said = motors[i].position_steps == shafts[i].shaft_steps;
      const bool stopped = (motors[i].flags & wire::flag_host_silent) != 0;  // and says so
      const bool as_asked = stopped || !expected_[i] || *expected_[i] == shafts[i].shaft_steps;
      if (!as_said || !as_asked) ++result_.wrong_unflagged;
    }
  }

  void finish() {
    rest_and_check();
    const CommandCounts counts = session_.driver().commands();
    result_.acknowledged = counts.acknowledged;
    result_.superseded = counts.superseded;
    result_.refused = counts.refused;
    result_.unaccounted = result_.commands - counts.acknowledged - counts.superseded - counts.refused;
    const LineFaults line = session_.rig.line_faults();
    result_.corrupted = line.corrupted;
    result_.lost = line.lost;
    result_.doubled = line.doubled;
    result_.emulated_s = session_.rig.time_s();
  }

  FaultRunOptions options_;
  std::mt19937_64 random_;
  EmulatedSession session_;
  FaultRunResult result_;
  std::array<std::optional<double>, wire::max_motors>
      expected_{};  // shafts in full steps, where commands leave no doubt
  std::array<bool, wire::max_motors> declared_unknown_{};
  std::int64_t refused_here_ = 0, refused_later_ = 0;
};

}  // namespace

FaultRunResult run_with_faults(const RigSettings& rig, const FaultRunOptions& options) {
  return FaultRun(rig, options).run();
}

}  // namespace soft_robot_lab
