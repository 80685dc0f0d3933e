// SPDX-License-Identifier: BSD-3-Clause
// Runs a rostest's cases as one node, which gets its name from the .test file.
#include <gtest/gtest.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rostest");
  const ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
