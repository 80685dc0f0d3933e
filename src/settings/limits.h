// SPDX-License-Identifier: BSD-3-Clause
// The largest values, counts, files and amounts of memory that come in by any door: a file, an argument, a service or a
// topic. Every door takes them from here. `config/README.md`, "Limits", lists each by its comment, and
// test/check_sources.py compares both and looks for doors that have limits of their own.
#pragma once

#include <cstddef>
#include <cstdint>

namespace soft_robot_lab::limits {

// Of a number, either way, by the unit that its name ends with. No robot is as large, as fast or as slow; what lies far
// beyond has squares that are no finite numbers.
inline constexpr double kPlace_m = 1e3;             // a coordinate or a length (`_m`)
inline constexpr double kTime_s = 1e6;              // a time (`_s`)
inline constexpr double kSpeed_m_s = 1e3;           // a speed (`_m_s`)
inline constexpr double kAcceleration_m_s2 = 1e5;   // an acceleration (`_m_s2`)
inline constexpr double kAngle_rad = 1e4;           // an angle (`_rad`)
inline constexpr double kAngle_deg = 1e6;           // an angle (`_deg`)
inline constexpr double kAngularSpeed_rad_s = 1e4;  // an angular speed (`_rad_s`)
inline constexpr double kMass_kg = 1e6;             // a mass (`_kg`)

// Counts in a scene.
inline constexpr int kSolids = 1000;          // solids in a `solid`, copies of arrays counted each
inline constexpr int kSolidCopies = 1000;     // copies of one `array`
inline constexpr int kSplinePoints = 500;     // points of a `spline_m`
inline constexpr int kPolygonCorners = 2000;  // corners of a `polygon_m`
inline constexpr int kObstacles = 1000;       // obstacles
inline constexpr int kFreeObstacles = 100;    // obstacles with a `mass_kg`

}  // namespace soft_robot_lab::limits
