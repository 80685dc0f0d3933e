// SPDX-License-Identifier: BSD-3-Clause
#include "cable_strings.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include "cable_route.h"
#include "mechanics/body/gap.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

constexpr int kSamplesOfSpan = 100;  // of a span at rest, to see where it passes

struct Around {
  YamlNode item;
  ObstacleShape shape;
  std::string name;
  std::optional<Eigen::Vector3d> by_m;
};

// Where a string is led, and at what share of the span.
struct Led {
  double share;
  Eigen::Vector3d position_m;
};

const Obstacle& known_obstacle(const YamlNode& item, const std::string& name, const std::vector<Obstacle>& obstacles) {
  std::string known;
  for (const Obstacle& obstacle : obstacles) {
    if (obstacle.name == name) return obstacle;
    known += (known.empty() ? "" : ", ") + obstacle.name;
  }
  item.fail("unknown obstacle '" + name + "'; known: " + (known.empty() ? "none" : known));
}

Around read_one(const YamlNode& item, const Body& body) {
  const std::string name = item.is_scalar() ? item.as_text() : item.text("obstacle");
  const Obstacle& obstacle = known_obstacle(item, name, body.obstacles());
  if (obstacle.is_free() || !obstacle.motion.empty())
    item.fail("obstacle '" + name + "' moves; a cable finds its way around those alone that stand still");
  if (std::holds_alternative<Plane>(obstacle.shape))
    item.fail("obstacle '" + name + "' is a plane, around which nothing leads");
  if (std::holds_alternative<MeshShape>(obstacle.shape))
    item.fail("obstacle '" + name + "' is a mesh, on whose hollows a taut cable's way is not known; state a capsule, " +
              "cylinder, sphere or box there");
  Around around{item, obstacle.shape, name, std::nullopt};
  if (!item.is_scalar() && item.has("by_m")) around.by_m = item.vector3("by_m");
  return around;
}

struct RestSpan {
  Eigen::Vector3d from_m, to_m;

  Eigen::Vector3d at(int sample) const { return from_m + (sample + 0.5) / kSamplesOfSpan * (to_m - from_m); }
  bool in_air(const MeshLocator& locator) const {
    int out = 0;
    for (int i = 0; i < kSamplesOfSpan; i += 5) out += locator.locate(at(i)).distance_m > kNear_m ? 1 : 0;
    return 5 * out > kSamplesOfSpan / 2;
  }
};

// Where the span comes nearest, or the place on the obstacle that is beside where it would be deepest.
Led beside(const RestSpan& span, const Around& around) {
  int nearest = 0;
  double least_m = gap_to(around.shape, span.at(0)).gap_m;
  for (int i = 1; i < kSamplesOfSpan; ++i) {
    const double gap_m = gap_to(around.shape, span.at(i)).gap_m;
    if (gap_m >= least_m) continue;
    nearest = i;
    least_m = gap_m;
  }
  const Eigen::Vector3d at_m = span.at(nearest);
  const double share = (nearest + 0.5) / kSamplesOfSpan;
  if (around.by_m) return {share, *around.by_m};
  const Gap gap = gap_to(around.shape, at_m);
  return {share, at_m + std::max(0.0, -gap.gap_m) * gap.normal};
}

void require_outside(const Around& around, const std::vector<EmbeddedPoint>& points, const Eigen::Matrix3Xd& rest_m) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at_m = points[i].at(rest_m);
    const double gap_m = gap_to(around.shape, at_m).gap_m;
    if (gap_m >= 0.0) continue;
    std::ostringstream text;
    text << "the cable's point at " << point_text(at_m) << " is " << -gap_m << " m inside obstacle '" << around.name
         << "'; must be outside";
    around.item.fail(text.str());
  }
}

}  // namespace

std::vector<SpanString> read_strings(const YamlNode& settings, const Body& body, const MeshLocator& locator,
                                     const std::vector<EmbeddedPoint>& points) {
  if (!settings.has("around")) return {};
  const Eigen::Matrix3Xd& rest_m = body.mesh().nodes_m;
  std::vector<Around> all;
  for (const YamlNode& item : settings.sequence("around")) {
    all.push_back(read_one(item, body));
    require_outside(all.back(), points, rest_m);
  }
  if (all.empty()) return {};
  std::vector<ObstacleShape> shapes;
  for (const Around& around : all) shapes.push_back(around.shape);
  std::vector<SpanString> strings(points.size() - 1);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const RestSpan span{points[i - 1].at(rest_m), points[i].at(rest_m)};
    if (!span.in_air(locator)) continue;
    std::vector<Led> led;
    for (const Around& around : all) led.push_back(beside(span, around));
    std::stable_sort(led.begin(), led.end(), [](const Led& a, const Led& b) { return a.share < b.share; });
    std::vector<Eigen::Vector3d> over_m;
    for (const Led& one : led) over_m.push_back(one.position_m);
    strings[i - 1] = std::make_shared<const TautString>(shapes, over_m, (span.to_m - span.from_m).norm());
  }
  if (std::none_of(strings.begin(), strings.end(), [](const SpanString& string) { return string != nullptr; }))
    settings.child("around").fail("the cable is nowhere in the air, so it meets no obstacle");
  return strings;
}

}  // namespace soft_robot_lab
