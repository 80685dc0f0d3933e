// SPDX-License-Identifier: BSD-3-Clause
#include "orient.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

using EdgeUsers = std::map<std::pair<int, int>, std::vector<int>>;

EdgeUsers users_of_edges(const Eigen::Matrix3Xi& triangles) {
  EdgeUsers users;
  for (int t = 0; t < triangles.cols(); ++t)
    for (int e = 0; e < 3; ++e) users[std::minmax(triangles(e, t), triangles((e + 1) % 3, t))].push_back(t);
  return users;
}

bool runs_along(const Eigen::Matrix3Xi& triangles, int triangle, int from, int to) {
  for (int e = 0; e < 3; ++e)
    if (triangles(e, triangle) == from && triangles((e + 1) % 3, triangle) == to) return true;
  return false;
}

void turn(Eigen::Matrix3Xi& triangles, int triangle) { std::swap(triangles(1, triangle), triangles(2, triangle)); }

// Makes all that hang together with one agree with it; returns them.
std::vector<int> agree_with(int seed, const EdgeUsers& users, Eigen::Matrix3Xi& triangles, std::vector<char>& done) {
  std::vector<int> shell{seed};
  done[static_cast<size_t>(seed)] = 1;
  for (size_t next = 0; next < shell.size(); ++next) {
    const int t = shell[next];
    for (int e = 0; e < 3; ++e) {
      const int from = triangles(e, t), to = triangles((e + 1) % 3, t);
      for (const int other : users.at(std::minmax(from, to))) {
        if (done[static_cast<size_t>(other)] != 0) continue;
        done[static_cast<size_t>(other)] = 1;
        if (runs_along(triangles, other, from, to)) turn(triangles, other);
        shell.push_back(other);
      }
    }
  }
  return shell;
}

double volume_m3(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles, const std::vector<int>& shell) {
  double volume = 0;
  for (const int t : shell)
    volume += vertices_m.col(triangles(0, t))
                  .dot(vertices_m.col(triangles(1, t)).cross(vertices_m.col(triangles(2, t)).eval())) /
              6;
  return volume;
}

}  // namespace

void orient(const Eigen::Matrix3Xd& vertices_m, Eigen::Matrix3Xi& triangles) {
  const EdgeUsers users = users_of_edges(triangles);
  std::vector<char> done(static_cast<size_t>(triangles.cols()), 0);
  std::vector<std::vector<int>> shells;
  std::vector<double> volumes;
  for (int t = 0; t < triangles.cols(); ++t) {
    if (done[static_cast<size_t>(t)] != 0) continue;
    shells.push_back(agree_with(t, users, triangles, done));
    volumes.push_back(volume_m3(vertices_m, triangles, shells.back()));
  }
  const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto outer = std::max_element(volumes.begin(), volumes.end(), larger) - volumes.begin();
  for (size_t i = 0; i < shells.size(); ++i) {
    const bool is_outer = static_cast<std::ptrdiff_t>(i) == outer;
    if ((volumes[i] > 0) == is_outer) continue;
    for (const int t : shells[i]) turn(triangles, t);
  }
}

}  // namespace soft_robot_lab
