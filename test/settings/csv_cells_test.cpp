// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "settings/csv_cells.h"

namespace soft_robot_lab {
namespace {

using Cells = std::vector<std::string>;

TEST(CsvCells, HaveNoBlanksAtTheirEnds) {
  EXPECT_EQ(csv_cells("time_s, left ,right\r"), (Cells{"time_s", "left", "right"}));
  EXPECT_EQ(csv_cells("0,1 2,"), (Cells{"0", "1 2", ""}));
  EXPECT_EQ(csv_cells(""), (Cells{""}));
}

TEST(CsvCells, BeginBehindAByteOrderMark) {
  EXPECT_EQ(csv_cells("\xef\xbb\xbfrollout,left"), (Cells{"rollout", "left"}));
  EXPECT_EQ(csv_cells("\xef\xbb\xbf\"a, b\",c"), (Cells{"a, b", "c"}));
}

TEST(CsvCells, MayHoldCommasAndQuotesInQuotes) {
  EXPECT_EQ(csv_cells(R"("a, b",c)"), (Cells{"a, b", "c"}));
  EXPECT_EQ(csv_cells(R"("said ""no""",2)"), (Cells{R"(said "no")", "2"}));
}

// A damaged line's number is none.
TEST(CsvCells, KeepAQuoteThatNothingCloses) {
  EXPECT_EQ(csv_cells(R"(0,"1)"), (Cells{"0", R"("1)"}));
  EXPECT_EQ(csv_cells(R"("a"b"c,2)"), (Cells{R"(ab"c,2)"}));
}

}  // namespace
}  // namespace soft_robot_lab
