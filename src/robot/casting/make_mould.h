// SPDX-License-Identifier: BSD-3-Clause
// A planned mould as surfaces, with what was verified of it.
#pragma once

#include <string>
#include <vector>

#include "cast_robot.h"
#include "mould_plan.h"

namespace soft_robot_lab {

// A piece as it stands on the printer's bed: x_piece = rotation * x_robot + offset, its lowest corner at 0.
struct MouldPart {
  std::string name;
  Surface surface;  // of the numbers that its STL has: single precision in millimetres
  Eigen::Matrix3d rotation;
  Eigen::Vector3d offset_m;
  double thinnest_m = 0;  // infinite: nothing opposite anywhere
  bool fits_printer = false;
  std::string step_file;  // with round sides as they are, in the mesher's cache

  Eigen::Vector3d size_m() const { return surface.vertices_m.rowwise().maxCoeff(); }
};

struct Silicone {
  double volume_m3 = 0;  // with what is spare
  double mass_g = 0, part_a_g = 0, part_b_g = 0;
};

struct Mould {
  MouldPlan plan;
  std::vector<MouldPart> parts;
  Surface robot;  // as the pieces leave it room, up while the silicone cures: along the third axis
  double robot_volume_m3 = 0;
  double closure = 0;               // |block - parts - robot| / robot
  double cavity_distance_m = 0;     // of skin and cavity, the largest either way
  double equation_distance_m = 0;   // of the cavity's facets to the shapes' own equations; no more than this
  std::vector<std::string> faults;  // sentences: empty where it is good
  Silicone silicone;
};

constexpr double kLargestClosure = 1e-3;
constexpr double kLargestDistance_m = 1e-4;

// Makes the pieces with the mesher and verifies them. Throws NoMould, std::invalid_argument, or as surface_file_for.
Mould make_mould(const CastRobotFile& file);

// Throws std::runtime_error where write_mould would refuse this folder: it holds other files than a mould, or cannot be
// made. To be asked before the mould is made.
void require_mould_folder(const std::string& folder);

// Writes parts as binary STL, 3MF and STEP in millimetres, mould.json, instructions.html and its pictures into a new
// folder, whole or not at all. An earlier mould there is replaced; a folder with anything else is refused. Throws
// std::runtime_error.
void write_mould(const Mould& mould, const std::string& robot_name, const std::string& folder);

std::string mould_json(const Mould& mould);
std::string mould_instructions(const Mould& mould, const std::string& robot_name);  // HTML

}  // namespace soft_robot_lab
