// SPDX-License-Identifier: BSD-3-Clause
#include "serial.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "hardware/motor/wire.h"

namespace soft_robot_lab {
namespace serial {
namespace {

// One writer, one reader, positions of one byte: no locks. Sizes are powers of two.
template <uint8_t Size>
struct Ring {
  volatile uint8_t bytes[Size];
  volatile uint8_t head = 0;  // next to write
  volatile uint8_t tail = 0;  // next to read

  bool empty() const { return head == tail; }
  uint8_t room() const { return static_cast<uint8_t>(tail - head - 1) & (Size - 1); }
  void push(uint8_t byte) {
    bytes[head] = byte;
    head = (head + 1) & (Size - 1);
  }
  uint8_t pop() {
    const uint8_t byte = bytes[tail];
    tail = (tail + 1) & (Size - 1);
    return byte;
  }
};

Ring<128> received;
Ring<128> sending;

}  // namespace

void start() {
  UCSR0A = 1 << U2X0;
  UBRR0 =
      (F_CPU / 4 / wire::baud_rate - 1) / 2;  // nearest: 117 647 baud at 16 MHz, 2.1 % fast, within what a UART takes
  UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;
  UCSR0B = 1 << RXEN0 | 1 << TXEN0 | 1 << RXCIE0;
}

bool has_input() { return !received.empty(); }

bool read(uint8_t& byte) {
  if (received.empty()) return false;
  byte = received.pop();
  return true;
}

uint8_t room() { return sending.room(); }

void write(const uint8_t* bytes, uint8_t count) {
  for (uint8_t i = 0; i < count; ++i) sending.push(bytes[i]);
  UCSR0B |= 1 << UDRIE0;
}

ISR(USART_RX_vect) {
  const uint8_t byte = UDR0;
  if (received.room() > 0) received.push(byte);  // else the frame is damaged, and sent again
}

ISR(USART_UDRE_vect) {
  if (sending.empty()) {
    UCSR0B &= ~(1 << UDRIE0);
  } else {
    UDR0 = sending.pop();
  }
}

}  // namespace serial
}  // namespace soft_robot_lab
