// SPDX-License-Identifier: BSD-3-Clause
#include "ros/display/surface_marker.h"

#include <gtest/gtest.h>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/config_folder.h"

namespace soft_robot_lab {
namespace {

TetMesh box() {
  TetMesh mesh = box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5, 2, 1});
  complete_boundary(mesh);
  return mesh;
}

// What load_scene makes of one of the package's robots.
Scene robot(const std::string& name) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  return load_scene(config_folder() + "/robots/" + name + "/robot.yaml", options);
}

TEST(SurfaceMarker, ColoursEachCornerByItsOwnNormal) {
  SurfaceMarker surface(box());
  const visualization_msgs::Marker marker = surface.message(box().nodes_m, ros::Time(1.0));
  ASSERT_EQ(marker.colors.size(), marker.points.size());
  EXPECT_EQ(marker.color.a, 1.0f);
  float top = 0.0f, bottom = 0.0f;
  for (std::size_t i = 0; i + 2 < marker.points.size(); i += 3) {
    const bool is_top =
        marker.points[i].z > 0.0099 && marker.points[i + 1].z > 0.0099 && marker.points[i + 2].z > 0.0099;
    const bool is_bottom =
        marker.points[i].z < -0.0099 && marker.points[i + 1].z < -0.0099 && marker.points[i + 2].z < -0.0099;
    if (is_top) top = marker.colors[i].g;
    if (is_bottom) bottom = marker.colors[i].g;
  }
  EXPECT_GT(top, bottom);
  EXPECT_GT(bottom, 0.2f) << "no side is black";
}

TEST(FittingOpacity, HidesNeitherCablesNorChambers) {
  EXPECT_LT(fitting_opacity(*robot("hanging_bar").simulation), 1.0) << "its cable runs inside the bar";
  EXPECT_LT(fitting_opacity(*robot("bubblefinger").simulation), 1.0) << "its chamber is inside";
  EXPECT_EQ(fitting_opacity(*robot("spinebot").simulation), 1.0) << "its cables are free between the vertebrae";
}

}  // namespace
}  // namespace soft_robot_lab
