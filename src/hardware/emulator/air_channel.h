// SPDX-License-Identifier: BSD-3-Clause
// The air of one pressure channel: a chamber of fixed volume, fed by valves or a regulator from a common supply, with a
// leak and a sensor. Isothermal; flow through orifices as ISO 6358 has it, with the critical ratio 0.5.
//
//   supply --[common valve]--+--[fill: valve or regulator]--+-- chamber --[leak, burst tube]-- air
//                  shut: air |                              +--[vent, open without current]-- air
#pragma once

#include <cstdint>
#include <random>

#include "hardware/motor/pressure_settings.h"

namespace soft_robot_lab {

struct AirPins {
  double fill = 0.0;  // part of the time, [0, 1]
  bool hold = false;  // the vent is shut
  bool supply = false;
};

enum class StuckValve { none, fill, vent };

class AirChannel {
 public:
  AirChannel(const ChannelSettings& settings, std::uint64_t seed);

  void advance(double duration_s, const AirPins& pins);

  // What the world does to it.
  void set_burst(bool burst) { burst_ = burst; }
  void set_stuck(StuckValve valve) { stuck_ = valve; }       // it stays as it is
  void set_silent(bool silent) { silent_ = silent; }         // the sensor's wire is off
  void set_frozen(bool frozen);                              // the sensor says what it said last
  void set_noise(double noise_pa) { noise_pa_ = noise_pa; }  // of the sensor, root mean square
  void set_volume(double volume_m3) { volume_m3_ = volume_m3; }
  void set_leak(double conductance_m3_s_pa) { leak_m3_s_pa_ = conductance_m3_s_pa; }

  // The truth.
  double pressure_pa() const;  // gauge
  double sensor_v();           // another draw of its noise each time

 private:
  void move_valves(double duration_s, const AirPins& pins);
  double flow_pa_m3_s(const AirPins& pins) const;

  ChannelSettings settings_;
  std::mt19937_64 random_;
  double absolute_pa_;
  double volume_m3_ = 30e-6;
  double leak_m3_s_pa_ = 1e-13;
  double noise_pa_ = 30.0;
  double fill_opening_ = 0.0;  // of the fill valve [0, 1], or of a regulator [-1, 1]: out, in
  double vent_opening_ = 1.0;
  double regulator_pa_ = 0.0;  // what the regulator works for
  double frozen_v_ = 0.0;
  bool burst_ = false, silent_ = false, frozen_ = false;
  StuckValve stuck_ = StuckValve::none;
};

}  // namespace soft_robot_lab
