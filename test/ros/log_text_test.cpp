// SPDX-License-Identifier: BSD-3-Clause
#include "ros/base/log_text.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

TEST(LogText, KeepsWhatIsShort) { EXPECT_EQ(log_text("'x' is no actuator"), "'x' is no actuator"); }

TEST(LogText, CutsLongNamesAndKeepsTheReason) {
  const std::string text = log_text("'" + std::string(1000000, 'x') + "' is no actuator");
  EXPECT_LT(text.size(), 500U);
  EXPECT_EQ(text.substr(0, 3), "'xx");
  EXPECT_EQ(text.substr(text.size() - 16), "' is no actuator");
}

TEST(LogText, IsOneLine) { EXPECT_EQ(log_text("a\nb\033[2Jc"), "a?b?[2Jc"); }

TEST(AnswerText, RepeatsNoNameOfAnyLength) {
  EXPECT_EQ(answer_text(std::invalid_argument("'x' is no actuator")), "'x' is no actuator");
  const std::string text = answer_text(std::invalid_argument("'" + std::string(100000, 'x') + "' is no actuator"));
  EXPECT_LT(text.size(), 4100U);
  EXPECT_EQ(text.substr(text.size() - 16), "' is no actuator");
}

}  // namespace
}  // namespace soft_robot_lab
