// SPDX-License-Identifier: BSD-3-Clause
constexpr int kMostThreads = 7;
