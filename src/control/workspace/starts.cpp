// SPDX-License-Identifier: BSD-3-Clause
#include "starts.h"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <numeric>

namespace soft_robot_lab {
namespace {

using Place = std::vector<int>;  // on the grid, one number a command

std::vector<int> strides_of(const std::vector<int>& steps) {
  std::vector<int> strides(steps.size(), 1);
  for (std::size_t i = steps.size(); i-- > 1;) strides[i - 1] = strides[i] * steps[i];
  return strides;
}

int count_of(const std::vector<int>& steps) {
  return std::accumulate(steps.begin(), steps.end(), 1, std::multiplies<int>());
}

Place place_of(int point, const std::vector<int>& steps, const std::vector<int>& strides) {
  Place place(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) place[i] = point / strides[i] % steps[i];
  return place;
}

// The command that moves last: of those away from rest the one that is the least, the last of equals.
int moved_last(const Place& place, const Place& rest) {
  int least = -1;
  const auto away = [&](int i) {
    return std::abs(place[static_cast<std::size_t>(i)] - rest[static_cast<std::size_t>(i)]);
  };
  for (int i = 0; i < static_cast<int>(place.size()); ++i)
    if (away(i) > 0 && (least < 0 || away(i) <= away(least))) least = i;
  return least;
}

}  // namespace

std::vector<int> grid_starts(const std::vector<int>& steps, const std::vector<int>& rest) {
  const std::vector<int> strides = strides_of(steps);
  std::vector<int> starts(static_cast<std::size_t>(count_of(steps)), kFromRest);
  for (int point = 0; point < static_cast<int>(starts.size()); ++point) {
    const Place place = place_of(point, steps, strides);
    const int command = moved_last(place, rest);
    if (command < 0) continue;
    const auto i = static_cast<std::size_t>(command);
    starts[static_cast<std::size_t>(point)] = point + (place[i] > rest[i] ? -strides[i] : strides[i]);
  }
  return starts;
}

std::vector<int> nearest_starts(const Eigen::MatrixXd& points, const Eigen::VectorXd& rest) {
  const Eigen::VectorXd from_rest = (points.colwise() - rest).colwise().norm().transpose();
  std::vector<int> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return from_rest[a] < from_rest[b]; });
  std::vector<int> starts(order.size(), kFromRest);
  for (std::size_t i = 0; i < order.size(); ++i) {
    double nearest = from_rest[order[i]];
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (points.col(order[i]) - points.col(order[j])).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      starts[static_cast<std::size_t>(order[i])] = order[j];
    }
  }
  return starts;
}

std::vector<NeighbourPair> grid_neighbours(const std::vector<int>& steps) {
  const std::vector<int> strides = strides_of(steps);
  std::vector<NeighbourPair> pairs;
  for (int point = 0; point < count_of(steps); ++point)
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (point / strides[i] % steps[i] + 1 < steps[i]) pairs.push_back({point, point + strides[i]});
  return pairs;
}

}  // namespace soft_robot_lab
