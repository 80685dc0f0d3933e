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
inline constexpr double kDensity_kg_m3 = 1e9;       // a density (`_kg_m3`)
inline constexpr double kForce_n = 1e9;             // a force (`_n`)
inline constexpr double kPressure_pa = 1e13;        // a pressure or a modulus (`_pa`)
inline constexpr double kNumber = 1e12;             // any other number of an argument, a message or a service
inline constexpr int kCount = 1000000;              // any other count of an argument
inline constexpr double kFilePlace = 1e6;           // a coordinate of a mesh or STL file, before its scale
inline constexpr double kDepth_m = 65.535;          // a depth in an image
inline constexpr double kWeight = 1e6;              // the weight of a target

// Of runs.
inline constexpr double kSteps = 1e9;        // time steps of a run or a rollout
inline constexpr int kIterations = 1000000;  // iterations of a search
inline constexpr int kTasks = 1000000;       // tasks of a study, and designs of a search
inline constexpr int kSamples = 50000;       // rest states of a workspace
inline constexpr int kThreads = 1000;        // threads or workers at a time, on each host
inline constexpr int kJobs = 100000;         // jobs of Slurm

// Counts in a scene.
inline constexpr int kSolids = 1000;                       // solids in a `solid`, copies of arrays counted each
inline constexpr int kSolidCopies = 1000;                  // copies of one `array`
inline constexpr int kSplinePoints = 500;                  // points of a `spline_m`
inline constexpr int kPolygonCorners = 2000;               // corners of a `polygon_m`
inline constexpr int kObstacles = 1000;                    // obstacles
inline constexpr int kFreeObstacles = 100;                 // obstacles with a `mass_kg`
inline constexpr int kDistanceNodes = 8000000;             // nodes of the grid of distances of an obstacle's `mesh`
inline constexpr std::size_t kObstacleTriangles = 300000;  // triangles of an obstacle's `mesh`
inline constexpr int kMeshCorners = 5000;                  // corners of a free obstacle's `mesh` that stand out
inline constexpr std::size_t kTriangles = 1000000;         // triangles of an STL file, or of a solid's surface

inline constexpr std::size_t kName_characters = 100;       // characters of a name
inline constexpr std::size_t kRollouts = 1000000;          // rollouts of one run
inline constexpr std::size_t kRolloutCommands = 20000000;  // commands of all rollouts together, times counted too

// Files.
inline constexpr std::uintmax_t kSettings_bytes = 16777216;  // bytes of a settings file
// Two million quadratic elements in text take 0.4 GB.
inline constexpr std::uintmax_t kMesh_bytes = 536870912;       // bytes of a mesh, STL or STEP file
inline constexpr std::uintmax_t kCommands_bytes = 1073741824;  // bytes of a file of rollouts' commands
inline constexpr std::uintmax_t kStep_bytes = 1073741824;      // bytes of a STEP file that is written
inline constexpr std::uintmax_t kResult_bytes = 268435456;     // bytes of what a task of a study gives
inline constexpr std::uintmax_t kTaskFile_bytes = 4294967296;  // bytes of a program, library or file that a task uses
inline constexpr std::uintmax_t kLog_bytes = 1048576;          // bytes of what a program said that is read
inline constexpr std::size_t kCommandLine_bytes = 4096;        // bytes of a request to the emulated rig
inline constexpr std::size_t kArchive_bytes = 4294967294;      // bytes of an npz file
inline constexpr std::uint32_t kChunk_bytes = 1073741824;      // bytes of a chunk of a bag, unpacked
inline constexpr long kTree_bytes = 256000000;                 // bytes of a settings file with all that aliases repeat
inline constexpr long kTree_nodes = 500000;                    // values in a settings file
inline constexpr int kTree_depth = 100;                        // maps and lists within each other

// Of the mesher.
inline constexpr double kMemory_gb = 6.0;  // memory of a body's factor, and of the mesher [GB]
inline constexpr double kElements = 2e6;   // elements that are meshed

}  // namespace soft_robot_lab::limits
