// SPDX-License-Identifier: BSD-3-Clause
#pragma once
inline constexpr double kPlace_m = 1e3;  // a coordinate
