// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <stdexcept>

#include <gtest/gtest.h>

#include "cabled_bar.h"
#include "control/workspace/starts.h"
#include "control/workspace/walk.h"

namespace soft_robot_lab {
namespace {

using Found = std::map<int, WorkspacePoint>;

// Both cables of the bar from 1 down to `least`.
Eigen::MatrixXd grid(int steps, double least) {
  Eigen::MatrixXd commands(2, steps * steps);
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j)
      commands.col(i * steps + j) << 1.0 - i * (1.0 - least) / (steps - 1), 1.0 - j * (1.0 - least) / (steps - 1);
  return commands;
}

WorkspaceWalk walk_of(int steps, double least) {
  const Eigen::MatrixXd commands = grid(steps, least);
  const Simulation simulation = bar();
  return {simulation.model(),
          1,
          commands,
          grid_starts({steps, steps}, {0, 0}),
          std::vector<bool>(static_cast<std::size_t>(commands.cols()), true),
          1,
          {}};
}

Found walked(WorkspaceWalk walk) {
  Found found;
  walk.found = [&](int point, const WorkspacePoint& there) { return found.emplace(point, there).second; };
  walk_workspace(walk);
  return found;
}

Eigen::Vector3d tip_m(const WorkspacePoint& point) { return point.markers_m.col(1); }

TEST(GridStarts, LeadFromRestAlongTheCommandThatIsPulledMost) {
  const std::vector<int> starts = grid_starts({3, 3}, {0, 0});
  EXPECT_EQ(starts, (std::vector<int>{kFromRest, 0, 1, 0, 3, 2, 3, 6, 7}));
}

TEST(GridStarts, LeadFromARestInTheMiddleToBothSides) {
  EXPECT_EQ(grid_starts({4}, {1}), (std::vector<int>{1, kFromRest, 1, 2}));
}

TEST(NearestStarts, AreTheNearestPointsThatAreNearerToRest) {
  Eigen::MatrixXd points(1, 4);
  points << 0.9, 0.2, 0.5, -0.3;
  EXPECT_EQ(nearest_starts(points, Eigen::VectorXd::Zero(1)), (std::vector<int>{2, kFromRest, 1, kFromRest}));
}

TEST(GridNeighbours, AreAllPairsOfOneStep) { EXPECT_EQ(grid_neighbours({3, 2}).size(), 7u); }

TEST(Workspace, RestsWhereASearchFromRestFindsIt) {
  const WorkspaceWalk walk = walk_of(3, 0.92);
  const Found found = walked(walk);
  ASSERT_EQ(found.size(), 9u);
  for (const auto& [point, there] : found) {
    ASSERT_EQ(there.failure, "");
    EXPECT_FALSE(there.snapped);
    Simulation alone(walk.model);
    alone.set_command("left", walk.commands(0, point));
    alone.set_command("right", walk.commands(1, point));
    ASSERT_TRUE(alone.solve_equilibrium().converged);
    EXPECT_LT((tip_m(there) - alone.marker_position(1)).norm(), 1e-6) << point;
    EXPECT_NEAR(*there.actuators[0].tension_n, *alone.actuator_state(0).tension_n, 1e-3) << point;
  }
}

TEST(Workspace, IsTheSameInThreeThreadsAndFromTheMiddleOn) {
  WorkspaceWalk walk = walk_of(3, 0.92);
  const Found alone = walked(walk);
  walk.threads = 3;
  const Found together = walked(walk);
  ASSERT_EQ(together.size(), alone.size());
  for (const auto& [point, there] : alone) EXPECT_EQ(tip_m(together.at(point)), tip_m(there)) << point;
  std::fill(walk.wanted.begin(), walk.wanted.end() - 2, false);
  const Found rest = walked(walk);
  ASSERT_EQ(rest.size(), 2u);
  for (const auto& [point, there] : rest) EXPECT_EQ(tip_m(there), tip_m(alone.at(point))) << point;
}

TEST(Workspace, StopsWhereItIsTold) {
  WorkspaceWalk walk = walk_of(3, 0.92);
  int calls = 0;
  walk.found = [&](int, const WorkspacePoint&) { return ++calls < 4; };
  walk_workspace(walk);
  EXPECT_EQ(calls, 4);
}

TEST(Workspace, HandsOnWhatTheCallThrows) {
  WorkspaceWalk walk = walk_of(2, 0.95);
  walk.threads = 2;
  walk.found = [](int, const WorkspacePoint&) -> bool { throw std::runtime_error("full"); };
  EXPECT_THROW(walk_workspace(walk), std::runtime_error);
}

TEST(Workspace, HasTheDerivativesOfItsMarker) {
  const Found found = walked(walk_of(3, 0.996));
  const Eigen::VectorXd change = Eigen::Vector2d(0.0, -0.002);
  const Eigen::MatrixXd mean = 0.5 * (found.at(3).jacobian_m + found.at(4).jacobian_m);
  const Eigen::Vector3d moved = tip_m(found.at(4)) - tip_m(found.at(3));
  EXPECT_LT((moved - mean * change).norm(), 0.02 * moved.norm());
}

TEST(LeastSingularValue, IsThatOfCommandsInTheirRanges) {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, 2);
  jacobian(0, 0) = 0.3;
  jacobian(2, 1) = 0.1;
  EXPECT_DOUBLE_EQ(least_singular_value_m(jacobian, Eigen::Vector2d(0.5, 4.0)), 0.15);
}

TEST(Fold, LiesWhereDerivativesDoNotLeadFromOneShapeToTheNext) {
  const Eigen::MatrixXd slope = Eigen::Vector3d(0.1, 0, 0);
  const Eigen::VectorXd step = Eigen::VectorXd::Constant(1, 0.05);
  const Eigen::Vector3d here(0, 0, 0);
  EXPECT_FALSE(folded_between(here, slope, {0.005, 0, 0}, slope, step));
  for (const double taut_from : {0.0, 0.5, 1.0})  // a cable that hangs idle for a part of the way
    EXPECT_FALSE(folded_between(here, 0.0 * slope, {0.005 * (1.0 - taut_from), 0, 0}, slope, step)) << taut_from;
  EXPECT_TRUE(folded_between(here, slope, {0.005, 0.02, 0}, slope, step));
  EXPECT_TRUE(folded_between(here, slope, {-0.02, 0, 0}, slope, step));
}

}  // namespace
}  // namespace soft_robot_lab
