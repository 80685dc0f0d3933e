// SPDX-License-Identifier: BSD-3-Clause
// Policies for many bars that differ from their model.
#include "study/robust/robust_policy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "robot/scene/scene_files.h"
#include "settings/quantile.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "study/robust/robust_report.h"

namespace soft_robot_lab {
namespace {

const std::string kBar = std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/scenes/cable_bar.yaml";
constexpr double kFraction = 0.9;

SceneOptions options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

class RobustPolicyTest : public testing::Test {
 protected:
  // A left cable that is often a little longer than believed, and sometimes much: the nominal policy pulls too little,
  // by little on most robots and by much on some.
  Randomisation randomisation(int samples) const {
    const std::string file = folder_.write(
        "random.yaml",
        "samples: " + std::to_string(samples) +
            "\nseed: 3\nparameters:\n"
            "  cables.left.length_offset_m: {log_normal: {median: 1.0e-3, deviation: 0.8}, range: [0, 8.0e-3]}\n"
            "  body.material.youngs_modulus_pa: {normal: {mean: 264200, deviation: 20000}}\n"
            "  camera_to_base.x_m: {normal: {mean: 0, deviation: 2.0e-4}}\n"
            "  backlash_m.right: {range: [0, 5.0e-4]}\n");
    return read_randomisation(file, robot_);
  }

  SceneFolder folder_;
  const std::string robot_ =
      folder_.write("robot.yaml", "include: " + kBar +
                                      "\ncables: {left: {length_offset_m: 0, min_contraction: 0.8}, "
                                      "right: {length_offset_m: 0, min_contraction: 0.8}}\n");
};

PolicyTask task() { return {{{{{"tip", Eigen::Vector3d(-0.02, 0.0, -0.094), 1.0}}}}, {}}; }

std::vector<double> after(const CommandPolicy& policy, std::vector<RandomRobot>& robots) {
  return distances_m(robots, policy, task().poses.front());
}

double mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value / static_cast<double>(values.size());
  return sum;
}

TEST_F(RobustPolicyTest, IsBetterOnFreshRobotsThanTheNominalPolicy) {
  Scene nominal = load_scene(robot_, options());
  const CommandPolicy plain = find_policy(*nominal.simulation, task(), {}).policy;
  std::vector<RandomRobot> drawn = draw_robots(randomisation(16), options());
  const CommandPolicy by_mean = find_robust_policy(drawn, task(), {}).policy;
  RobustOptions for_quantile;
  for_quantile.quantile = kFraction;
  const CommandPolicy by_quantile = find_robust_policy(drawn, task(), for_quantile).policy;

  std::vector<RandomRobot> fresh = draw_robots(randomisation(40), options(), 100);
  ASSERT_NE(fresh[0].values, drawn[0].values);
  const std::vector<double> of_plain = after(plain, fresh), of_mean = after(by_mean, fresh),
                            of_quantile = after(by_quantile, fresh);
  EXPECT_LT(mean_square(of_mean), 0.9 * mean_square(of_plain));
  EXPECT_LT(quantile(of_quantile, kFraction), 0.9 * quantile(of_plain, kFraction));
  EXPECT_LT(quantile(after(by_quantile, drawn), kFraction), 1.0001 * quantile(after(by_mean, drawn), kFraction))
      << "of the robots that it was found for";
}

TEST_F(RobustPolicyTest, RobotsRepeatBySeedAndSeeAsCamerasBelieve) {
  std::vector<RandomRobot> one = draw_robots(randomisation(4), options()),
                           other = draw_robots(randomisation(4), options());
  const CommandPolicy policy{{"left", "right"}, {{1.0, {0.9, 1.0}}}};
  EXPECT_EQ(after(policy, one), after(policy, other));
  EXPECT_EQ(after(policy, one), after(policy, one)) << "robots are at rest again";
  const double before_m = after(policy, one)[0];
  one[0].measured_from_base.translation().z() += 0.01;
  EXPECT_GT(std::abs(after(policy, one)[0] - before_m), 1e-3);
}

TEST_F(RobustPolicyTest, ReportsQuantiles) {
  std::vector<RandomRobot> robots = draw_robots(randomisation(4), options());
  std::vector<double> distances = {0.001, 0.002, 0.004, std::numeric_limits<double>::infinity()};
  EXPECT_NE(robust_summary(distances).find("4 random robots, 1 without a rest state"), std::string::npos);
  write_robust_report(randomisation(4), robots, distances, folder_.path("report"));
  for (const char* file : {"report.html", "robots.csv", "distances.svg"})
    EXPECT_TRUE(std::filesystem::exists(folder_.path("report") + "/" + file)) << file;
}

TEST_F(RobustPolicyTest, RefusesPathsAndBadQuantiles) {
  std::vector<RandomRobot> robots = draw_robots(randomisation(2), options());
  PolicyTask path = task();
  path.poses.push_back(path.poses.front());
  EXPECT_THROW(find_robust_policy(robots, path, {}), std::invalid_argument);
  RobustOptions bad;
  bad.quantile = 1.0;
  EXPECT_THROW(find_robust_policy(robots, task(), bad), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
