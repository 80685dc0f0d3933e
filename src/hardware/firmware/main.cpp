// SPDX-License-Identifier: BSD-3-Clause
// The rig's board, an ATmega328P at 16 MHz: frames from the host on the serial line, and what it drives.
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "drives.h"
#include "serial.h"
#include "session.h"

namespace {

volatile uint8_t ticks = 0;  // [ms] not yet worked off

void start_clock() {
  TCCR0A = 1 << WGM01;             // restarts at OCR0A
  TCCR0B = 1 << CS01 | 1 << CS00;  // 250 kHz
  OCR0A = F_CPU / 64 / 1000 - 1;
  TIMSK0 = 1 << OCIE0A;
}

// Until the next interrupt, unless there is something to do: checked with interrupts off, so that none slips between.
void sleep() {
  cli();
  if (ticks == 0 && !soft_robot_lab::serial::has_input()) {
    sleep_enable();
    sei();
    sleep_cpu();
    sleep_disable();
  }
  sei();
}

}  // namespace

ISR(TIMER0_COMPA_vect) { ++ticks; }

// After a reset by the watchdog it would go on biting while the variables are set up.
extern "C" void stop_watchdog() __attribute__((naked, used, section(".init3")));
void stop_watchdog() {
  MCUSR = 0;
  wdt_disable();
}

int main() {
  using namespace soft_robot_lab;
  serial::start();
  drives::start();
  start_clock();
  set_sleep_mode(SLEEP_MODE_IDLE);
  sei();
  wdt_enable(WDTO_250MS);  // a board that hangs is reset, and a reset stops the motors, or lets the air out

  wire::FrameDecoder decoder;
  uint16_t now_ms = 0;
  while (true) {
    wdt_reset();
    uint8_t byte;
    while (serial::read(byte)) {
      if (decoder.feed(byte)) session::handle(decoder.frame());
    }
    if (ticks > 0) {
      cli();
      --ticks;
      sei();
      session::tick(++now_ms);
    }
    sleep();
  }
}
