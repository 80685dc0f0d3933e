// SPDX-License-Identifier: BSD-3-Clause
// The board's pins for air: sensors on A0 to A3, a pin that fills each channel (on and off, or as a duty), one that
// holds its air, and one for the supply's valve. All low: everything is vented, and so it is while the board boots.
#pragma once

#include <stdint.h>

#include "hardware/motor/wire.h"

namespace soft_robot_lab {
namespace air_pins {

void start();

// Sums of 16 conversions of each of the first `channels` sensors; false while there are no new ones.
void set_channels(uint8_t channels);
bool take(uint16_t (&sums)[wire::max_channels]);

void set_supply(bool open);
void set_hold(uint8_t channel, bool closed);
// In 256ths of the time, 0 to 256: D9, D10, D11 and D3. Between 0 and 256 the pin is pulsed at 976 Hz.
void set_fill(uint8_t channel, uint16_t duty);

}  // namespace air_pins
}  // namespace soft_robot_lab
