// SPDX-License-Identifier: BSD-3-Clause
class Many {
 private:
  static const int shared_ = 0;
  int a_ = 0, b_ = 0, c_ = 0, d_ = 0, e_ = 0, f_ = 0, g_ = 0, h_ = 0;
  int i_ = 0, j_ = 0, k_ = 0, l_ = 0, m_ = 0, n_ = 0, o_ = 0, p_ = 0;
};
