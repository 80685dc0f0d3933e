// SPDX-License-Identifier: BSD-3-Clause
#include "squeeze.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr int kSections = 100, kWays = 18;

// Least and largest reach of each section in each way.
struct Outlines {
  Eigen::ArrayXXd least = Eigen::ArrayXXd::Constant(kWays, kSections, std::numeric_limits<double>::infinity());
  Eigen::ArrayXXd most = Eigen::ArrayXXd::Constant(kWays, kSections, -std::numeric_limits<double>::infinity());
};

struct Frame {
  Eigen::Matrix<double, kWays, 3> ways;
  Eigen::Vector3d direction;
  double low_m, step_m;

  double height_m(int section) const { return low_m + (section + 0.5) * step_m; }
};

Frame make_frame(const Surface& surface, const Eigen::Vector3d& direction) {
  Frame frame;
  frame.direction = direction;
  const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
  for (int i = 0; i < kWays; ++i)
    frame.ways.row(i) = std::cos(M_PI * i / kWays) * u.transpose() + std::sin(M_PI * i / kWays) * v.transpose();
  const Eigen::RowVectorXd heights = direction.transpose() * surface.vertices_m;
  frame.low_m = heights.minCoeff();
  frame.step_m = (heights.maxCoeff() - frame.low_m) / kSections;
  return frame;
}

void cut_edge(const Frame& frame, const Eigen::Vector3d& a, const Eigen::Vector3d& b, Outlines& outlines) {
  const double from = frame.direction.dot(a), to = frame.direction.dot(b);
  if (from >= to) return;  // the neighbour sees it the other way round
  const int first = std::max(0, static_cast<int>(std::ceil((from - frame.low_m) / frame.step_m - 0.5)));
  for (int s = first; s < kSections && frame.height_m(s) <= to; ++s) {
    const Eigen::Vector3d at = a + (frame.height_m(s) - from) / (to - from) * (b - a);
    const Eigen::Array<double, kWays, 1> reach = frame.ways * at;
    outlines.least.col(s) = outlines.least.col(s).min(reach);
    outlines.most.col(s) = outlines.most.col(s).max(reach);
  }
}

}  // namespace

Squeeze needed_stretch(const Surface& surface, const Eigen::Vector3d& direction) {
  const Frame frame = make_frame(surface, direction);
  Outlines outlines;
  for (int t = 0; t < surface.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e) cut_edge(frame, surface.corner(t, e), surface.corner(t, (e + 1) % 3), outlines);
  const Eigen::ArrayXXd widths = outlines.most - outlines.least;
  Squeeze worst;
  for (int way = 0; way < kWays; ++way) {
    double narrowest = std::numeric_limits<double>::infinity();
    for (int s = kSections - 1; s >= 0; --s) {
      const double width = widths(way, s);
      if (!std::isfinite(width) || width <= 0) continue;
      narrowest = std::min(narrowest, width);
      if (width / narrowest <= worst.stretch * (1 + 1e-6)) continue;
      worst.stretch = width / narrowest;
      worst.height_m = frame.height_m(s);
      worst.at_m = frame.height_m(s) * direction +
                   (outlines.most(way, s) + outlines.least(way, s)) / 2 * frame.ways.row(way).transpose();
    }
  }
  return worst;
}

}  // namespace soft_robot_lab
