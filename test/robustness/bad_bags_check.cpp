// SPDX-License-Identifier: BSD-3-Clause
// bad_bags_check [PART]: reads bad and extreme recordings, of which PART takes every PART-th only, and counts how each
// ended: read, or refused with a reason. All of them at once: every hundredth becomes a report as well. Status 1 where
// one ended as none may.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include "fuzz_rules.h"
#include "bad_bytes.h"
#include "guarded.h"
#include "ros/recording/recorded_session.h"
#include "session/rest_periods.h"
#include "ros/report/session_report.h"

namespace soft_robot_lab {

// A message as its bytes, under whatever type a header says.
struct RawMessage {
  FuzzBytes bytes;
};

}  // namespace soft_robot_lab

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<soft_robot_lab::RawMessage> {
  static const char* value(const soft_robot_lab::RawMessage&) { return "*"; }
};
template <>
struct DataType<soft_robot_lab::RawMessage> {
  static const char* value(const soft_robot_lab::RawMessage&) { return "*"; }
};
template <>
struct Definition<soft_robot_lab::RawMessage> {
  static const char* value(const soft_robot_lab::RawMessage&) { return ""; }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<soft_robot_lab::RawMessage> {
  template <typename Stream>
  static void write(Stream& stream, const soft_robot_lab::RawMessage& message) {
    std::memcpy(stream.advance(static_cast<std::uint32_t>(message.bytes.size())), message.bytes.data(),
                message.bytes.size());
  }
  static std::uint32_t serializedLength(const soft_robot_lab::RawMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace soft_robot_lab {
namespace {

struct Recorded {
  std::string topic, type, md5, definition;
  double time_s;
  FuzzBytes bytes;
};

template <typename Message>
Recorded recorded(const std::string& topic, double time_s, const Message& message) {
  namespace traits = ros::message_traits;
  FuzzBytes bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return {topic, traits::datatype<Message>(), traits::md5sum<Message>(), traits::definition<Message>(), time_s, bytes};
}

MarkerObservations markers(double time_s) {
  MarkerObservations message;
  message.header.stamp = ros::Time(time_s);
  message.names = {"tip"};
  message.positions.resize(1);
  message.positions[0].x = time_s < 13.0 ? 0.0 : 0.01;
  message.covariances.assign(9, 1e-8);
  message.sources = {MarkerObservations::SEEN};
  return message;
}

// At rest for three seconds, moved, and at rest again.
std::vector<Recorded> good_session() {
  std_msgs::String scene;
  scene.data = "/nowhere/scene.yaml";
  ActuatorCommand command;
  command.header.stamp = ros::Time(13.0);
  command.names = {"left"};
  command.values = {0.9};
  MotorState motors;
  motors.header.stamp = ros::Time(13.1);
  motors.names = {"left"};
  motors.position_steps = motors.target_steps = motors.pull_m = motors.values = {1.0};
  motors.known = motors.moving = {1};
  motors.fault = {""};
  std::vector<Recorded> session = {recorded("/simulator/scene", 10.0, scene)};
  for (int i = 0; i < 60; ++i) {
    const double time_s = 10.0 + 0.1 * i;
    session.push_back(recorded("/tracker/markers", time_s, markers(time_s)));
    if (i % 10 == 0) session.push_back(recorded("/simulator/markers", time_s, markers(time_s)));
    if (i == 30) session.push_back(recorded("/actuators/command", time_s, command));
    if (i == 31) session.push_back(recorded("/motor/state", time_s, motors));
  }
  return session;
}

FuzzBytes bag_of(const std::vector<Recorded>& session) {
  const FuzzFile file(nullptr, 0);
  rosbag::Bag bag(file.path(), rosbag::bagmode::Write);
  for (const Recorded& one : session) {
    const auto header = boost::make_shared<ros::M_string>();
    (*header)["type"] = one.type;
    (*header)["md5sum"] = one.md5;
    (*header)["message_definition"] = one.definition;
    bag.write(one.topic, ros::Time(one.time_s), RawMessage{one.bytes}, header);
  }
  bag.close();
  std::ifstream written(file.path(), std::ios::binary);
  return {std::istreambuf_iterator<char>(written), {}};
}

struct BadBag {
  std::string name;
  std::function<FuzzBytes()> make;
};

// One message of each topic, of which every fourth bad copy is taken; and its type, topic and time.
void add_messages(const std::vector<Recorded>& session, std::vector<BadBag>& all) {
  const auto add = [&](std::size_t at, const std::string& what, Recorded other) {
    all.push_back({session[at].topic + ": " + what, [session, at, other] {
                     std::vector<Recorded> spoilt = session;
                     spoilt[at] = other;
                     return bag_of(spoilt);
                   }});
  };
  std::string topics;
  for (std::size_t at = 0; at < session.size(); ++at) {
    if (topics.find(session[at].topic + " ") != std::string::npos) continue;
    topics += session[at].topic + " ";
    const std::vector<BadBytes> copies = bad_bytes(session[at].bytes, 1);
    for (std::size_t i = 0; i < copies.size(); i += 4) {
      Recorded other = session[at];
      other.bytes = copies[i].bytes;
      add(at, copies[i].name, other);
    }
    for (const Recorded& own : {session[0], session[1]}) {
      Recorded other = session[at];
      other.type = own.type;
      add(at, "type " + own.type, other);
      other.md5 = own.md5;
      add(at, "type and checksum of " + own.type, other);
    }
    for (const std::string& topic :
         {std::string(), std::string("/"), std::string(100000, 'x'), std::string("\n\0'", 3)}) {
      Recorded other = session[at];
      other.topic = topic;
      add(at, "another topic", other);
    }
    for (const double time_s : {1e-9, 4294967294.0}) {
      Recorded other = session[at];
      other.time_s = time_s;
      add(at, "recorded at " + std::to_string(time_s), other);
    }
  }
}

// Where the records of a bag begin; each has a header and data, both with their lengths before them.
std::vector<std::size_t> records_of(const FuzzBytes& bag) {
  std::vector<std::size_t> begins;
  for (std::size_t at = std::strlen("#ROSBAG V2.0\n"); at + 8 <= bag.size();) {
    begins.push_back(at);
    for (int part = 0; part < 2; ++part) {
      std::uint32_t length = 0;
      if (at + 4 <= bag.size()) std::memcpy(&length, bag.data() + at, 4);
      at += 4 + length;
    }
  }
  begins.push_back(bag.size());
  return begins;
}

// Records left out, doubled, exchanged with the next, and with the bytes of their headers and lengths replaced.
void add_records(const FuzzBytes& bag, std::vector<BadBag>& all) {
  const std::vector<std::size_t> begins = records_of(bag);
  const auto part = [bag](std::size_t from, std::size_t to) {
    return FuzzBytes(bag.begin() + static_cast<std::ptrdiff_t>(from), bag.begin() + static_cast<std::ptrdiff_t>(to));
  };
  const auto add = [&](const std::string& what, const std::vector<FuzzBytes>& parts) {
    FuzzBytes whole;
    for (const FuzzBytes& one : parts) whole.insert(whole.end(), one.begin(), one.end());
    all.push_back({what, [whole] { return whole; }});
  };
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    const std::string what = "record " + std::to_string(i);
    const FuzzBytes before = part(0, begins[i]), own = part(begins[i], begins[i + 1]),
                    after = part(begins[i + 1], bag.size());
    add(what + " left out", {before, after});
    add(what + " doubled", {before, own, own, after});
    if (i + 2 < begins.size())
      add(what + " behind the next",
          {before, part(begins[i + 1], begins[i + 2]), own, part(begins[i + 2], bag.size())});
    const std::size_t shown = std::min<std::size_t>(own.size(), 120);
    const std::vector<BadBytes> copies = bad_bytes(part(begins[i], begins[i] + shown), static_cast<unsigned int>(i));
    for (std::size_t k = i % 13; k < copies.size(); k += 13)
      add(what + ": " + copies[k].name, {before, copies[k].bytes, part(begins[i] + shown, bag.size())});
  }
}

void add_bytes(const FuzzBytes& bag, std::vector<BadBag>& all) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    FuzzBytes cut = bag, spoilt = bag;
    cut.resize(random() % bag.size());
    all.push_back({"cut off after " + std::to_string(cut.size()) + " bytes", [cut] { return cut; }});
    for (int k = 0; k < 4; ++k) spoilt[random() % spoilt.size()] = static_cast<std::uint8_t>(random());
    all.push_back({"four other bytes, " + std::to_string(i), [spoilt] { return spoilt; }});
  }
}

void require_finite(const Eigen::Ref<const Eigen::MatrixXd>& values, const char* what) {
  if (!values.allFinite()) throw Nonsense(std::string(what) + " is not finite");
}

void read(const FuzzBytes& bytes, bool with_report) {
  const FuzzFile file(bytes.data(), bytes.size());
  const RecordedSession recording = read_recorded_session(file.path());
  if (recording.measured.empty()) throw Nonsense("a recording without markers");
  for (const RealityGap& gap : recording.gaps) require_finite(Eigen::Matrix<double, 1, 1>(gap.rms_m), "rms_m");
  for (const MeasuredPose& pose : measured_poses(recording))
    for (const MeasuredMarker& marker : pose.markers) {
      require_finite(marker.position_m, "a place");
      require_finite(marker.covariance_m2, "a covariance");
    }
  measured_swings(recording);
  if (!with_report) return;
  const std::string folder =
      std::filesystem::temp_directory_path() / ("soft_robot_lab_bad_bags_" + std::to_string(getpid()));
  write_session_report(file.path(), folder);
  std::filesystem::remove_all(folder);
}

bool check(std::size_t part) {
  const std::vector<Recorded> session = good_session();
  const FuzzBytes good = bag_of(session);
  read(good, false);  // what is good is read
  std::vector<BadBag> all;
  add_messages(session, all);
  add_records(good, all);
  add_bytes(good, all);
  return all_good(run_guarded({all.size() / part, [&](std::size_t i) { return all[i * part].name; },
                               [&](std::size_t i) { read(all[i * part].make(), part == 1 && i % 100 == 0); }}));
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  return soft_robot_lab::run_check(argc, argv, "bad_bags_check", soft_robot_lab::check);
}
