// SPDX-License-Identifier: BSD-3-Clause
// What fuzzing found worth keeping, and its like.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "fuzz_rules.h"
#include "fuzz_bag.h"
#include "ros/recording/recorded_session.h"

namespace soft_robot_lab {
namespace {

constexpr char kCorpus[] = SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/bag";

TEST(BagReader, SurvivesTheFuzzersCorpusAndItsLike) { EXPECT_GE(run_corpus(kCorpus, fuzz_bag, 40), 18); }

std::string refusal_of_bag(const std::string& name) {
  try {
    read_recorded_session(std::string(kCorpus) + "/" + name + ".bag");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// rosbag takes places and lengths as they stand, and reads beyond its memory or ends the program.
TEST(BagReader, RefusesWhatRosbagWouldFollowBeyondItsMemory) {
  const std::map<std::string, std::string> reasons = {
      {"longer_header_none", "a record is longer than what holds it"},
      {"longer_header_lz4", "a record is longer than what holds it"},
      {"longer_header_bz2", "a record is longer than what holds it"},
      {"longer_topic", "a record is longer than what holds it"},
      {"rest_behind_topic", "a number is cut off"},
      {"short_bz2", "a chunk cannot be unpacked to the size that it says"},
      {"huge_chunk", "a chunk of 4294967280 bytes, must be at most 1073741824"},
      {"points_to_topic", "it points to no message of its chunk"},
      {"unknown_topic", "it has messages of a topic that it does not name"},
      {"index_within", "it names an index where none is"},
      {"encrypted", "it is encrypted"},
      {"other_version", "it does not begin with '#ROSBAG V2.0'"}};
  for (const auto& [name, reason] : reasons) EXPECT_THAT(refusal_of_bag(name), testing::HasSubstr(reason)) << name;
}

}  // namespace
}  // namespace soft_robot_lab
