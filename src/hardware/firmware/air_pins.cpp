// SPDX-License-Identifier: BSD-3-Clause
#include "air_pins.h"

#include <avr/interrupt.h>
#include <avr/io.h>

namespace soft_robot_lab {
namespace air_pins {
namespace {

constexpr uint8_t samples = wire::channel::samples;

volatile uint16_t summed[wire::max_channels];
volatile bool fresh = false;
uint16_t sums_so_far[wire::max_channels];
volatile uint8_t channels_in_use = 0;
uint8_t channel = 0;  // that is converted now
uint8_t taken = 0;    // samples of each
bool is_old = false;  // the conversion under way began before the channels were set

// How the pins that fill are pulsed: their bits, compare registers and the bits that connect those.
struct FillPin {
  volatile uint8_t* port;
  uint8_t bit;
  volatile uint8_t* compare;  // the low byte is enough: eight bits
  volatile uint8_t* control;
  uint8_t connect;
};

const FillPin fill_pins[wire::max_channels] = {{&PORTB, 1 << PB1, &OCR1AL, &TCCR1A, 1 << COM1A1},  // D9
                                               {&PORTB, 1 << PB2, &OCR1BL, &TCCR1A, 1 << COM1B1},  // D10
                                               {&PORTB, 1 << PB3, &OCR2A, &TCCR2A, 1 << COM2A1},   // D11
                                               {&PORTD, 1 << PD3, &OCR2B, &TCCR2A, 1 << COM2B1}};  // D3

bool pulsing = false;

// At 976 Hz, eight bits, by timers 1 and 2; valves need none of them.
void start_pulsing() {
  pulsing = true;
  TCCR1A = 1 << WGM10;
  TCCR1B = 1 << WGM12 | 1 << CS11 | 1 << CS10;
  TCCR2A = 1 << WGM21 | 1 << WGM20;
  TCCR2B = 1 << CS22;
}

void convert(uint8_t of_channel) {
  ADMUX = 1 << REFS0 | of_channel;  // against the board's 5 V, which feed the sensors too
  ADCSRA |= 1 << ADSC;
}

}  // namespace

void start() {
  DDRB |= 1 << PB0 | 1 << PB1 | 1 << PB2 | 1 << PB3;
  DDRD |= 1 << PD3 | 1 << PD4 | 1 << PD5 | 1 << PD6 | 1 << PD7;
  ADCSRA = 1 << ADEN | 1 << ADIE | 1 << ADPS2 | 1 << ADPS1 | 1 << ADPS0;  // 125 kHz: 104 us a conversion
}

void set_channels(uint8_t channels) {
  cli();
  const bool runs = channels_in_use > 0;  // then a conversion is always under way
  channels_in_use = channels;
  fresh = false;
  channel = taken = 0;
  is_old = runs;
  for (uint16_t& sum : sums_so_far) sum = 0;
  sei();
  if (!runs && channels > 0) convert(0);
}

bool take(uint16_t (&sums)[wire::max_channels]) {
  if (!fresh) return false;
  cli();
  for (uint8_t i = 0; i < wire::max_channels; ++i) sums[i] = summed[i];
  fresh = false;
  sei();
  return true;
}

void set_supply(bool open) {
  if (open) {
    PORTB |= 1 << PB0;  // D8
  } else {
    PORTB &= ~(1 << PB0);
  }
}

void set_hold(uint8_t of_channel, bool closed) {
  const uint8_t bit = static_cast<uint8_t>(1 << (PD4 + of_channel));  // D4 to D7
  if (closed) {
    PORTD |= bit;
  } else {
    PORTD &= ~bit;
  }
}

void set_fill(uint8_t of_channel, uint16_t duty) {
  const FillPin& pin = fill_pins[of_channel];
  if (duty == 0 || duty >= 256) {
    *pin.control &= ~pin.connect;
    if (duty == 0) {
      *pin.port &= ~pin.bit;
    } else {
      *pin.port |= pin.bit;
    }
    return;
  }
  if (!pulsing) start_pulsing();
  *pin.compare = static_cast<uint8_t>(duty - 1);
  *pin.control |= pin.connect;
}

ISR(ADC_vect) {
  const uint8_t channels = channels_in_use;
  const uint16_t sample = ADC;
  if (is_old) {
    is_old = false;
    convert(0);
    return;
  }
  sums_so_far[channel] += sample;
  if (++channel >= channels) {
    channel = 0;
    if (++taken >= samples) {
      taken = 0;
      for (uint8_t i = 0; i < channels; ++i) {
        summed[i] = sums_so_far[i];
        sums_so_far[i] = 0;
      }
      fresh = true;
    }
  }
  convert(channel);
}

}  // namespace air_pins
}  // namespace soft_robot_lab
