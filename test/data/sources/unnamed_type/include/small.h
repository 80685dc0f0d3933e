// SPDX-License-Identifier: BSD-3-Clause
#pragma once

struct Small {
  int size = 1;
};
