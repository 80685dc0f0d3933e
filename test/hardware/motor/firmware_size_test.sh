#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# firmware_size_test.sh AVR_SIZE ELF: of 32 KiB of flash and 2 KiB of RAM a quarter each stays free, for the stack and for
# what is to come.
set -euo pipefail
"$1" --mcu=atmega328p -C "$2" | tee /dev/stderr | awk '
  /^Program:/ { flash = $2 }
  /^Data:/ { ram = $2 }
  END { exit !(flash > 0 && flash < 0.75 * 32768 && ram > 0 && ram < 0.75 * 2048) }'
