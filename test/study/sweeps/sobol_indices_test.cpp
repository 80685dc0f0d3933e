// SPDX-License-Identifier: BSD-3-Clause
// Sobol indices against closed forms.
#include "study/sweeps/sobol_indices.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "study/sweeps/sampling.h"

namespace soft_robot_lab {
namespace {

using Function = std::function<double(const std::vector<double>&)>;

// A study's table over [-pi, pi] in each parameter.
ResultsTable table_of(int parameters, int base_points, const Function& function) {
  StudySettings study;
  study.method = SamplingMethod::sobol_indices;
  study.samples = base_points;
  for (int i = 0; i < parameters; ++i) {
    study.parameters.push_back({"x" + std::to_string(i), {}, -M_PI, M_PI});
  }
  ResultsTable table;
  for (const StudyParameter& parameter : study.parameters) table.parameters.push_back(parameter.name);
  table.results = {"f"};
  table.columns.emplace_back();
  for (const std::vector<double>& point : sample(study)) {
    table.columns[0].push_back(function(point));
    table.tasks.push_back({"", point, 0});
  }
  return table;
}

// Ishigami and Homma 1990 with a = 7, b = 0.1, whose indices are known: variances of the parts over 13.8446.
double ishigami(const std::vector<double>& x) {
  return std::sin(x[0]) + 7.0 * std::pow(std::sin(x[1]), 2) + 0.1 * std::pow(x[2], 4) * std::sin(x[0]);
}

TEST(SobolIndices, AreThoseOfIshigamisFunction) {
  const auto found = sobol_indices(table_of(3, 8192, ishigami), 0);
  ASSERT_TRUE(found);
  const double first[] = {0.3139, 0.4424, 0.0}, total[] = {0.5576, 0.4424, 0.2437};
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(found->first[p].value, first[p], 0.01) << p;
    EXPECT_NEAR(found->total[p].value, total[p], 0.01) << p;
    EXPECT_LT(found->first[p].low, first[p]);
    EXPECT_GT(found->first[p].high, first[p]);
    EXPECT_LT(found->total[p].high - found->total[p].low, 0.07);
  }
}

TEST(SobolIndices, LeaveOutBasePointsWithoutAResult) {
  ResultsTable table = table_of(2, 256, [](const auto& x) { return 1000.0 + 2.0 * x[0] + x[1]; });
  for (std::size_t row = 0; row < 20; ++row) table.columns[0][row] = nullptr;  // of five base points
  const auto found = sobol_indices(table, 0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->base_points, 251u);
  EXPECT_NEAR(found->first[0].value, 0.8, 0.03);
  EXPECT_NEAR(found->total[1].value, 0.2, 0.03);
}

TEST(SobolIndices, OfAResultThatDoesNotVaryAreNothing) {
  EXPECT_FALSE(sobol_indices(table_of(2, 16, [](const auto&) { return 3.0; }), 0));
}

TEST(SobolIndices, ChangeOneParameterAtATimeAndKeepTheirPointsInALongerStudy) {
  const ResultsTable small = table_of(3, 4, ishigami), large = table_of(3, 8, ishigami);
  ASSERT_EQ(small.tasks.size(), 20u);
  for (std::size_t row = 0; row < 20; ++row) EXPECT_EQ(small.tasks[row].values, large.tasks[row].values);
  const auto &a = small.tasks[5].values, &b = small.tasks[6].values;
  for (std::size_t p = 0; p < 3; ++p) {
    std::vector<double> expected = a;
    expected[p] = b[p];
    EXPECT_NE(a[p], b[p]);
    EXPECT_EQ(small.tasks[7 + p].values, expected);
  }
}

}  // namespace
}  // namespace soft_robot_lab
