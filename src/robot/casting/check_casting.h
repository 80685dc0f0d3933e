// SPDX-License-Identifier: BSD-3-Clause
// Can this robot be cast, and if not, why? See README.md beside this file.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "extraction.h"
#include "ray_tree.h"
#include "robot/design/casting_settings.h"
#include "sheaths.h"

namespace soft_robot_lab {

// What the rules need of a robot.
struct CastRobot {
  Surface surface;
  std::vector<SheathPath> sheaths;
  double youngs_modulus_pa = 264200;
  double density_kg_m3 = 1070;
  std::vector<double> mesh_qualities;  // Q_vl of its elements; may be empty
  WorstAlong moved_bend;               // of its sheaths in use; see moved_bends.h
  // Where sheaths lie on shelves: the surface less what they and their shelves take away, which then is judged.
  std::optional<Surface> shelved;
};

struct CastingTest {
  std::string name;
  bool passed = true;
  std::vector<std::pair<std::string, double>> numbers;  // with units in their names; infinite: not found
  std::optional<Eigen::Vector3d> at_m;
  std::string cause;  // may be empty
  std::string why;    // a sentence, where it fails in a mould of one block
  std::string by{};   // what else lets it pass: "two_part" or "lid"; else empty
};

struct CastingVerdict {
  bool castable = false;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  bool direction_given = false;
  std::vector<CastingTest> tests;
  std::string note{};               // on what no test looks at; may be empty
  Surface judged;                   // which the triangles below are of
  std::vector<int> blocked;         // triangles in the way
  std::vector<double> thickness_m;  // of each triangle, by balls

  const CastingTest& test(const std::string& name) const;  // throws std::out_of_range
};

// Unit: the settings' own, or the best, or that with the least skin in the way. Sheaths count as none.
Eigen::Vector3d way_out(const CastShape& shape, const CastingSettings& settings);

CastingVerdict check_casting(const CastRobot& robot, const CastingSettings& settings);

// {castable, direction, tests: {...}, note}.
std::string verdict_json(const CastingVerdict& verdict);

// A test's worst values beside their limits, as "7.9 mm, at least 2 mm"; what does not exist is left out.
std::string margin_text(const CastingTest& test);

}  // namespace soft_robot_lab
