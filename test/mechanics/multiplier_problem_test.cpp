// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/complementarity/multiplier_problem.h"

#include <random>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

// Two cables of `spans` spans each with friction, and a free and a two-sided constraint beside them.
MultiplierProblem random_problem(std::mt19937& random, int spans) {
  std::normal_distribution<double> normal;
  const int count = 2 * spans + 2;
  Eigen::MatrixXd half(count, count);
  MultiplierProblem problem;
  problem.excess.resize(count);
  for (double& entry : half.reshaped()) entry = normal(random);
  for (double& entry : problem.excess) entry = 1e-3 * normal(random);
  problem.delassus = 1e-3 * (half * half.transpose() + 0.1 * Eigen::MatrixXd::Identity(count, count));
  problem.laws.resize(count);
  for (int i = 0; i < 2 * spans; ++i) problem.laws[i].min_multiplier = 0.0;
  problem.laws[count - 1].min_multiplier = -0.1;
  problem.laws[count - 1].max_multiplier = 0.1;
  problem.laws[0].min_multiplier = problem.laws[0].max_multiplier = 0.3;  // driven by tension
  for (int cable = 0; cable < 2; ++cable)
    for (int i = 0; i + 1 < spans; ++i)
      problem.friction_contacts.push_back(
          {cable * spans + i, cable * spans + i + 1, std::exp(std::abs(0.2 * normal(random)))});
  return problem;
}

void expect_solved(const MultiplierProblem& problem, const Multipliers& solved) {
  ASSERT_TRUE(solved.found);
  const Eigen::VectorXd& y = solved.y;
  const Eigen::VectorXd gap = problem.delassus * y - problem.excess;
  std::vector<ConstraintLaw> gaps(problem.laws.size());
  for (std::size_t i = 0; i < gaps.size(); ++i) gaps[i].offset = -gap[static_cast<Eigen::Index>(i)];
  gaps = after_flows(gaps, problem.friction_contacts, solved.slips_m);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const ConstraintLaw& law = problem.laws[i];
    const double at = y[static_cast<Eigen::Index>(i)];
    EXPECT_GE(at, law.min_multiplier - 1e-8);
    EXPECT_LE(at, law.max_multiplier + 1e-8);
    if (law.prescribed()) continue;
    const double pull = gaps[i].offset;  // of what is left of the excess
    EXPECT_GE(at > law.min_multiplier + 1e-7 ? pull : 0.0, -1e-9);
    EXPECT_LE(at < law.max_multiplier - 1e-7 ? pull : 0.0, 1e-9);
  }
  for (std::size_t j = 0; j < problem.friction_contacts.size(); ++j)
    EXPECT_LT(
        friction_violation(problem.friction_contacts[j], y, solved.slips_m[static_cast<Eigen::Index>(j)], 1e-6, 1.0),
        1e-6);
}

TEST(MultiplierProblem, IsSolvedFromAnyGuess) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const MultiplierProblem problem = random_problem(random, 2 + i % 7);
    expect_solved(problem, solve_multipliers(problem, Eigen::VectorXd::Zero(problem.excess.size())));
    expect_solved(problem, solve_multipliers(problem, Eigen::VectorXd::Constant(problem.excess.size(), 0.1 * i)));
  }
}

TEST(MultiplierProblem, IsSolvedByLemkeAlone) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const MultiplierProblem problem = random_problem(random, 2 + i % 7);
    expect_solved(problem, solve_by_lemke(problem));
  }
}

TEST(MultiplierProblem, WithoutFrictionAllTensionsAreOne) {
  MultiplierProblem problem;
  problem.delassus = Eigen::Vector3d(1e-3, 2e-3, 3e-3).asDiagonal();
  problem.excess = Eigen::Vector3d(6e-3, 0, -3e-3);
  problem.laws.resize(3);
  for (ConstraintLaw& law : problem.laws) law.min_multiplier = 0.0;
  problem.friction_contacts = {{0, 1, 1.0}, {1, 2, 1.0}};
  const Multipliers solved = solve_multipliers(problem, Eigen::Vector3d::Zero());
  EXPECT_TRUE(solved.y.isApprox(Eigen::Vector3d::Constant(0.5), 1e-9)) << solved.y.transpose();
}

// Joined from the far end, the group that joins changed its number halfway.
TEST(MultiplierProblem, JoinsAllConstraintsBetweenWhichLengthSlips) {
  MultiplierProblem problem;
  problem.laws.resize(4);
  problem.friction_contacts = {{1, 2, 1.0}, {0, 1, 1.0}, {2, 3, 2.0}};
  const Eigen::Vector4d y(1.0, 1.0, 1.0, 1.0);  // the first two contacts slip, the last sticks
  EXPECT_EQ(slipping_groups(problem, y), (std::vector<int>{0, 0, 0, 3}));
}

}  // namespace
}  // namespace soft_robot_lab
