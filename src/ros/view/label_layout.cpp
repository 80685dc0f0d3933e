// SPDX-License-Identifier: BSD-3-Clause
#include "label_layout.h"

#include <algorithm>
#include <cmath>

namespace soft_robot_lab {
namespace {

constexpr double kCell_px = 8.0;
constexpr double kApart_px = 3.0;                          // labels from one another, and from the window's edge
constexpr int kDirections = 24, kSteps = 16, kRounds = 3;  // places that are tried around an anchor
constexpr double kStep_px = 14.0;
// Costs, in pixels of distance.
constexpr double kOverlap = 1e4, kCoversAnchor = 250.0, kOnBody = 400.0, kCrossing = 150.0, kStays = 60.0;
constexpr double kUpOrDown = 0.4;  // of a pixel up or down, so that labels stand at a body's sides

using Box = Eigen::AlignedBox2d;

Box box_at(const Eigen::Vector2d& center_px, const Eigen::Vector2d& size_px) {
  const Eigen::Vector2d half_px = 0.5 * size_px + Eigen::Vector2d::Constant(kApart_px);
  return {center_px - half_px, center_px + half_px};
}

double side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& point) {
  return (b.x() - a.x()) * (point.y() - a.y()) - (b.y() - a.y()) * (point.x() - a.x());
}

bool cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  return side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
}

bool cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Box& box) {
  return cross(a, b, box.min(), box.max()) || cross(a, b, box.corner(Box::BottomRight), box.corner(Box::TopLeft));
}

class Layout {
 public:
  Layout(const std::vector<Label>& labels, const CoveredCells& body, const Eigen::Vector2d& window_px)
      : labels_(labels), body_(body), window_(Eigen::Vector2d::Zero(), window_px), centers_px_(labels.size()) {}

  std::vector<Eigen::Vector2d> solved() {
    for (placed_ = 0; placed_ < labels_.size(); ++placed_) centers_px_[placed_] = best(placed_);
    for (int round = 0; round < kRounds; ++round)
      for (std::size_t i = 0; i < labels_.size(); ++i) centers_px_[i] = best(i);
    return centers_px_;
  }

 private:
  Eigen::Vector2d best(std::size_t i) const {
    const Label& label = labels_[i];
    Eigen::Vector2d best_px = label.anchor_px;
    double least = INFINITY;
    const auto attempt = [&](const Eigen::Vector2d& center_px, double bonus) {
      const double alone = cost_alone(label, center_px) - bonus;
      if (alone >= least) return;
      const double cost = alone + cost_among(i, center_px);
      if (cost >= least) return;
      least = cost;
      best_px = center_px;
    };
    if (label.offset_px) attempt(label.anchor_px + *label.offset_px, kStays);
    for (int step = 1; step <= kSteps && step * kStep_px < least; ++step)
      for (int k = 0; k < kDirections; ++k) {
        const double angle = 2.0 * M_PI * k / kDirections;
        const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
        attempt(label.anchor_px + step * kStep_px * way + 0.5 * way.cwiseProduct(label.size_px), 0.0);
      }
    return best_px;
  }

  double cost_alone(const Label& label, const Eigen::Vector2d& center_px) const {
    const Box box = box_at(center_px, label.size_px);
    const Eigen::Vector2d way_px = center_px - label.anchor_px;
    const double out = window_.contains(box) ? 0.0 : 2.0 * kOverlap;
    return way_px.norm() + kUpOrDown * std::abs(way_px.y()) + out + kOnBody * body_.share_of(box);
  }

  double cost_among(std::size_t i, const Eigen::Vector2d& center_px) const {
    const Box box = box_at(center_px, labels_[i].size_px);
    double sum = 0.0;
    for (std::size_t j = 0; j < labels_.size(); ++j)
      if (j != i) sum += cost_beside(labels_[i].anchor_px, center_px, box, j);
    return sum;
  }

  double cost_beside(const Eigen::Vector2d& anchor_px, const Eigen::Vector2d& center_px, const Box& box,
                     std::size_t j) const {
    const Label& other = labels_[j];
    double sum = box.contains(other.anchor_px) ? kCoversAnchor : 0.0;
    if (j >= placed_) return sum;
    const Box there = box_at(centers_px_[j], other.size_px);
    if (!box.intersection(there).isEmpty()) sum += kOverlap;
    if (cross(anchor_px, center_px, other.anchor_px, centers_px_[j])) sum += kCrossing;
    if (cross(anchor_px, center_px, there) || cross(other.anchor_px, centers_px_[j], box)) sum += kCrossing;
    return sum;
  }

  const std::vector<Label>& labels_;
  const CoveredCells& body_;
  Box window_;
  std::vector<Eigen::Vector2d> centers_px_;
  std::size_t placed_ = 0;  // how many have a place
};

}  // namespace

CoveredCells::CoveredCells(const Eigen::Vector2d& window_px)
    : columns_(std::max(1, static_cast<int>(std::ceil(window_px.x() / kCell_px)))),
      rows_(std::max(1, static_cast<int>(std::ceil(window_px.y() / kCell_px)))),
      covered_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

bool CoveredCells::covered(int column, int row) const {
  return covered_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
}

// By points of it that lie closer than a square is wide, as far as it is seen.
void CoveredCells::add_triangle(const Eigen::Vector2d& a_px, const Eigen::Vector2d& b_px, const Eigen::Vector2d& c_px) {
  const Eigen::Vector2d along_px = b_px - a_px, across_px = c_px - a_px;
  const double longest_px = std::max({along_px.norm(), across_px.norm(), (c_px - b_px).norm()});
  if (!a_px.allFinite() || !(longest_px < 1e4)) return;
  const int parts = 1 + static_cast<int>(longest_px / (0.7 * kCell_px));
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) {
      const Eigen::Vector2d cell = (a_px + along_px * i / parts + across_px * j / parts) / kCell_px;
      const bool seen = cell.x() >= 0.0 && cell.x() < columns_ && cell.y() >= 0.0 && cell.y() < rows_;
      if (seen)
        covered_[static_cast<std::size_t>(static_cast<int>(cell.y()) * columns_ + static_cast<int>(cell.x()))] = true;
    }
}

double CoveredCells::share_of(const Eigen::AlignedBox2d& box_px) const {
  const auto cell = [](double place_px, int count) {
    return std::clamp(static_cast<int>(std::floor(place_px / kCell_px)), 0, count - 1);
  };
  int all = 0, taken = 0;
  for (int row = cell(box_px.min().y(), rows_); row <= cell(box_px.max().y(), rows_); ++row)
    for (int column = cell(box_px.min().x(), columns_); column <= cell(box_px.max().x(), columns_); ++column) {
      ++all;
      if (covered(column, row)) ++taken;
    }
  return static_cast<double>(taken) / all;
}

std::vector<Eigen::Vector2d> place_labels(const std::vector<Label>& labels, const CoveredCells& body,
                                          const Eigen::Vector2d& window_px) {
  return Layout(labels, body, window_px).solved();
}

}  // namespace soft_robot_lab
