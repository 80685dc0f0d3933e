// SPDX-License-Identifier: BSD-3-Clause
void on_push(const Push& push) { move(push.place); }
void read(const ros::NodeHandle& node) { node.getParam("angle_rad", angle_rad); }
