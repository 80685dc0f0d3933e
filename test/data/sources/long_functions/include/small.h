// SPDX-License-Identifier: BSD-3-Clause
// A small thing.
#pragma once

struct Small {
  int size = 1;
};
