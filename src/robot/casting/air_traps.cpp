// SPDX-License-Identifier: BSD-3-Clause
#include "air_traps.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace soft_robot_lab {
namespace {

constexpr int kColumns = 600;           // of the section, across the robot
constexpr double kLevelSlope = 0.035;   // of what counts as level: two degrees
constexpr double kLevelTrap_m = 0.003;  // a level roof shorter than this lets its air out
constexpr double kBeside_m = 2e-5;      // the section stands this far beside a plane that may hold skin

struct Stretch {  // of silicone, upwards
  double low_m = 0, high_m = 0;
  int trap = -1;  // which level piece of the section's upper side it belongs to
};
using Column = std::vector<Stretch>;

struct Section {
  std::vector<Column> columns;
  double first_m = 0, step_m = 0;  // of their places across

  double silicone_m2() const {
    double area = 0;
    for (const Column& column : columns)
      for (const Stretch& stretch : column) area += step_m * (stretch.high_m - stretch.low_m);
    return area;
  }
};

Column column_at(const RayTree& robot, const Eigen::Vector3d& foot, const Eigen::Vector3d& up) {
  Column column;
  const double base = up.dot(foot);
  double beyond = 0;
  while (const auto hit = robot.first_hit(foot, up, beyond)) {
    const bool enters = robot.surface().normals.col(hit->triangle).dot(up) < 0;
    if (enters) column.push_back({base + hit->distance_m, base + hit->distance_m});
    if (!enters && !column.empty()) column.back().high_m = base + hit->distance_m;
    beyond = std::max(beyond, hit->distance_m) + robot.skip_m();
  }
  return column;
}

Section section_at(const RayTree& robot, const Eigen::Matrix3d& frame, double along_m) {
  const Eigen::Matrix3Xd places = frame.transpose() * robot.surface().vertices_m;
  const Eigen::Vector3d low = places.rowwise().minCoeff(), high = places.rowwise().maxCoeff();
  Section section;
  section.step_m = (high.x() - low.x()) / kColumns;
  section.first_m = low.x() + section.step_m / 2;
  for (int i = 0; i < kColumns; ++i) {
    const Eigen::Vector3d foot(section.first_m + i * section.step_m, along_m, low.z() - 0.01 * robot.size_m());
    section.columns.push_back(column_at(robot, frame * foot, frame.col(2)));
  }
  return section;
}

bool joined(const Stretch& a, const Stretch& b) { return a.low_m < b.high_m && b.low_m < a.high_m; }

// What is known of a level piece of the section's upper side.
struct Level {
  int first = 0, last = 0;  // columns
  double height_m = 0;
  bool leads_up = false;  // silicone beside it rises higher
};

class Levels {
 public:
  explicit Levels(Section& section) : section_(section), tolerance_m_(kLevelSlope * section.step_m) {}

  std::vector<Level> find() {
    for (int i = 0; i < kColumns; ++i)
      for (Stretch& stretch : at(i))
        if (stretch.trap < 0) follow(i, stretch);
    return found_;
  }

 private:
  Column& at(int column) { return section_.columns[static_cast<size_t>(column)]; }

  // To the right as far as it is level; to the left all has been seen.
  void follow(int column, Stretch& start) {
    Level level{column, column, start.high_m, rises_beside(column, -1, start)};
    Stretch* stretch = &start;
    for (;;) {
      stretch->trap = static_cast<int>(found_.size());
      level.last = column;
      level.height_m = std::max(level.height_m, stretch->high_m);
      Stretch* next = level_beside(column, *stretch);
      if (next == nullptr) break;
      stretch = next;
      ++column;
    }
    level.leads_up = level.leads_up || rises_beside(column, 1, *stretch);
    found_.push_back(level);
  }

  Stretch* level_beside(int column, const Stretch& stretch) {
    if (column + 1 == kColumns) return nullptr;
    for (Stretch& other : at(column + 1))
      if (other.trap < 0 && joined(stretch, other) && std::abs(other.high_m - stretch.high_m) <= tolerance_m_)
        return &other;
    return nullptr;
  }

  bool rises_beside(int column, int side, const Stretch& stretch) {
    const int beside = column + side;
    if (beside < 0 || beside == kColumns) return false;
    return std::any_of(at(beside).begin(), at(beside).end(), [&](const Stretch& other) {
      return joined(stretch, other) && other.high_m > stretch.high_m + tolerance_m_;
    });
  }

  Section& section_;
  double tolerance_m_;
  std::vector<Level> found_;
};

double silicone_above(const Column& column, double height_m) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Stretch& stretch : column)
    if (stretch.low_m >= height_m) nearest = std::min(nearest, stretch.low_m);
  return nearest;
}

}  // namespace

std::vector<AirTrap> find_air_traps(const RayTree& robot, const Eigen::Matrix3d& frame, double parting_m) {
  Section section = section_at(robot, frame, parting_m + kBeside_m);
  Section other = section_at(robot, frame, parting_m - kBeside_m);
  if (other.silicone_m2() > section.silicone_m2()) section = std::move(other);
  std::vector<AirTrap> traps;
  for (const Level& level : Levels(section).find()) {
    if (level.leads_up && (level.last - level.first + 1) * section.step_m < kLevelTrap_m) continue;
    const int middle = (level.first + level.last) / 2;
    traps.push_back({section.first_m + (level.first + level.last) * section.step_m / 2, level.height_m,
                     silicone_above(section.columns[static_cast<size_t>(middle)], level.height_m)});
  }
  std::stable_sort(traps.begin(), traps.end(),
                   [](const AirTrap& a, const AirTrap& b) { return a.height_m > b.height_m; });
  return traps;
}

}  // namespace soft_robot_lab
