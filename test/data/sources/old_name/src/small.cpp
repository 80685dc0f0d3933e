// SPDX-License-Identifier: BSD-3-Clause
int one() { return 1; }
int two() { return 2; }
struct MarkerSight {};
