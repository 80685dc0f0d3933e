// SPDX-License-Identifier: BSD-3-Clause
#include "ros/recording/session_watch.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

using Level = Finding::Level;

Moment at(int second) { return {double(second), "12:00:" + std::to_string(second)}; }

constexpr std::uintmax_t plenty = 100 * BagWatch::least_free_bytes;

TEST(NodeWatch, SaysSinceWhenANodeDoesNotRun) {
  NodeWatch watch("overlay");
  EXPECT_EQ(watch.update(at(10), std::nullopt).level, Level::warning);
  EXPECT_EQ(watch.update(at(11), 5).text, "overlay runs");
  for (const int second : {20, 21, 22}) {
    const Finding finding = watch.update(at(second), std::nullopt);
    EXPECT_EQ(finding.level, Level::error);
    EXPECT_EQ(finding.text, "overlay: not running since 12:00:20");
  }
  EXPECT_EQ(watch.restarts(), 0);
  EXPECT_EQ(watch.update(at(23), 6).level, Level::ok);
  EXPECT_EQ(watch.restarts(), 1);
  EXPECT_EQ(watch.last_restart(), "12:00:23");
}

TEST(NodeWatch, SaysWhereANodeNeverStarts) {
  NodeWatch watch("recorder");
  EXPECT_EQ(watch.update(at(0), std::nullopt).level, Level::warning);
  EXPECT_EQ(watch.update(at(29), std::nullopt).level, Level::warning);
  const Finding finding = watch.update(at(30), std::nullopt);
  EXPECT_EQ(finding.level, Level::error);
  EXPECT_EQ(finding.text, "recorder: does not start; the session's log says why");
  EXPECT_EQ(watch.update(at(31), 5).level, Level::ok);
}

// One that was stopped and goes on is the same process.
TEST(NodeWatch, CountsOnlyNewProcessesAsRestarts) {
  NodeWatch watch("overlay");
  for (const std::optional<pid_t> process : {std::optional<pid_t>(5), std::optional<pid_t>(), std::optional<pid_t>(5)})
    watch.update(at(1), process);
  EXPECT_EQ(watch.restarts(), 0);
  watch.update(at(2), 7);  // so fast that nobody saw it gone
  EXPECT_EQ(watch.restarts(), 1);
}

TEST(BagWatch, IsContentWhileTheBagGrows) {
  BagWatch watch;
  for (int i = 0; i < 60; i += 10) EXPECT_EQ(watch.update(at(i), {"a.bag", 1000u + i, plenty}).level, Level::ok);
}

// Alive or not: rosbag that finds no space stays, and says nothing here.
TEST(BagWatch, SaysSinceWhenNothingWasWritten) {
  BagWatch watch;
  watch.update(at(0), {"a.bag", 1000, plenty});
  watch.update(at(5), {"a.bag", 2000, plenty});
  EXPECT_EQ(watch.update(at(24), {"a.bag", 2000, plenty}).level, Level::ok);
  const Finding finding = watch.update(at(25), {"a.bag", 2000, plenty});
  EXPECT_EQ(finding.level, Level::error);
  EXPECT_EQ(finding.text, "recording: nothing was written since 12:00:5");
  EXPECT_EQ(watch.update(at(26), {"b.bag", 0, plenty}).level, Level::ok);  // another part begins
}

TEST(BagWatch, SaysWhereNothingIsWrittenTo) {
  BagWatch watch;
  watch.update(at(0), {});
  EXPECT_EQ(watch.update(at(30), {}).level, Level::error);
}

TEST(BagWatch, WarnsOfADiskThatIsNearlyFullAndSaysWhereItIs) {
  BagWatch watch;
  const Finding nearly = watch.update(at(0), {"a.bag", 1, BagWatch::low_bytes - 1});
  EXPECT_EQ(nearly.level, Level::warning);
  EXPECT_NE(nearly.text.find("nearly full: 5120 MB are free"), std::string::npos) << nearly.text;
  const Finding full = watch.update(at(1), {"a.bag", 2, BagWatch::least_free_bytes / 2});
  EXPECT_EQ(full.level, Level::error);
  EXPECT_NE(full.text.find("full: 512 MB are free, below 1024 MB nothing is recorded"), std::string::npos) << full.text;
  EXPECT_EQ(watch.update(at(2), {"a.bag", 3, BagWatch::low_bytes}).level, Level::ok);
}

TEST(LookAtBag, FindsTheBagThatAProcessWrites) {
  const std::string folder = testing::TempDir(), path = folder + "session_watch_" + std::to_string(getpid()) + ".bag";
  EXPECT_EQ(look_at_bag(getpid(), folder).path, "");
  EXPECT_GT(look_at_bag(std::nullopt, folder).free_bytes.value_or(0), 0u);
  std::ofstream bag(path);
  bag << "twelve bytes" << std::flush;
  const BagSight sight = look_at_bag(getpid(), "/no/such/folder");
  EXPECT_EQ(sight.path, path);
  EXPECT_EQ(sight.bytes, 12u);
  EXPECT_GT(sight.free_bytes.value_or(0), 0u);
  EXPECT_FALSE(look_at_bag(std::nullopt, "/no/such/folder").free_bytes);
  unlink(path.c_str());
}

TEST(PlaceOf, SaysWhereABagCannotGoOrGoesElsewhere) {
  const std::string folder = testing::TempDir(), file = folder + "place_of_" + std::to_string(getpid());
  std::ofstream(file) << "no folder";
  EXPECT_EQ(place_of({}, folder).level, Level::ok);
  EXPECT_EQ(place_of({}, folder + "to/be/made").level, Level::ok);
  EXPECT_EQ(place_of({folder + "a.bag.active", 1, plenty}, folder).level, Level::ok);
  const Finding refused = place_of({}, file + "/bags");
  EXPECT_EQ(refused.level, Level::error);
  EXPECT_NE(refused.text.find("bag_folder " + file + "/bags cannot be written into"), std::string::npos);
  const Finding elsewhere = place_of({"/usr/my_bags.bag.active", 1, plenty}, folder);
  EXPECT_EQ(elsewhere.level, Level::error);
  EXPECT_NE(elsewhere.text.find("it goes into /usr/my_bags.bag.active, not into"), std::string::npos) << elsewhere.text;
  unlink(file.c_str());
}

TEST(WorstOf, KeepsAllThatIsAsBadAsTheWorst) {
  const Finding ok{Level::ok, "a runs"}, bad{Level::error, "b: gone"}, worse{Level::error, "c: full"};
  EXPECT_EQ(worst_of(ok, bad).text, "b: gone");
  EXPECT_EQ(worst_of(bad, ok).text, "b: gone");
  EXPECT_EQ(worst_of(bad, worse).text, "b: gone; c: full");
}

}  // namespace
}  // namespace soft_robot_lab
