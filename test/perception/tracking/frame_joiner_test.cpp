// SPDX-License-Identifier: BSD-3-Clause
#include "perception/tracking/frame_joiner.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

using Groups = std::vector<std::vector<std::string>>;  // "camera stamp in ms"

RgbdFrame frame(const std::string& camera, int stamp_ms) {
  RgbdFrame made;
  made.camera = camera;
  made.stamp_s = 1e-3 * stamp_ms;
  return made;
}

Groups names(const std::vector<std::vector<RgbdFrame>>& groups) {
  Groups all;
  for (const auto& group : groups) {
    all.emplace_back();
    for (const RgbdFrame& one : group)
      all.back().push_back(one.camera + " " + std::to_string(static_cast<int>(1e3 * one.stamp_s + 0.5)));
  }
  return all;
}

FrameJoiner two_cameras() { return FrameJoiner({"a", "b"}, 0.016, 0.1); }

TEST(FrameJoiner, WaitsForBothCameras) {
  FrameJoiner joiner = two_cameras();
  EXPECT_EQ(names(joiner.add(frame("a", 0))), Groups{});
  EXPECT_EQ(names(joiner.add(frame("b", 5))), (Groups{{"a 0", "b 5"}}));
}

TEST(FrameJoiner, LeavesOutADroppedFrame) {
  FrameJoiner joiner = two_cameras();
  joiner.add(frame("a", 0));
  joiner.add(frame("a", 33));
  EXPECT_EQ(names(joiner.add(frame("b", 34))), (Groups{{"a 0"}, {"a 33", "b 34"}}));
}

TEST(FrameJoiner, GoesOnWithoutASilentCamera) {
  FrameJoiner joiner = two_cameras();
  joiner.add(frame("a", 0));
  EXPECT_EQ(names(joiner.add(frame("a", 66))), Groups{});
  EXPECT_EQ(names(joiner.add(frame("a", 100))), (Groups{{"a 0"}}));
  EXPECT_EQ(names(joiner.finish()), (Groups{{"a 66"}, {"a 100"}}));
}

TEST(FrameJoiner, JoinsAlikeInWhateverOrderTwoCamerasSend) {
  FrameJoiner one = two_cameras(), other = two_cameras();
  Groups first, second;
  const auto note = [](Groups& all, const Groups& more) { all.insert(all.end(), more.begin(), more.end()); };
  for (int ms : {0, 33, 66}) note(first, names(one.add(frame("a", ms))));
  for (int ms : {2, 35, 68}) note(first, names(one.add(frame("b", ms))));
  for (int ms : {0, 33, 66}) {
    note(second, names(other.add(frame("b", ms + 2))));
    note(second, names(other.add(frame("a", ms))));
  }
  EXPECT_EQ(first, second);
  EXPECT_EQ(first.size(), 3u);
}

TEST(FrameJoiner, PassesALateFrameOnByItself) {
  FrameJoiner joiner = two_cameras();
  joiner.add(frame("a", 33));
  EXPECT_EQ(names(joiner.add(frame("a", 0))), (Groups{{"a 0"}}));
}

TEST(FrameJoiner, BeginsAnewWhenTheClockGoesBack) {
  FrameJoiner joiner = two_cameras();
  joiner.add(frame("a", 1000));
  joiner.reset();
  EXPECT_EQ(names(joiner.add(frame("a", 0))), Groups{});
  EXPECT_EQ(names(joiner.add(frame("b", 0))), (Groups{{"a 0", "b 0"}}));
}

TEST(FrameJoiner, RefusesWhatItCannotJoin) {
  EXPECT_THROW(FrameJoiner({}, 0, 0), std::invalid_argument);
  EXPECT_THROW(FrameJoiner({"a"}, -1, 0), std::invalid_argument);
  EXPECT_THROW(FrameJoiner({"a"}, 0, -1), std::invalid_argument);
  FrameJoiner joiner = two_cameras();
  EXPECT_THROW(joiner.add(frame("c", 0)), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
