// SPDX-License-Identifier: BSD-3-Clause
#include "session/preview.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

const std::vector<double> asked = {0.9, 1.0}, under_way = {0.95, 1.0};
const std::vector<Eigen::Vector3d> here_m = {{0.0, 0.0, -0.05}, {0.0, 0.0, -0.1}},
                                   there_m = {{0.005, 0.0, -0.05}, {0.02, 0.0, -0.09}};

TEST(Preview, IsShownUntilTheRobotIsThere) {
  Preview preview;
  preview.add_markers(here_m);
  EXPECT_TRUE(preview.show(asked, there_m));
  preview.add_drives(10.0, asked, under_way);
  preview.add_markers({there_m[0], here_m[1]});
  EXPECT_TRUE(preview.shown());
  preview.add_markers({there_m[0], there_m[1] + Eigen::Vector3d(0.0, 4e-4, 0.0)});
  EXPECT_FALSE(preview.shown());
}

TEST(Preview, IsNotShownOfWhereTheRobotIs) {
  Preview preview;
  preview.add_markers(there_m);
  EXPECT_FALSE(preview.show(asked, there_m));
  EXPECT_FALSE(preview.shown());
}

// As one that friction holds, or that buckled another way.
TEST(Preview, EndsWhereTheRobotRestsElsewhere) {
  Preview preview;
  preview.add_markers(here_m);
  ASSERT_TRUE(preview.show(asked, there_m));
  preview.add_drives(10.0, asked, under_way);
  preview.add_drives(20.0, asked, asked);
  preview.add_drives(20.0 + 0.9 * Preview::settling_s, asked, asked);
  EXPECT_TRUE(preview.shown());
  preview.add_drives(20.0 + 1.1 * Preview::settling_s, asked, asked);
  EXPECT_FALSE(preview.shown());
}

TEST(Preview, OfARobotWithoutMarkersEndsAfterItsDrives) {
  Preview preview;
  EXPECT_TRUE(preview.show(asked, {}));
  preview.add_markers({});
  EXPECT_TRUE(preview.shown());
  preview.add_drives(1.0, asked, asked);
  preview.add_drives(1.0 + 1.1 * Preview::settling_s, asked, asked);
  EXPECT_FALSE(preview.shown());
}

TEST(Preview, WaitsForDrivesThatMoveAgain) {
  Preview preview;
  preview.add_markers(here_m);
  ASSERT_TRUE(preview.show(asked, there_m));
  preview.add_drives(1.0, asked, asked);
  preview.add_drives(2.0, under_way, asked);  // someone else's command: its own preview comes
  preview.add_drives(4.0, asked, asked);
  EXPECT_TRUE(preview.shown());
}

}  // namespace
}  // namespace soft_robot_lab
