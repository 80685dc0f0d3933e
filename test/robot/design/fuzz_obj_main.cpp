// SPDX-License-Identifier: BSD-3-Clause
// For libFuzzer; see test/README.md.
#include "fuzz_obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  soft_robot_lab::fuzz_obj(data, size);
  return 0;
}
