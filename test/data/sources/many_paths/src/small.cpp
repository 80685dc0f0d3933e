// SPDX-License-Identifier: BSD-3-Clause
// if (a && b) || this is not counted, nor "if" or '?'.
int much(int a, int b) {
  if (a == 0 && b > 0) return 0;
  if (a == 1 && b > 0) return 1;
  if (a == 2 && b > 0) return 2;
  if (a == 3 && b > 0) return 3;
  if (a == 4 && b > 0) return 4;
  if (a == 5 && b > 0) return 5;
  if (a == 6 && b > 0) return 6;
  if (a == 7 && b > 0) return 7;
  if (a == 8 && b > 0) return 8;
  if (a == 9 && b > 0) return 9;
  return 0;
}
