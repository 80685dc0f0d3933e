// SPDX-License-Identifier: BSD-3-Clause
#include "control.h"

#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace soft_robot_lab {
namespace {

class Words {
 public:
  explicit Words(const std::string& line) : stream_(line) {}

  std::string text(const char* name) {
    std::string word;
    if (!(stream_ >> word)) throw std::invalid_argument(std::string(name) + ": missing");
    return word;
  }
  double number(const char* name, double min, double max) {
    const std::string word = text(name);
    std::size_t used = 0;
    double value = NAN;
    try {
      value = std::stod(word, &used);
    } catch (const std::exception&) {
    }
    if (used != word.size() || !(value >= min && value <= max)) {
      std::ostringstream message;
      message << name << ": " << word << " is not a number in [" << min << ", " << max << "]";
      throw std::invalid_argument(message.str());
    }
    return value;
  }
  double number_or(const char* name, double otherwise, double min, double max) {
    return (stream_ >> std::ws).eof() ? otherwise : number(name, min, max);
  }
  bool on_or_off() {
    const std::string word = text("on or off");
    if (word != "on" && word != "off") throw std::invalid_argument("'" + word + "' is neither on nor off");
    return word == "on";
  }
  int motor(const EmulatedRig& rig) { return static_cast<int>(number("motor", 0, rig.motor_count() - 1)); }
  int channel(const EmulatedRig& rig) { return static_cast<int>(number("channel", 0, rig.channel_count() - 1)); }
  StuckValve valve() {
    const std::string word = text("fill, vent or off");
    const std::map<std::string, StuckValve> valves = {
        {"fill", StuckValve::fill}, {"vent", StuckValve::vent}, {"off", StuckValve::none}};
    const auto found = valves.find(word);
    if (found == valves.end()) throw std::invalid_argument("'" + word + "' is neither fill, vent nor off");
    return found->second;
  }
  std::string rest() {
    std::string word;
    stream_ >> word;
    return word;
  }

 private:
  std::istringstream stream_;
};

int nibble(char digit) {
  const std::string digits = "0123456789abcdef";
  const auto at = digits.find(digit);
  if (at == std::string::npos) throw std::invalid_argument(std::string("bytes: '") + digit + "' is not a hex digit");
  return static_cast<int>(at);
}

std::vector<std::uint8_t> from_hex(const std::string& text) {
  if (text.size() % 2 != 0) throw std::invalid_argument("bytes: odd number of hex digits");
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(nibble(text[i]) << 4 | nibble(text[i + 1])));
  }
  return bytes;
}

std::string to_hex(const std::vector<std::uint8_t>& bytes) {
  const std::string digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

std::string time_us(const EmulatedRig& rig) { return std::to_string(std::llround(rig.time_s() * 1e6)); }

std::string run(EmulatedRig& rig, Words& words) {
  const double duration_s = words.number("duration [us]", 0.0, 1e9) * 1e-6;
  rig.send(from_hex(words.rest()));
  const auto heard = rig.run(rig.time_s() + duration_s);
  return time_us(rig) + " " + to_hex(heard);
}

std::string shafts(EmulatedRig& rig) {
  std::ostringstream text;
  text.precision(12);
  text << time_us(rig);
  for (int i = 0; i < rig.motor_count(); ++i) {
    StepperChip& chip = rig.chip(i);
    text << ' ' << chip.shaft_steps(rig.time_s()) << ' ' << chip.spool_steps(rig.time_s()) << ' '
         << chip.moving(rig.time_s());
  }
  return text.str();
}

std::string pressures(EmulatedRig& rig) {
  std::ostringstream text;
  text.precision(12);
  text << time_us(rig);
  for (int i = 0; i < rig.channel_count(); ++i) text << ' ' << rig.channel(i).pressure_pa();
  return text.str();
}

std::string counts(const EmulatedRig& rig) {
  const LineCounts counted = rig.line_counts();
  std::ostringstream text;
  text << counted.passed << ' ' << counted.corrupted << ' ' << counted.lost << ' ' << counted.doubled << ' '
       << counted.delayed;
  return text.str();
}

std::string noise(EmulatedRig& rig, Words& words) {
  LineNoise noise;
  noise.corrupted = words.number("corrupted", 0, 1);
  noise.lost = words.number("lost", 0, 1);
  noise.doubled = words.number("doubled", 0, 1);
  noise.delayed = words.number_or("delayed", 0, 0, 1);
  noise.delay_s = words.number_or("delay_s", noise.delay_s, 0, 10);
  rig.set_noise(noise);
  return "";
}

using Command = std::function<std::string(EmulatedRig&, Words&)>;

Command condition(void (StepperChip::*set)(bool, double)) {
  return [set](EmulatedRig& rig, Words& words) {
    StepperChip& chip = rig.chip(words.motor(rig));
    (chip.*set)(words.on_or_off(), rig.time_s());
    return std::string();
  };
}

// With what remains silent for a command that answers nothing.
template <typename Action>
Command action(Action act) {
  return [act](EmulatedRig& rig, Words& words) {
    act(rig, words);
    return std::string();
  };
}

constexpr double boot_loader_s = 0.5;

using Commands = std::map<std::string, Command>;

const Commands& commands_of_any_rig() {
  static const Commands table = {
      {"counts", [](EmulatedRig& rig, Words&) { return counts(rig); }},
      {"noise", noise},
      {"unplug", action([](EmulatedRig& rig, Words&) { rig.unplug(); })},
      {"replug", action([](EmulatedRig& rig, Words&) { rig.replug(); })},
      {"reset",
       action([](EmulatedRig& rig, Words& w) { rig.reset_board(w.number_or("boot_s", boot_loader_s, 0, 10)); })},
      {"brownout",
       action([](EmulatedRig& rig, Words& w) { rig.cut_power(w.number_or("boot_s", boot_loader_s, 0, 10)); })},
  };
  return table;
}

const Commands& commands_of_motors() {
  static const Commands table = {
      {"shafts", [](EmulatedRig& rig, Words&) { return shafts(rig); }},
      {"stall", condition(&StepperChip::set_stalled)},
      {"overcurrent", condition(&StepperChip::set_overcurrent)},
      {"overheat", condition(&StepperChip::set_overheated)},
      {"undervoltage", condition(&StepperChip::set_undervoltage)},
      {"slip", action([](EmulatedRig& rig, Words& w) {
         StepperChip& chip = rig.chip(w.motor(rig));
         chip.slip(w.number("steps", -1e6, 1e6));
       })},
      {"backlash", action([](EmulatedRig& rig, Words& w) {
         StepperChip& chip = rig.chip(w.motor(rig));
         chip.set_backlash(w.number("steps", 0, 1e3));
       })},
  };
  return table;
}

Command air_condition(void (AirChannel::*set)(bool)) {
  return action([set](EmulatedRig& rig, Words& words) {
    AirChannel& channel = rig.channel(words.channel(rig));
    (channel.*set)(words.on_or_off());
  });
}

Command air_number(void (AirChannel::*set)(double), const char* name, double min, double max, double unit) {
  return action([=](EmulatedRig& rig, Words& words) {
    AirChannel& channel = rig.channel(words.channel(rig));
    (channel.*set)(unit * words.number(name, min, max));
  });
}

const Commands& commands_of_air() {
  static const Commands table = {
      {"pressures", [](EmulatedRig& rig, Words&) { return pressures(rig); }},
      {"burst", air_condition(&AirChannel::set_burst)},
      {"silent", air_condition(&AirChannel::set_silent)},
      {"freeze", air_condition(&AirChannel::set_frozen)},
      {"stuck", action([](EmulatedRig& rig, Words& w) {
         AirChannel& channel = rig.channel(w.channel(rig));
         channel.set_stuck(w.valve());
       })},
      {"sensor_noise", air_number(&AirChannel::set_noise, "noise [Pa]", 0, 1e5, 1.0)},
      {"volume", air_number(&AirChannel::set_volume, "volume [ml]", 1, 1e4, 1e-6)},
      {"leak", air_number(&AirChannel::set_leak, "leak [l/(s bar)]", 0, 1, 1e-8)},
  };
  return table;
}

const Command& find_command(const EmulatedRig& rig, const std::string& name) {
  const Commands& own = rig.channel_count() > 0 ? commands_of_air() : commands_of_motors();
  for (const Commands* table : {&commands_of_any_rig(), &own})
    if (const auto found = table->find(name); found != table->end()) return found->second;
  throw std::invalid_argument("unknown command '" + name + "'");
}

}  // namespace

std::string answer(EmulatedRig& rig, const std::string& line, bool lock_step) {
  try {
    Words words(line);
    const std::string name = words.text("command");
    if (name == "run" && lock_step) return "ok " + run(rig, words);
    const std::string answer = find_command(rig, name)(rig, words);
    return answer.empty() ? "ok" : "ok " + answer;
  } catch (const std::invalid_argument& error) {
    return std::string("error ") + error.what();
  }
}

}  // namespace soft_robot_lab
