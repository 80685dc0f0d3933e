// SPDX-License-Identifier: BSD-3-Clause
#include "study/sweeps/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

StudyParameter range(double min, double max, int steps = 0) {
  StudyParameter parameter;
  parameter.min = min;
  parameter.max = max;
  parameter.steps = steps;
  return parameter;
}

StudyParameter values(std::vector<double> list) {
  StudyParameter parameter;
  parameter.values = std::move(list);
  return parameter;
}

StudySettings study(SamplingMethod method, int samples, std::vector<StudyParameter> parameters, int seed = 1) {
  StudySettings settings;
  settings.method = method;
  settings.samples = samples;
  settings.parameters = std::move(parameters);
  settings.seed = seed;
  return settings;
}

// How many of `slices` equal parts of [0, 1) hold a value of this parameter.
std::size_t filled(const std::vector<std::vector<double>>& points, std::size_t parameter, int slices) {
  std::set<int> found;
  for (const auto& point : points) found.insert(static_cast<int>(point[parameter] * slices));
  return found.size();
}

TEST(Sampling, GridHoldsAllPairsAndRunsThroughTheLastParameterFirst) {
  const auto points = sample(study(SamplingMethod::grid, 0, {values({1, 2}), range(0.0, 1.0, 3)}));
  const std::vector<std::vector<double>> expected = {{1, 0}, {1, 0.5}, {1, 1}, {2, 0}, {2, 0.5}, {2, 1}};
  EXPECT_EQ(points, expected);
}

TEST(Sampling, LogarithmicStepsHaveEqualRatios) {
  StudyParameter parameter = range(1.0, 100.0, 3);
  parameter.logarithmic = true;
  const auto points = sample(study(SamplingMethod::grid, 0, {parameter}));
  EXPECT_EQ(points[0][0], 1.0);
  EXPECT_NEAR(points[1][0], 10.0, 1e-12);
  EXPECT_EQ(points[2][0], 100.0);
}

StudyParameter distribution(Distribution kind, double centre, double deviation, double min, double max) {
  StudyParameter parameter = range(min, max);
  parameter.distribution = kind;
  parameter.centre = centre;
  parameter.deviation = deviation;
  return parameter;
}

TEST(Sampling, DistributionsHaveTheirMiddleAndDeviation) {
  const double endless = std::numeric_limits<double>::infinity();
  const auto points = sample(study(SamplingMethod::latin_hypercube, 4000,
                                   {distribution(Distribution::normal, 5.0, 2.0, -endless, endless),
                                    distribution(Distribution::log_normal, 3.0, 0.5, 0.0, endless)}));
  double mean = 0.0, square = 0.0, log_mean = 0.0, log_square = 0.0;
  for (const auto& point : points) {
    mean += point[0] / 4000;
    square += std::pow(point[0] - 5.0, 2) / 4000;
    log_mean += std::log(point[1]) / 4000;
    log_square += std::pow(std::log(point[1] / 3.0), 2) / 4000;
  }
  EXPECT_NEAR(mean, 5.0, 0.01);
  EXPECT_NEAR(std::sqrt(square), 2.0, 0.02);
  EXPECT_NEAR(log_mean, std::log(3.0), 0.003);
  EXPECT_NEAR(std::sqrt(log_square), 0.5, 0.005);
}

// Half a normal distribution: its median lies where the whole one has three quarters.
TEST(Sampling, ACutDistributionKeepsItsShape) {
  const auto points =
      sample(study(SamplingMethod::latin_hypercube, 1001, {distribution(Distribution::normal, 0.0, 1.0, 0.0, 6.0)}));
  std::vector<double> found;
  for (const auto& point : points) found.push_back(point[0]);
  std::sort(found.begin(), found.end());
  EXPECT_GE(found.front(), 0.0);
  EXPECT_NEAR(found[500], 0.67449, 0.003);
}

TEST(Sampling, GridRefusesMoreThanAMillionPoints) {
  EXPECT_THROW(sample(study(SamplingMethod::grid, 0, {range(0, 1, 1001), range(0, 1, 1001)})), std::invalid_argument);
}

TEST(Sampling, LatinHypercubeHasOnePointInEachSliceOfEachParameter) {
  const auto points = sample(study(SamplingMethod::latin_hypercube, 37, {range(0, 1), range(0, 1), range(0, 1)}));
  for (std::size_t parameter = 0; parameter < 3; ++parameter) EXPECT_EQ(filled(points, parameter, 37), 37u);
}

TEST(Sampling, LatinHypercubeTakesEachOfTheValuesEquallyOften) {
  const auto points = sample(study(SamplingMethod::latin_hypercube, 30, {values({1, 2, 3})}));
  int twos = 0;
  for (const auto& point : points) twos += point[0] == 2.0 ? 1 : 0;
  EXPECT_EQ(twos, 10);
}

TEST(Sampling, SobolFillsEachSliceOfEachParameterByPowersOfTwo) {
  const auto points = sample(study(SamplingMethod::sobol, 64, {range(0, 1), range(0, 1), range(0, 1), range(0, 1)}));
  for (std::size_t parameter = 0; parameter < 4; ++parameter) EXPECT_GE(filled(points, parameter, 64), 63u);
}

TEST(Sampling, SobolIntegratesTenTimesBetterThanItsSeedsCouldByChance) {
  double sum = 0.0;
  const auto points = sample(study(SamplingMethod::sobol, 1024, {range(0, 1), range(0, 1)}, 7));
  for (const auto& point : points) sum += point[0] * point[1];
  EXPECT_NEAR(sum / 1024, 0.25, 0.0007);  // random points: standard deviation 0.0069
}

TEST(Sampling, SeedsRepeatTheirPointsAndOthersDiffer) {
  for (const auto method : {SamplingMethod::latin_hypercube, SamplingMethod::sobol}) {
    const auto points = sample(study(method, 8, {range(2, 3)}, 5));
    EXPECT_EQ(points, sample(study(method, 8, {range(2, 3)}, 5)));
    EXPECT_NE(points, sample(study(method, 8, {range(2, 3)}, 6)));
    for (const auto& point : points) {
      EXPECT_GE(point[0], 2.0);
      EXPECT_LE(point[0], 3.0);
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
