// SPDX-License-Identifier: BSD-3-Clause
#include "emulated_rig.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <stdexcept>

extern "C" {
#include <simavr/avr_adc.h>
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_spi.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_cycle_timers.h>
}

// Both firmwares as programmed into flash, put here by the assembler.
extern "C" {
extern const std::uint8_t soft_robot_lab_firmware[];
extern const std::uint8_t soft_robot_lab_firmware_end[];
extern const std::uint8_t soft_robot_lab_pressure_firmware[];
extern const std::uint8_t soft_robot_lab_pressure_firmware_end[];
}
__asm__(
    ".section .rodata\n"
    ".global soft_robot_lab_firmware\n"
    "soft_robot_lab_firmware:\n"
    ".incbin \"" SOFT_ROBOT_LAB_FIRMWARE
    "\"\n"
    ".global soft_robot_lab_firmware_end\n"
    "soft_robot_lab_firmware_end:\n"
    ".byte 0\n"
    ".global soft_robot_lab_pressure_firmware\n"
    "soft_robot_lab_pressure_firmware:\n"
    ".incbin \"" SOFT_ROBOT_LAB_PRESSURE_FIRMWARE
    "\"\n"
    ".global soft_robot_lab_pressure_firmware_end\n"
    "soft_robot_lab_pressure_firmware_end:\n"
    ".byte 0\n"
    ".previous\n");

namespace soft_robot_lab {
namespace {

constexpr double cycles_per_s = 16.0e6;
constexpr int select_pin = 2;  // of port B

void be_silent(avr_t*, const int, const char*, std::va_list) {}
void do_not_wait(avr_t*, avr_cycle_count_t) {}

avr_cycle_count_t to_cycles(double time_s) {
  return static_cast<avr_cycle_count_t>(std::llround(time_s * cycles_per_s));
}

}  // namespace

struct EmulatedRig::Board {
  avr_t* avr = nullptr;
  avr_irq_t* uart_input = nullptr;
  avr_irq_t* spi_input = nullptr;
  avr_irq_t* sensor_inputs = nullptr;  // of A0, A1, ...
};

struct EmulatedRig::Image {
  const std::uint8_t* begin;
  const std::uint8_t* end;
};

EmulatedRig::EmulatedRig(const Image& firmware, std::uint64_t seed)
    : to_board_(seed), to_host_(seed + 1), board_(std::make_unique<Board>()) {
  avr_global_logger_set(be_silent);
  avr_t* avr = avr_make_mcu_by_name("atmega328p");
  if (avr == nullptr) throw std::runtime_error("simavr does not know the atmega328p");
  board_->avr = avr;
  avr_init(avr);
  avr->frequency = static_cast<std::uint32_t>(cycles_per_s);
  avr->vcc = avr->avcc = 5000;  // [mV]
  avr->sleep = do_not_wait;
  const auto size = static_cast<std::uint32_t>(firmware.end - firmware.begin);
  avr_loadcode(avr, const_cast<std::uint8_t*>(firmware.begin), size, 0);
  avr->codeend = size;
  connect_line();
}

EmulatedRig::EmulatedRig(int motor_count, std::uint64_t seed)
    : EmulatedRig(Image{soft_robot_lab_firmware, soft_robot_lab_firmware_end}, seed) {
  if (motor_count < 1 || motor_count > wire::max_motors) {
    throw std::invalid_argument("motors: " + std::to_string(motor_count) + " is not in [1, 6]");
  }
  chips_.resize(static_cast<std::size_t>(motor_count));
  connect_chips();
}

EmulatedRig::EmulatedRig(const std::vector<ChannelSettings>& channels, std::uint64_t seed)
    : EmulatedRig(Image{soft_robot_lab_pressure_firmware, soft_robot_lab_pressure_firmware_end}, seed) {
  for (const ChannelSettings& channel : channels) air_.emplace_back(channel, seed + 2 + air_.size());
  connect_sensors();
}

void EmulatedRig::connect_line() {
  avr_t* avr = board_->avr;
  std::uint32_t no_flags = 0;  // simavr would print the bytes, and wait
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &no_flags);
  board_->uart_input = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  avr_irq_register_notify(
      avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
      [](avr_irq_t*, std::uint32_t value, void* rig) {
        static_cast<EmulatedRig*>(rig)->hear(static_cast<std::uint8_t>(value));
      },
      this);
}

void EmulatedRig::connect_chips() {
  avr_t* avr = board_->avr;
  board_->spi_input = avr_io_getirq(avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_INPUT);
  avr_irq_register_notify(
      avr_io_getirq(avr, AVR_IOCTL_SPI_GETIRQ(0), SPI_IRQ_OUTPUT),
      [](avr_irq_t*, std::uint32_t value, void* rig) {
        auto* self = static_cast<EmulatedRig*>(rig);
        avr_raise_irq(self->board_->spi_input, self->exchange(static_cast<std::uint8_t>(value)));
      },
      this);
  avr_irq_register_notify(
      avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('B'), select_pin),
      [](avr_irq_t*, std::uint32_t value, void* rig) { static_cast<EmulatedRig*>(rig)->select(value == 0); }, this);
}

// A sensor is looked at when the board converts its voltage. The word that simavr hands over ends with its input.
void EmulatedRig::connect_sensors() {
  // D3, an output here, is an input of interrupts too: simavr would look at it in each cycle.
  avr_extint_set_strict_lvl_trig(board_->avr, EXTINT_IRQ_OUT_INT1, 0);
  board_->sensor_inputs = avr_io_getirq(board_->avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0);
  avr_irq_register_notify(
      avr_io_getirq(board_->avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_OUT_TRIGGER),
      [](avr_irq_t*, std::uint32_t value, void* rig) {
        auto* self = static_cast<EmulatedRig*>(rig);
        constexpr unsigned input_at_bit = 19;
        const auto input = static_cast<int>(value >> input_at_bit);
        if (input >= self->channel_count()) return;
        const double voltage_v = self->channel(input).sensor_v();
        avr_raise_irq(self->board_->sensor_inputs + input, static_cast<std::uint32_t>(std::lround(1000.0 * voltage_v)));
      },
      this);
}

// By the board's registers. The pin that fills channel 0, 1, 2, 3 is D9, D10, D11, D3; D4 to D7 hold; D8 is the supply.
AirPins EmulatedRig::air_pins(int channel) const {
  constexpr int ddrb = 0x24, portb = 0x25, ddrd = 0x2a, portd = 0x2b, tccr1a = 0x80, tccr2a = 0xb0;
  struct FillPin {
    int ddr, port, bit, control, connect_bit, compare;
  };
  constexpr FillPin pins[] = {{ddrb, portb, 1, tccr1a, 7, 0x88},
                              {ddrb, portb, 2, tccr1a, 5, 0x8a},
                              {ddrb, portb, 3, tccr2a, 7, 0xb3},
                              {ddrd, portd, 3, tccr2a, 5, 0xb4}};
  const std::uint8_t* data = board_->avr->data;
  const auto high = [data](int ddr, int port, int bit) { return (data[ddr] & data[port] & 1 << bit) != 0; };
  const FillPin& pin = pins[channel];
  const bool pulsed = (data[pin.ddr] & 1 << pin.bit) != 0 && (data[pin.control] & 1 << pin.connect_bit) != 0;
  AirPins found;
  found.fill = pulsed ? (data[pin.compare] + 1) / 256.0 : high(pin.ddr, pin.port, pin.bit);
  found.hold = high(ddrd, portd, 4 + channel);
  found.supply = high(ddrb, portb, 0);
  return found;
}

void EmulatedRig::advance_air() {
  const double duration_s = time_s() - air_time_s_;
  air_time_s_ = time_s();
  for (int i = 0; i < channel_count(); ++i) air_[static_cast<std::size_t>(i)].advance(duration_s, air_pins(i));
}

AirChannel& EmulatedRig::channel(int index) {
  advance_air();
  return air_[static_cast<std::size_t>(index)];
}

EmulatedRig::~EmulatedRig() { avr_terminate(board_->avr); }

double EmulatedRig::time_s() const { return static_cast<double>(board_->avr->cycle) / cycles_per_s; }

std::uint8_t EmulatedRig::exchange(std::uint8_t byte) {
  if (!selected_) return 0xff;
  for (StepperChip& chip : chips_) byte = chip.shift(byte);
  return byte;
}

void EmulatedRig::select(bool low) {
  if (selected_ && !low) {
    for (StepperChip& chip : chips_) chip.act(time_s());
  }
  selected_ = low;
}

void EmulatedRig::hear(std::uint8_t byte) {
  if (plugged_) to_host_.push(byte, time_s());
  schedule_hearing();
}

void EmulatedRig::schedule_hearing() {
  const auto arrival_s = to_host_.next_arrival_s();
  host_hears_at_ = arrival_s ? to_cycles(*arrival_s) : UINT64_MAX;
}

void EmulatedRig::send(const std::vector<std::uint8_t>& bytes) {
  if (!plugged_) return;
  for (const std::uint8_t byte : bytes) to_board_.push(byte, time_s());
  schedule_delivery();
}

void EmulatedRig::deliver() {
  while (to_board_.next_arrival_s().value_or(INFINITY) <= time_s()) {
    const std::uint8_t byte = to_board_.pop();
    if (board_->avr->cycle >= boots_until_) avr_raise_irq(board_->uart_input, byte);  // the boot loader hears nothing
  }
}

// Wakes a sleeping processor when the next byte arrives.
void EmulatedRig::schedule_delivery() {
  const auto arrival_s = to_board_.next_arrival_s();
  if (!arrival_s) return;
  avr_t* avr = board_->avr;
  const avr_cycle_count_t due = to_cycles(*arrival_s);
  avr_cycle_timer_register(
      avr, due > avr->cycle ? due - avr->cycle : 1,
      [](avr_t*, avr_cycle_count_t, void* rig) -> avr_cycle_count_t {
        static_cast<EmulatedRig*>(rig)->deliver();
        static_cast<EmulatedRig*>(rig)->schedule_delivery();
        return 0;
      },
      this);
}

std::vector<std::uint8_t> EmulatedRig::run(double until_s) {
  avr_t* avr = board_->avr;
  std::vector<std::uint8_t> heard;
  const avr_cycle_count_t end = to_cycles(until_s);
  while (avr->cycle < end) {
    if (avr->cycle < boots_until_) {
      avr->cycle = std::min<avr_cycle_count_t>(end, boots_until_);
      deliver();
      schedule_delivery();
      continue;
    }
    const int state = avr_run(avr);
    if (state == cpu_Crashed || state == cpu_Done) throw std::runtime_error("the firmware crashed");
    if (avr->cycle < host_hears_at_) continue;
    heard.push_back(to_host_.pop());
    schedule_hearing();
    if (heard.back() == 0) break;
  }
  return heard;
}

void EmulatedRig::set_noise(const LineNoise& noise) {
  noise.validate();
  to_board_.set_noise(noise);
  to_host_.set_noise(noise);
}

void EmulatedRig::unplug() {
  plugged_ = false;
  to_board_.drop_all();
  to_host_.drop_all();
  schedule_hearing();
}

void EmulatedRig::reset_board(double boot_s) {
  advance_air();
  select(false);  // the pin floats up
  const avr_cycle_count_t now = board_->avr->cycle;
  avr_reset(board_->avr);
  board_->avr->cycle = now;
  board_->avr->state = cpu_Running;
  boots_until_ = to_cycles(time_s() + boot_s);
  schedule_delivery();
}

void EmulatedRig::cut_power(double boot_s) {
  for (StepperChip& chip : chips_) chip.power_up(time_s());
  reset_board(boot_s);
}

LineCounts EmulatedRig::line_counts() const {
  LineCounts sum = to_board_.counts();
  const LineCounts& other = to_host_.counts();
  sum.passed += other.passed;
  sum.corrupted += other.corrupted;
  sum.lost += other.lost;
  sum.doubled += other.doubled;
  sum.delayed += other.delayed;
  return sum;
}

}  // namespace soft_robot_lab
