// SPDX-License-Identifier: BSD-3-Clause
// Numbers that a test holds to a reference, for the tables of test/benchmark: `--gtest_output=json` writes them.
#pragma once

#include <iomanip>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace soft_robot_lab {

// `what`: "case | elements | quantity [unit]", unique within a test.
inline void expect_near_reference(const std::string& what, double found, double reference, double tolerance) {
  EXPECT_NEAR(found, reference, tolerance) << what;
  std::ostringstream both;
  both << std::setprecision(9) << found << " of " << reference;
  testing::Test::RecordProperty(what, both.str());
}

inline std::string rounded(double value) {  // as a reader writes it
  std::ostringstream text;
  text << std::setprecision(6) << value;
  return text.str();
}

}  // namespace soft_robot_lab
