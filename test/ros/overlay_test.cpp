// SPDX-License-Identifier: BSD-3-Clause
#include "ros/display/overlay.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

using Shape = visualization_msgs::Marker;

geometry_msgs::Point point(double x, double y, double z) {
  geometry_msgs::Point result;
  result.x = x;
  result.y = y;
  result.z = z;
  return result;
}

OverlayInputs inputs() {
  OverlayInputs result;
  result.simulated.names = {"tip"};
  result.simulated.sources.assign(1, MarkerObservations::SIMULATED);
  result.simulated.positions = {point(0.0, 0.0, -0.1)};
  CableState cable;
  cable.name = "left";
  cable.tension_n = 8.0;
  cable.path = {point(0, 0, 0), point(0, 0, -0.05), point(0, 0, -0.1)};
  result.actuators.cables = {cable};
  return result;
}

Target target_for(const std::string& marker) {
  Target target;
  target.marker = marker;
  target.position = point(0.03, 0.04, -0.1);
  return target;
}

std::vector<Shape> all_of(DrawnOverlay drawn) {
  std::vector<Shape> all = std::move(drawn.shapes.markers);
  all.insert(all.end(), drawn.labels.markers.begin(), drawn.labels.markers.end());
  return all;
}

std::vector<Shape> shapes_in(const OverlayInputs& from, const std::string& ns) {
  std::vector<Shape> found = all_of(Overlay().draw(from, ros::Time(1.0)));
  found.erase(std::remove_if(found.begin(), found.end(), [&](const Shape& s) { return s.ns != ns; }), found.end());
  return found;
}

TEST(Overlay, DrawsEveryMarkerWithItsName) {
  ASSERT_EQ(shapes_in(inputs(), "simulated").size(), 1u);
  ASSERT_EQ(shapes_in(inputs(), "simulated_names").size(), 1u);
  EXPECT_EQ(shapes_in(inputs(), "simulated_names")[0].text, "tip");
}

TEST(Overlay, WritesTheNameOfAMarkerOnce) {
  OverlayInputs tracked = inputs();
  tracked.measured.names = {"tip", "joint_1"};
  tracked.measured.sources.assign(2, MarkerObservations::SEEN);
  tracked.measured.positions = {point(0.001, 0.0, -0.1), point(0.0, 0.0, -0.02)};
  EXPECT_EQ(shapes_in(tracked, "measured").size(), 2u);
  EXPECT_EQ(shapes_in(tracked, "simulated_names").size(), 1u);
  ASSERT_EQ(shapes_in(tracked, "measured_names").size(), 1u);
  EXPECT_EQ(shapes_in(tracked, "measured_names")[0].text, "joint_1");
}

// What lays them out puts them beside these places.
TEST(Overlay, WritesLabelsAtWhatTheyNameAndApartFromShapes) {
  OverlayInputs tracked = inputs();
  tracked.gap = RealityGap();
  tracked.gap->names = {"tip"};
  tracked.gap->measured = {point(0.001, 0.0, -0.1)};
  tracked.gap->gaps.resize(1);
  tracked.gap->distances_m = {0.001};
  tracked.gap->seen = {1};
  tracked.target = target_for("tip");
  const DrawnOverlay drawn = Overlay().draw(tracked, ros::Time(1.0));
  for (const Shape& shape : drawn.shapes.markers) {
    EXPECT_NE(shape.type, Shape::TEXT_VIEW_FACING) << shape.ns;
    EXPECT_TRUE(shape.text.empty()) << shape.ns;
  }
  for (const Shape& shape : drawn.labels.markers) EXPECT_FALSE(shape.text.empty()) << shape.ns;
  EXPECT_EQ(shapes_in(tracked, "gap_text").at(0).pose.position.x, 0.001);
  EXPECT_EQ(shapes_in(tracked, "simulated_names").at(0).pose.position.z, -0.1);
  EXPECT_EQ(shapes_in(tracked, "cable_tensions").at(0).pose.position.z, 0.0);
}

TEST(Overlay, ColoursCablesByTension) {
  OverlayInputs slack = inputs();
  slack.actuators.cables[0].tension_n = 0.0;
  const Shape tight_line = shapes_in(inputs(), "cables").at(0);
  const Shape slack_line = shapes_in(slack, "cables").at(0);
  EXPECT_EQ(tight_line.points.size(), 3u);
  EXPECT_GT(tight_line.color.r, tight_line.color.b);
  EXPECT_GT(slack_line.color.b, slack_line.color.r);
}

TEST(Overlay, DrawsContactsAsArrowsAndAreas) {
  OverlayInputs touching = inputs();
  Contact floor;
  floor.first = "skin";
  floor.second = "floor";
  floor.center = point(0.01, 0.0, -0.1);
  floor.normal.x = 1.0;
  floor.force.x = floor.normal_force_n = 0.5;
  floor.area_m2 = M_PI * 1e-4;
  floor.slipping_area_m2 = floor.area_m2;
  touching.contacts.contacts = {floor};
  const Shape arrow = shapes_in(touching, "contacts").at(0);
  EXPECT_NEAR(arrow.points.at(0).x, 0.01, 1e-12);
  EXPECT_NEAR(arrow.points.at(1).x, 0.01 + 0.5 * OverlayOptions().arrow_m_n, 1e-12);
  const Shape slips = shapes_in(touching, "contact_areas").at(0);
  EXPECT_NEAR(slips.scale.x, 0.02, 1e-12);
  EXPECT_NEAR(slips.pose.orientation.y, std::sqrt(0.5), 1e-12);
  EXPECT_EQ(shapes_in(touching, "contact_forces").at(0).text, "0.50 N");
  touching.contacts.contacts[0].slipping_area_m2 = 0.0;
  EXPECT_GT(shapes_in(touching, "contact_areas").at(0).color.g, slips.color.g);
  touching.contacts.contacts[0].area_m2 = -1.0;
  EXPECT_THROW(Overlay().draw(touching, ros::Time(1.0)), std::invalid_argument);
}

TEST(Overlay, FitsTheScaleOfTensionsToWhatTheRobotShows) {
  OverlayInputs loose = inputs();
  loose.actuators.cables[0].tension_n = 0.3;
  const auto end_of_scale = [](const DrawnOverlay& drawn) {
    for (const Shape& shape : drawn.labels.markers)
      if (shape.ns == "tension_scale") return shape.text;
    return std::string("none");
  };
  Overlay overlay;
  EXPECT_EQ(end_of_scale(overlay.draw(loose, ros::Time(1.0))), "1 N");
  EXPECT_EQ(end_of_scale(overlay.draw(inputs(), ros::Time(2.0))), "10 N");
  EXPECT_EQ(end_of_scale(overlay.draw(loose, ros::Time(3.0))), "10 N") << "a scale that shrinks recolours all";
  overlay.forget();
  EXPECT_EQ(end_of_scale(overlay.draw(loose, ros::Time(4.0))), "1 N") << "of another robot";
  const Shape bar = shapes_in(inputs(), "tension_scale").at(0);
  EXPECT_EQ(bar.colors.size(), bar.points.size());
}

TEST(Overlay, WritesPressureAndVolumeIntoChambers) {
  OverlayInputs inflated = inputs();
  ChamberState chamber;
  chamber.name = "a";
  chamber.volume_m3 = 80e-6;
  chamber.gauge_pressure_pa = 1234.0;
  chamber.centre = point(0.0, 0.01, -0.05);
  inflated.actuators.chambers = {chamber};
  const std::vector<Shape> texts = shapes_in(inflated, "chamber_pressures");
  ASSERT_EQ(texts.size(), 1u);
  EXPECT_EQ(texts[0].text, "a 1.2 kPa\n80.0 ml");
  EXPECT_EQ(texts[0].pose.position.y, 0.01);
  inflated.actuators.chambers[0].gauge_pressure_pa = -49.0;
  EXPECT_EQ(shapes_in(inflated, "chamber_pressures").at(0).text, "a 0.0 kPa\n80.0 ml");
}

TEST(Overlay, DrawsTheErrorInMillimetresOnlyWithATarget) {
  EXPECT_TRUE(shapes_in(inputs(), "error").empty());
  OverlayInputs aimed = inputs();
  aimed.target = target_for("tip");
  const std::vector<Shape> errors = shapes_in(aimed, "error");
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].text, "50.00 mm");
  EXPECT_EQ(errors[0].points.at(0), aimed.simulated.positions[0]);
  EXPECT_EQ(errors[0].points.at(1), aimed.target->position);
}

TEST(Overlay, LeavesTheErrorOutForAMarkerNobodySees) {
  OverlayInputs aimed = inputs();
  aimed.target = target_for("tail");
  EXPECT_EQ(shapes_in(aimed, "target").size(), 1u);
  EXPECT_TRUE(shapes_in(aimed, "error").empty());
}

TEST(Overlay, RefusesWhatIsNotWhole) {
  const std::function<void(OverlayInputs&)> spoil[] = {
      [](OverlayInputs& all) { all.simulated.positions.pop_back(); },
      [](OverlayInputs& all) { all.simulated.positions[0].x = std::nan(""); },
      [](OverlayInputs& all) { all.actuators.cables[0].tension_n = std::nan(""); },
      [](OverlayInputs& all) { all.actuators.cables[0].path[0].z = INFINITY; },
      [](OverlayInputs& all) {
        all.target = target_for("tip");
        all.target->position.y = 1e300;
      },
      [](OverlayInputs& all) {
        all.gap = RealityGap();
        all.gap->names = {"tip"};
      },
  };
  EXPECT_NO_THROW(Overlay().draw(inputs(), ros::Time(1.0)));
  for (const auto& change : spoil) {
    OverlayInputs all = inputs();
    change(all);
    EXPECT_THROW(Overlay().draw(all, ros::Time(1.0)), std::invalid_argument);
  }
}

// Or rviz would draw one marker where another was.
TEST(Overlay, KeepsNumbersWhereAMarkerHidesAndDeletesIt) {
  OverlayInputs both = inputs();
  both.measured.names = {"joint_1", "tip"};
  both.measured.sources.assign(2, MarkerObservations::SEEN);
  both.measured.positions = {point(0.0, 0.0, -0.02), point(0.001, 0.0, -0.1)};
  OverlayInputs one = both;
  one.measured.names = {"tip"};
  one.measured.sources.pop_back();
  one.measured.positions.erase(one.measured.positions.begin());
  Overlay overlay;
  const auto before = all_of(overlay.draw(both, ros::Time(1.0)));
  const auto after = all_of(overlay.draw(one, ros::Time(2.0)));
  std::vector<Shape> deleted;
  for (const Shape& shape : after) {
    if (shape.action == Shape::DELETE) {
      deleted.push_back(shape);
      continue;
    }
    const auto same = std::find_if(before.begin(), before.end(), [&](const Shape& s) { return s.id == shape.id; });
    ASSERT_NE(same, before.end()) << shape.ns;
    EXPECT_EQ(same->ns, shape.ns);
    EXPECT_EQ(same->pose.position.z, shape.pose.position.z) << shape.ns;
  }
  ASSERT_EQ(deleted.size(), 2u);  // the joint's sphere, and its name
  EXPECT_EQ(deleted[0].ns, "measured");
  const auto joint = std::find_if(before.begin(), before.end(), [](const Shape& s) { return s.ns == "measured"; });
  EXPECT_EQ(deleted[0].id, joint->id);
  EXPECT_EQ(all_of(overlay.draw(one, ros::Time(3.0))).size(), after.size() - 2);
}

TEST(Overlay, GivesEveryShapeItsOwnNumber) {
  OverlayInputs aimed = inputs();
  aimed.target = target_for("tip");
  std::vector<int> ids;
  for (const Shape& shape : all_of(Overlay().draw(aimed, ros::Time(1.0)))) ids.push_back(shape.id);
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
}

// Of `simulated`, a trail that follows `tip`.
std::vector<geometry_msgs::Point> trail_after(Overlay& overlay, const std::vector<std::pair<double, double>>& z_at) {
  std::vector<geometry_msgs::Point> points;
  for (const auto& [time_s, z] : z_at) {
    OverlayInputs now = inputs();
    now.simulated.positions = {point(0.0, 0.0, z)};
    points.clear();
    for (const Shape& shape : all_of(overlay.draw(now, ros::Time(time_s))))
      if (shape.ns == "simulated_trail" && shape.action == Shape::ADD) {
        EXPECT_EQ(shape.colors.size(), shape.points.size());
        points = shape.points;
      }
  }
  return points;
}

TEST(Overlay, DrawsTheTrailOfTheTipForTenSeconds) {
  Overlay overlay;
  EXPECT_EQ(trail_after(overlay, {{1.0, -0.1}}).size(), 0u) << "a place is no trail";
  EXPECT_EQ(trail_after(overlay, {{2.0, -0.099}, {3.0, -0.098}}).size(), 3u);
  EXPECT_EQ(trail_after(overlay, {{3.1, -0.09801}}).size(), 3u) << "hardly moved";
  const auto later = trail_after(overlay, {{12.5, -0.09}});
  ASSERT_EQ(later.size(), 2u) << "what is older is forgotten";
  EXPECT_EQ(later.front().z, -0.098);
  overlay.forget();
  EXPECT_EQ(trail_after(overlay, {{12.6, -0.08}}).size(), 0u) << "of another robot";
  trail_after(overlay, {{12.7, -0.09}});
  EXPECT_EQ(trail_after(overlay, {{5.0, -0.1}}).size(), 0u) << "the clock went back";
}

// Semi-axes of three standard deviations, the longest along (1, 1, 0).
TEST(Overlay, DrawsCovariancesAsEllipsoids) {
  OverlayInputs tracked = inputs();
  tracked.measured.names = {"tip", "seen"};
  tracked.measured.sources = {MarkerObservations::INTERPOLATED, MarkerObservations::SEEN};
  tracked.measured.positions = {point(0.0, 0.0, -0.1), point(0.0, 0.0, -0.05)};
  const double u = 0.5 * (4e-6 + 1e-6), v = 0.5 * (4e-6 - 1e-6);
  tracked.measured.covariances = {u, v, 0, v, u, 0, 0, 0, 1e-6, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  const std::vector<Shape> found = shapes_in(tracked, "covariances");
  ASSERT_EQ(found.size(), 1u) << "nothing where nothing is known";
  const Shape& shape = found[0];
  EXPECT_EQ(shape.type, Shape::SPHERE);
  EXPECT_EQ(shape.pose.position.z, -0.1);
  const Eigen::Quaterniond turn(shape.pose.orientation.w, shape.pose.orientation.x, shape.pose.orientation.y,
                                shape.pose.orientation.z);
  const Eigen::Vector3d scale(shape.scale.x, shape.scale.y, shape.scale.z);
  const Eigen::Matrix3d spread = turn.matrix() * (scale / 6.0).cwiseAbs2().asDiagonal() * turn.matrix().transpose();
  EXPECT_LT((spread - Eigen::Matrix3d::Map(tracked.measured.covariances.data())).norm(), 1e-12);
}

// One that is damaged draws nothing, and stops nothing.
TEST(Overlay, LeavesOutCovariancesThatAreNoneOrNotFinite) {
  OverlayInputs tracked = inputs();
  tracked.measured = tracked.simulated;
  for (const std::vector<double>& covariances : {std::vector<double>{}, std::vector<double>(9, std::nan(""))}) {
    tracked.measured.covariances = covariances;
    EXPECT_TRUE(shapes_in(tracked, "covariances").empty());
    EXPECT_EQ(shapes_in(tracked, "measured").size(), 1u);
  }
}

}  // namespace
}  // namespace soft_robot_lab
