// SPDX-License-Identifier: BSD-3-Clause
// Frames on the line: as the golden file says, whole or not at all.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fuzz_protocol.h"
#include "hardware/motor/framing.h"

namespace soft_robot_lab {
namespace {

using Bytes = std::vector<std::uint8_t>;
const std::string data = SOFT_ROBOT_LAB_SOURCE "/test/data/protocol/";

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

struct GoldenFrame {
  wire::Frame frame;
  Bytes line;
  std::string meaning;
};

std::vector<GoldenFrame> golden_frames() {
  std::ifstream file(data + "frames.txt");
  std::vector<GoldenFrame> frames;
  for (std::string text; std::getline(file, text);) {
    if (text[0] == '#') continue;
    std::istringstream words(text);
    std::string kind, session, number, payload, bar, line;
    words >> kind >> session >> number >> payload >> bar >> line >> bar;
    GoldenFrame golden;
    golden.frame.kind = from_hex(kind).at(0);
    golden.frame.session = from_hex(session).at(0);
    golden.frame.number = from_hex(number).at(0);
    const Bytes bytes = payload == "-" ? Bytes{} : from_hex(payload);
    golden.frame.length = static_cast<std::uint8_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), golden.frame.payload);
    golden.line = from_hex(line);
    std::getline(words, golden.meaning);
    frames.push_back(golden);
  }
  return frames;
}

std::vector<wire::Frame> decode(const Bytes& bytes) {
  wire::FrameDecoder decoder;
  std::vector<wire::Frame> frames;
  for (const std::uint8_t byte : bytes) {
    if (decoder.feed(byte)) frames.push_back(decoder.frame());
  }
  return frames;
}

void expect_equal(const wire::Frame& found, const wire::Frame& expected) {
  EXPECT_EQ(found.kind, expected.kind);
  EXPECT_EQ(found.session, expected.session);
  EXPECT_EQ(found.number, expected.number);
  EXPECT_EQ(Bytes(found.payload, found.payload + found.length),
            Bytes(expected.payload, expected.payload + expected.length));
}

TEST(Framing, WritesTheGoldenBytes) {
  ASSERT_EQ(golden_frames().size(), 17U);
  for (const GoldenFrame& golden : golden_frames()) {
    std::uint8_t bytes[wire::max_encoded];
    const std::uint8_t size = wire::encode(golden.frame, bytes);
    EXPECT_EQ(Bytes(bytes, bytes + size), golden.line) << golden.meaning;
  }
}

TEST(Framing, ReadsTheGoldenBytes) {
  for (const GoldenFrame& golden : golden_frames()) {
    const auto frames = decode(golden.line);
    ASSERT_EQ(frames.size(), 1U) << golden.meaning;
    expect_equal(frames[0], golden.frame);
  }
}

TEST(Framing, RefusesEveryFrameWithOneByteChangedLostOrDoubled) {
  for (const GoldenFrame& golden : golden_frames()) {
    for (std::size_t i = 0; i + 1 < golden.line.size(); ++i) {
      for (int change = 1; change < 256; ++change) {
        Bytes bytes = golden.line;
        bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ change);
        EXPECT_TRUE(decode(bytes).empty()) << golden.meaning << ", byte " << i;
      }
      Bytes lost = golden.line;
      lost.erase(lost.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_TRUE(decode(lost).empty()) << golden.meaning << ", byte " << i;
      Bytes doubled = golden.line;
      doubled.insert(doubled.begin() + static_cast<std::ptrdiff_t>(i), doubled[i]);
      EXPECT_TRUE(decode(doubled).empty()) << golden.meaning << ", byte " << i;
    }
  }
}

TEST(Framing, FindsTheNextFrameAfterNoise) {
  const auto golden = golden_frames();
  for (const Bytes& noise : {Bytes{1, 2, 3, 0}, Bytes(500, 0xff), Bytes{0, 0, 0}, Bytes{5, 0}}) {
    Bytes bytes = noise;
    bytes.push_back(0);
    bytes.insert(bytes.end(), golden[4].line.begin(), golden[4].line.end());
    const auto frames = decode(bytes);
    ASSERT_EQ(frames.size(), 1U);
    expect_equal(frames[0], golden[4].frame);
  }
}

TEST(Framing, CountsDamagedFrames) {
  wire::FrameDecoder decoder;
  for (const std::uint8_t byte : Bytes{3, 3, 3, 0, 0, 9, 0}) EXPECT_FALSE(decoder.feed(byte));
  EXPECT_EQ(decoder.damaged(), 2);
}

TEST(Framing, KeepsPositionsOfAllTwentyFourBits) {
  for (const std::int32_t value : {0, 1, -1, wire::max_position, -wire::max_position, 8388607, -8388608}) {
    std::uint8_t bytes[3];
    wire::put_i24(bytes, value);
    EXPECT_EQ(wire::get_i24(bytes), value);
  }
}

Bytes read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

// What fuzzing found worth keeping, and as much again of each with random changes.
TEST(Framing, SurvivesTheFuzzersCorpusAndItsLike) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(data + "corpus")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_GE(files.size(), 16U);
  std::mt19937_64 random(1);
  for (const std::string& file : files) {
    Bytes bytes = read(file);
    fuzz_protocol(bytes.data(), bytes.size());
    for (int i = 0; i < 20 && !bytes.empty(); ++i) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      if (random() % 4 == 0) bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size()), 0);
      fuzz_protocol(bytes.data(), bytes.size());
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
