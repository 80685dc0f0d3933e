// SPDX-License-Identifier: BSD-3-Clause
#include "air_channel.h"

#include <algorithm>
#include <cmath>

namespace soft_robot_lab {
namespace {

constexpr double kAir_pa = 101325.0;          // absolute, around the robot
constexpr double kNormal_pa = 1.0e5;          // of the conductances
constexpr double kOrifice_m3_s_pa = 2.0e-10;  // sonic conductance of a valve: 0.02 l/(s bar)
constexpr double kBurst_m3_s_pa = 8.0e-9;     // of a tube that has come off
constexpr double kCriticalRatio = 0.5;
constexpr double kSupplyRatio = 1.5;          // of the highest pressure asked for
constexpr double kRegulatorBand_pa = 3000.0;  // so far from its pressure it is fully open
constexpr double kRegulatorDelay_s = 0.02;    // of the filter behind the pulsed pin
constexpr double kLongestStep_s = 0.25e-3;

// Flow [Pa m^3/s] from the higher pressure to the lower, positive from a to b. ISO 6358.
double orifice_flow(double conductance_m3_s_pa, double a_pa, double b_pa) {
  const double high_pa = std::max(a_pa, b_pa);
  const double ratio = std::max(0.0, (std::min(a_pa, b_pa) / high_pa - kCriticalRatio) / (1.0 - kCriticalRatio));
  const double flow = conductance_m3_s_pa * high_pa * kNormal_pa * std::sqrt(std::max(0.0, 1.0 - ratio * ratio));
  return a_pa >= b_pa ? flow : -flow;
}

}  // namespace

AirChannel::AirChannel(const ChannelSettings& settings, std::uint64_t seed)
    : settings_(settings), random_(seed), absolute_pa_(kAir_pa) {}

double AirChannel::pressure_pa() const { return absolute_pa_ - kAir_pa; }

void AirChannel::move_valves(double duration_s, const AirPins& pins) {
  const double asked_pa = pins.fill * settings_.output_pa;
  regulator_pa_ += (asked_pa - regulator_pa_) * std::min(1.0, duration_s / kRegulatorDelay_s);
  if (stuck_ != StuckValve::fill) {
    fill_opening_ = settings_.output_pa > 0.0
                        ? std::clamp((regulator_pa_ - pressure_pa()) / kRegulatorBand_pa, -1.0, 1.0)
                        : pins.fill;
  }
  if (stuck_ != StuckValve::vent) vent_opening_ = pins.hold ? 0.0 : 1.0;
}

double AirChannel::flow_pa_m3_s(const AirPins& pins) const {
  const double highest_pa = std::max(settings_.output_pa, settings_.max_value);
  const double upstream_pa = pins.supply ? kAir_pa + kSupplyRatio * highest_pa : kAir_pa;
  const double behind_pa = fill_opening_ < 0.0 ? kAir_pa : upstream_pa;
  const double opening = std::abs(fill_opening_);
  const double out = vent_opening_ * kOrifice_m3_s_pa + leak_m3_s_pa_ + (burst_ ? kBurst_m3_s_pa : 0.0);
  return orifice_flow(opening * kOrifice_m3_s_pa, behind_pa, absolute_pa_) - orifice_flow(out, absolute_pa_, kAir_pa);
}

void AirChannel::advance(double duration_s, const AirPins& pins) {
  while (duration_s > 0.0) {
    const double step_s = std::min(duration_s, kLongestStep_s);
    duration_s -= step_s;
    move_valves(step_s, pins);
    const double next_pa = absolute_pa_ + step_s * flow_pa_m3_s(pins) / volume_m3_;
    // Close to the air's pressure the root is steep: a step must not swing beyond it.
    absolute_pa_ = absolute_pa_ > kAir_pa ? std::max(next_pa, kAir_pa) : next_pa;
  }
}

void AirChannel::set_frozen(bool frozen) {
  frozen_v_ = sensor_v();
  frozen_ = frozen;
}

double AirChannel::sensor_v() {
  if (silent_) return 0.0;
  if (frozen_) return frozen_v_;
  double unit = -6.0;  // nearly normal, of variance 1, and the same on every platform
  for (int i = 0; i < 12; ++i) unit += static_cast<double>(random_() >> 11) * 0x1p-53;
  const SensorSettings& sensor = settings_.sensor;
  const double slope = (sensor.full_v - sensor.zero_v) / sensor.full_pa;
  return std::clamp(sensor.zero_v + slope * (pressure_pa() + noise_pa_ * unit), 0.0, 5.0);
}

}  // namespace soft_robot_lab
