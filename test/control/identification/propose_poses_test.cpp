// SPDX-License-Identifier: BSD-3-Clause
// Proposed poses against random ones, on a lying bar whose truth is known.
#include "soft_robot_lab/control/identification/propose_poses.h"

#include <gtest/gtest.h>

#include "fitted_bar.h"

namespace soft_robot_lab {
namespace {

const std::string kTaut =
    kLying + "cables: [" + cable("left", -0.007, "compliance_m_n: 2.0e-4, length_offset_m: 0, min_contraction: 0.85") +
    ", " + cable("right", 0.007, "compliance_m_n: 2.0e-4, length_offset_m: 0, min_contraction: 0.85") + "]\n";
constexpr double kNoise_m = 1e-4;
constexpr int kPoses = 4, kFits = 8;

ProposalRequest request() {
  ProposalRequest request;
  request.parameters = {
      {"youngs_modulus_pa", {}, {}, {}}, {"compliance_m_n", {}, {}, {}}, {"length_offset_m", {}, {}, {}}};
  request.poses = kPoses;
  request.deviation_m = kNoise_m;
  return request;
}

std::vector<std::pair<double, double>> as_pairs(const std::vector<std::vector<double>>& commands) {
  std::vector<std::pair<double, double>> pairs;
  for (const std::vector<double>& pose : commands) pairs.emplace_back(pose[0], pose[1]);
  return pairs;
}

// By how much fits to noisy measurements of these poses scatter: by value, rms from the truth.
std::map<std::string, double> scatter(const std::vector<std::vector<double>>& commands) {
  FitRequest fit;
  fit.parameters = request().parameters;
  fit.model_error_m = 0.0;
  std::map<std::string, double> squares;
  for (int seed = 1; seed <= kFits; ++seed) {
    const std::vector<MeasuredPose> poses =
        measure(kTaut, as_pairs(commands), Eigen::Isometry3d::Identity(), kNoise_m, static_cast<unsigned>(seed));
    for (const FittedValue& value : fit_model(kScene, options_with(kTaut), poses, fit).values)
      squares[value.name] += std::pow(value.value - value.start, 2) / kFits;
  }
  for (auto& [name, square] : squares) square = std::sqrt(square);
  return squares;
}

TEST(ProposePoses, ScatterLessThanRandomOnesAndAsMuchAsExpected) {
  const PoseProposal proposal = propose_poses(kScene, options_with(kTaut), request());
  ASSERT_EQ(proposal.commands.size(), static_cast<std::size_t>(kPoses));
  const std::map<std::string, double> found = scatter(proposal.commands);
  for (const FittedValue& value : proposal.values) {
    EXPECT_LT(found.at(value.name), 1.8 * value.deviation) << value.name;
    EXPECT_GT(found.at(value.name), 0.45 * value.deviation) << value.name;
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> contraction(0.85, 1.0);  // as candidates are drawn
  double better = 0.0;
  for (int design = 0; design < 3; ++design) {
    std::vector<std::vector<double>> commands(kPoses);
    for (std::vector<double>& pose : commands) pose = {contraction(random), contraction(random)};
    const std::map<std::string, double> other = scatter(commands);
    double logarithms = 0.0;
    for (const auto& [name, deviation] : found) logarithms += std::log(other.at(name) / deviation);
    better += logarithms / (3.0 * static_cast<double>(found.size()));
  }
  EXPECT_GT(std::exp(better), 1.2) << "mean ratio of what random poses leave open to what proposed ones do";
}

TEST(ProposePoses, StatesTheSameForTheSamePoses) {
  const PoseProposal proposal = propose_poses(kScene, options_with(kTaut), request());
  const std::vector<FittedValue> again = expected_values(kScene, options_with(kTaut), request(), proposal.commands);
  ASSERT_EQ(again.size(), proposal.values.size());
  for (std::size_t i = 0; i < again.size(); ++i)
    EXPECT_NEAR(again[i].deviation, proposal.values[i].deviation, 1e-3 * again[i].deviation) << again[i].name;
}

TEST(ProposePoses, RefusesWhatNoRestStateSays) {
  ProposalRequest asked = request();
  asked.parameters.push_back({"creep", {}, {}, {}});
  EXPECT_THROW(propose_poses(kScene, options_with(kTaut), asked), std::invalid_argument);
  asked = request();
  asked.poses = 0;
  EXPECT_THROW(propose_poses(kScene, options_with(kTaut), asked), std::invalid_argument);
  asked = request();
  asked.deviation_m = 0.0;
  EXPECT_THROW(propose_poses(kScene, options_with(kTaut), asked), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
