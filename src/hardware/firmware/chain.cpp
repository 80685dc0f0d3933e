// SPDX-License-Identifier: BSD-3-Clause
#include "chain.h"

#include <avr/io.h>
#include <util/delay.h>

#include "hardware/motor/l6470.h"

namespace soft_robot_lab {
namespace chain {
namespace {

constexpr uint8_t select_pin = 1 << PB2;  // D10 of the board
uint8_t chips = 0;

void select() { PORTB &= ~select_pin; }

void release() {
  PORTB |= select_pin;
  _delay_us(1);  // at least 800 ns between bytes
}

uint8_t exchange(uint8_t byte) {
  SPDR = byte;
  while ((SPSR & 1 << SPIF) == 0) {
  }
  return SPDR;
}

// One byte to and from each chip.
void exchange_all(uint8_t (&bytes)[wire::max_motors]) {
  select();
  for (uint8_t i = chips; i-- > 0;) bytes[i] = exchange(bytes[i]);
  release();
}

void send(uint8_t mask, uint8_t byte) {
  uint8_t bytes[wire::max_motors];
  for (uint8_t i = 0; i < chips; ++i) bytes[i] = (mask & 1 << i) != 0 ? byte : uint8_t{l6470::nop};
  exchange_all(bytes);
}

// A marker goes round until it comes back; then NOPs fill the chain, so that no chip takes it for a command.
uint8_t count_chips() {
  constexpr uint8_t marker = 0xa5;
  uint8_t found = 0;
  select();
  for (uint8_t i = 0; i <= wire::max_motors; ++i) exchange(l6470::nop);
  exchange(marker);
  for (uint8_t i = 1; i <= wire::max_motors && found == 0; ++i) {
    if (exchange(l6470::nop) == marker) found = i;
  }
  for (uint8_t i = 0; i <= wire::max_motors; ++i) exchange(l6470::nop);
  release();
  return found;
}

}  // namespace

void start() {
  PORTB |= select_pin;
  DDRB |= select_pin | 1 << PB3 | 1 << PB5;             // MOSI and the clock
  SPCR = 1 << SPE | 1 << MSTR | 1 << CPOL | 1 << CPHA;  // mode 3, 4 MHz; the chip takes 5
  // A reset may have cut a longer command off; zeros end it. What they set is set again, what they start is stopped.
  chips = wire::max_motors;
  for (uint8_t i = 0; i < 4; ++i) send(0, l6470::nop);
  chips = count_chips();
}

uint8_t count() { return chips; }

void command(uint8_t mask, uint8_t byte) { send(mask, byte); }

void set(uint8_t mask, uint8_t address, uint32_t value) {
  send(mask, static_cast<uint8_t>(l6470::set_param | address));
  for (uint8_t i = l6470::register_bytes(address); i-- > 0;) send(mask, static_cast<uint8_t>(value >> 8 * i));
}

void go_to(uint8_t mask, const int32_t (&positions)[wire::max_motors]) {
  send(mask, l6470::go_to);
  for (uint8_t i = 3; i-- > 0;) {
    uint8_t bytes[wire::max_motors] = {};
    for (uint8_t k = 0; k < chips; ++k) {
      if ((mask & 1 << k) != 0) bytes[k] = static_cast<uint8_t>(static_cast<uint32_t>(positions[k]) >> 8 * i);
    }
    exchange_all(bytes);
  }
}

void get(uint8_t address, uint32_t (&values)[wire::max_motors]) {
  for (uint32_t& value : values) value = 0;
  send(0xff, static_cast<uint8_t>(l6470::get_param | address));
  for (uint8_t i = l6470::register_bytes(address); i-- > 0;) {
    uint8_t bytes[wire::max_motors] = {};
    exchange_all(bytes);
    for (uint8_t k = 0; k < chips; ++k) values[k] = values[k] << 8 | bytes[k];
  }
}

void get_positions(int32_t (&positions)[wire::max_motors]) {
  uint32_t values[wire::max_motors];
  get(l6470::abs_pos, values);
  for (uint8_t i = 0; i < chips; ++i) {
    positions[i] = static_cast<int32_t>(values[i] << 10) >> 10;  // 22 bits with sign
  }
}

void clear_status(uint8_t mask) {
  send(mask, l6470::get_status);
  send(0, l6470::nop);
  send(0, l6470::nop);
}

}  // namespace chain
}  // namespace soft_robot_lab
