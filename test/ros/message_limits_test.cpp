// SPDX-License-Identifier: BSD-3-Clause
#include "ros/messages/message_limits.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <soft_robot_lab/ActuatorState.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <soft_robot_lab/SkinPull.h>

namespace soft_robot_lab {
namespace {

template <class Message>
std::string refusal(const std::function<void(Message&)>& spoil) {
  Message message;
  require_in_limits(message);
  spoil(message);
  try {
    require_in_limits(message);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(MessageLimits, NameTheFieldThatIsBeyondTheLimitOfItsUnit) {
  using Request = OptimisePolicy::Request;
  EXPECT_EQ(refusal<Request>([](Request& r) { r.effort_m = 1e300; }), "effort_m: 1e+300 is not in [-1000, 1000]");
  EXPECT_EQ(refusal<Request>([](Request& r) { r.tolerance_m = std::nan(""); }),
            "tolerance_m: nan is not in [-1000, 1000]");
  EXPECT_EQ(refusal<Request>([](Request& r) {
              r.poses.resize(2);
              r.poses[1].duration_s = -1e9;
            }),
            "poses.duration_s: -1000000000 is not in [-1000000, 1000000]");
  EXPECT_EQ(refusal<Request>([](Request& r) { r.target.y = 1e19; }), "target.y: 1e+19 is not in [-1e+12, 1e+12]");
}

TEST(MessageLimits, NameATextThatHoldsAZero) {
  const std::string zero("a\0b", 3);
  EXPECT_EQ(refusal<OptimisePolicy::Request>([&](auto& r) { r.method = zero; }),
            "method: holds a byte of value 0, as no text does");
  EXPECT_EQ(refusal<ActuatorState>([&](auto& m) {
              m.names = {"left", zero};
            }),
            "names: holds a byte of value 0, as no text does");
}

// A node's folder is not its user's.
TEST(MessageLimits, AskForWholePaths) {
  EXPECT_NO_THROW(require_whole_path("file", "/tmp/fitted.yaml"));
  for (const char* path : {"fitted.yaml", "", "../fitted.yaml", " /tmp/x", "~/x"}) {
    try {
      require_whole_path("file", path);
      FAIL() << path;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), "file: '" + std::string(path) + "' is no whole path; it must begin with /");
    }
  }
}

TEST(MessageLimits, LookIntoListsAndMessagesWithin) {
  EXPECT_EQ(refusal<MarkerObservations>([](MarkerObservations& m) {
              m.covariances = {0.0, INFINITY};
            }),
            "covariances: inf is not in [-1e+12, 1e+12]");
  EXPECT_EQ(refusal<ActuatorState>([](ActuatorState& m) {
              m.cables.resize(1);
              m.cables[0].path.resize(3);
              m.cables[0].path[2].z = std::nan("");
            }),
            "cables.path.z: nan is not in [-1e+12, 1e+12]");
  EXPECT_EQ(refusal<SkinPull>([](SkinPull& m) { m.header.stamp = ros::Time(4e9); }), "");
}

// Constants stand in a definition too, and are no fields.
TEST(MessageLimits, KnowTheFieldsOfADefinition) {
  const std::vector<std::string> names = {"header", "names", "values"};
  EXPECT_EQ(field_names("uint8 SEEN=0   # measured = so\n\nHeader header # a = b\nstring[] names\n  float64[]  values\n"
                        "\n================\nMSG: std_msgs/Header\nuint32 seq\n"),
            names);
}

}  // namespace
}  // namespace soft_robot_lab
