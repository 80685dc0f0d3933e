// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_protocol.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "hardware/motor/framing.h"
#include "hardware/motor/motor_driver.h"
#include "hardware/motor/pressure_driver.h"

namespace soft_robot_lab {
namespace {

using Bytes = std::vector<std::uint8_t>;

void require(bool holds) {
  if (!holds) std::abort();
}

bool equal(const wire::Frame& a, const wire::Frame& b) {
  return a.kind == b.kind && a.session == b.session && a.number == b.number && a.length == b.length &&
         std::memcmp(a.payload, b.payload, a.length) == 0;
}

// Sound frames come out as they went in, and none from nothing.
void decode_all(const Bytes& bytes) {
  wire::FrameDecoder decoder;
  std::size_t frames = 0;
  for (const std::uint8_t byte : bytes) {
    if (!decoder.feed(byte)) continue;
    ++frames;
    const wire::Frame frame = decoder.frame();
    require(frame.length <= wire::max_payload);
    std::uint8_t again[wire::max_encoded];
    const std::uint8_t size = wire::encode(frame, again);
    require(size <= wire::max_encoded && again[size - 1] == 0 && std::count(again, again + size, 0) == 1);
    wire::FrameDecoder second;
    bool sound = false;
    for (std::uint8_t i = 0; i < size; ++i) sound = second.feed(again[i]);
    require(sound && equal(frame, second.frame()));
  }
  require(frames <= static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), 0)));
}

// The same bytes cut into frames with a right CRC, so that they get past the decoder.
Bytes frame_up(const Bytes& bytes) {
  Bytes line;
  for (std::size_t at = 0; at + 4 <= bytes.size();) {
    wire::Frame frame;
    frame.kind = static_cast<std::uint8_t>(bytes[at] % 4 == 0 ? bytes[at] : 0x80 + bytes[at] % 4);
    frame.session = static_cast<std::uint8_t>(bytes[at + 1] % 4);
    frame.number = static_cast<std::uint8_t>(bytes[at + 2] % 4);
    frame.length = static_cast<std::uint8_t>(bytes[at + 3] % (wire::max_payload + 1));
    at += 4;
    frame.length = static_cast<std::uint8_t>(std::min<std::size_t>(frame.length, bytes.size() - at));
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), frame.length, frame.payload);
    at += frame.length;
    std::uint8_t encoded[wire::max_encoded];
    line.insert(line.end(), encoded, encoded + wire::encode(frame, encoded));
  }
  return line;
}

class ScriptedPort : public Port {
 public:
  ScriptedPort(const Bytes& script, std::size_t& at) : script_(script), at_(at) {}
  Bytes read() override {
    if (at_ < script_.size() && script_[at_] == 0xfe) {
      ++at_;
      throw PortError("unplugged");
    }
    const std::size_t count = std::min<std::size_t>(16, script_.size() - at_);
    const Bytes bytes(script_.begin() + static_cast<std::ptrdiff_t>(at_),
                      script_.begin() + static_cast<std::ptrdiff_t>(at_ + count));
    at_ += count;
    return bytes;
  }
  void write(const Bytes&) override {}

 private:
  const Bytes& script_;
  std::size_t& at_;
};

const RigSettings& rig() {
  static const RigSettings settings = parse_rig(
      "device: /dev/null\n"
      "motors:\n"
      "  - {name: a, cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: 1.2}}\n"
      "  - {name: b, cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: 1.2}}\n",
      "fuzz");
  return settings;
}

const RigSettings& air() {
  static const RigSettings settings = parse_rig(
      "device: /dev/null\n"
      "sensor: {full_pa: 100000}\n"
      "channels: [{name: a, max_pa: 40000, valves: {deadband_pa: 1000}}]\n",
      "fuzz");
  return settings;
}

// A board that says anything: the driver goes on, and its accounts are right.
template <class Driver>
void drive(const Bytes& script, const RigSettings& settings, double value) {
  std::size_t at = 0;
  Driver driver(settings, {}, [&] { return std::make_unique<ScriptedPort>(script, at); });
  int round = 0;
  for (double now_s = 0.0; at < script.size() || now_s < 0.1; now_s += 0.01) {
    driver.update(now_s);
    if (driver.linked() && ++round % 2 == 0) {
      try {
        driver.command({"a"}, {value}, now_s);
      } catch (const std::invalid_argument&) {
      }
    }
    if (driver.operation() != OperationState::running && script.size() % 3 == 0) driver.clear();
    const CommandCounts counts = driver.commands();
    require(counts.received == counts.acknowledged + counts.superseded + counts.refused + counts.pending);
    require(now_s < 1e4);
  }
}

}  // namespace

void fuzz_protocol(const std::uint8_t* input, std::size_t size) {
  const Bytes bytes(input, input + size);
  decode_all(bytes);
  decode_all(frame_up(bytes));
  for (const Bytes& script : {bytes, frame_up(bytes)}) {
    drive<MotorDriver>(script, rig(), 0.9);
    drive<PressureDriver>(script, air(), 2e4);
  }
}

}  // namespace soft_robot_lab
