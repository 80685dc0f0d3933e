#pragma once

#include <string>
#include <vector>

#include <rosbag/bag.h>
#include <rosbag/view.h>

namespace soft_robot_lab {

std::string relative(const std::string& topic);  // as in topics.h
// Messages of these topics, in the order in which they were recorded.
rosbag::View only(const rosbag::Bag& bag, const std::vector<std::string>& topics);

}  // namespace soft_robot_lab
