// SPDX-License-Identifier: BSD-3-Clause
// Experiments 3.3.1 and 3.3.2, and how sightings of markers are scored.
#include <cmath>

#include <gtest/gtest.h>

#include "study/experiments/marker_sightings.h"
#include "study/experiments/vision_experiments.h"

namespace soft_robot_lab {
namespace {

ExperimentContext context() {
  ExperimentContext context;
  context.config_folder = SOFT_ROBOT_LAB_SOURCE "/config";
  context.mesher = SOFT_ROBOT_LAB_MESHER;
  return context;
}

TEST(MarkerSightings, ScoreMeanAndDeviationOfWhatWasFound) {
  MarkerSightings sightings;
  sightings.images = 3;
  const Eigen::Vector2d at(10, 20);
  sightings.sightings = {
      {0, at, at + Eigen::Vector2d(1, 0)}, {0, at, at + Eigen::Vector2d(0, 3)}, {0, at, std::nullopt}, {1, at, at}};
  const SightingScore first = score(sightings, 0);
  EXPECT_EQ(first.in_sight, 3);
  EXPECT_EQ(first.found, 2);
  EXPECT_DOUBLE_EQ(first.ratio(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(first.mean_px, 2);
  EXPECT_DOUBLE_EQ(first.deviation_px, 1);
  EXPECT_EQ(score(sightings).found, 3);
  EXPECT_EQ(score(sightings, 2).ratio(), 0);
}

TEST(ContrastSegmentation, SeeksFiveMarkersInSixtyImagesOfThirtyConfigurations) {
  const ExperimentResult result = run_contrast_segmentation_experiment(context());
  EXPECT_TRUE(result.converged) << result.message;
  EXPECT_EQ(result.numbers["images"], 60);
  EXPECT_EQ(result.numbers["configurations"], 30);
  EXPECT_GT(result.numbers["least_difference_m"], 0.001) << "two of the configurations are one";
  ASSERT_EQ(result.table.rows.size(), 6u);
  for (int marker = 1; marker <= 5; ++marker) {
    const auto& numbers = result.numbers["markers"]["marker_" + std::to_string(marker)];
    EXPECT_GT(numbers["in_sight"], 50);
    EXPECT_GT(numbers["found"], 30) << "more than half";
    EXPECT_LE(numbers["found"], numbers["in_sight"]);
    EXPECT_GT(numbers["mean_px"], 0.0) << "no segmentation is exact in a D415's noise";
    EXPECT_LT(numbers["mean_px"], 1.0);
  }
  // As no more than five holes are kept of an image, what is found and what is none are 300 together at most.
  EXPECT_LE(result.numbers["markers"]["all"]["found"].get<int>() + result.numbers["strays"].get<int>(), 300);
  EXPECT_EQ(result.plots.size(), 3u);
  EXPECT_EQ(result.plots[2].series[0].deviations.size(), 5u);
}

TEST(ColourSegmentation, SeeksARedTipInSixtyImagesOfThirtyConfigurations) {
  const ExperimentResult result = run_colour_segmentation_experiment(context());
  EXPECT_TRUE(result.converged) << result.message;
  EXPECT_EQ(result.numbers["images"], 60);
  EXPECT_EQ(result.numbers["markers"].size(), 1u);
  const auto& tip = result.numbers["markers"]["marker_1"];
  EXPECT_GT(tip["in_sight"], 50);
  EXPECT_GT(tip["found"], 40);
  EXPECT_GE(result.numbers["configurations_found"].get<int>(), tip["found"].get<int>() / 2);
  EXPECT_LE(result.numbers["configurations_found"], 30);
  EXPECT_LT(tip["mean_px"], 1.0);
  EXPECT_EQ(result.numbers["strays"], 0) << "nothing else is red";
}

}  // namespace
}  // namespace soft_robot_lab
