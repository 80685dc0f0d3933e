// SPDX-License-Identifier: BSD-3-Clause
#include "replay_tracking.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>

#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include "recorded_frames.h"
#include "recorded_topics.h"
#include "repeat_steps.h"
#include "ros/tracking/gap_meter.h"
#include "ros/base/topics.h"
#include "perception/tracking/explain_unseen.h"
#include "settings/cpu_time.h"
#include "settings/kept_files.h"

namespace soft_robot_lab {
namespace {

using sensor_msgs::CameraInfo;

// What tracking gave, and what a reader should know of it.
class Findings {
 public:
  void add(const MarkerTracking::Result& result) {
    for (const CameraProblem& problem : result.report.problems)
      if (!problem.silent) problems_[problem.camera][problem.message] += 1;
    if (!result.report.updated) return;
    for (const std::string& name : result.report.lost) seen_[name];
    for (const MarkerObservation& marker : result.report.markers)
      seen_[marker.name] += marker.source == MarkerSource::seen ? 1 : 0;
    for (const RgbdFrame& frame : result.frames)
      if (const auto& used = result.report.cameras; std::find(used.begin(), used.end(), frame.camera) != used.end())
        last_[frame.camera] = frame;
    measured_.push_back(result.observations);
  }

  const std::vector<MarkerObservations>& measured() const { return measured_; }
  const std::map<std::string, long>& seen() const { return seen_; }
  bool any_seen() const {
    return std::any_of(seen_.begin(), seen_.end(), [](const auto& marker) { return marker.second > 0; });
  }
  std::string problems_of(const std::string& camera) const {
    std::string text;
    const auto found = problems_.find(camera);
    if (found == problems_.end()) return text;
    for (const auto& [problem, count] : found->second)
      text += (text.empty() ? "" : "; ") + std::to_string(count) + " times: " + problem;
    return text;
  }
  const std::map<std::string, RgbdFrame>& last_frames() const { return last_; }

 private:
  std::vector<MarkerObservations> measured_;
  std::map<std::string, long> seen_;                             // by marker
  std::map<std::string, std::map<std::string, long>> problems_;  // by camera: how often
  std::map<std::string, RgbdFrame> last_;                        // of each camera
};

// Of bare cameras, or by a tracker that did not publish its steps.
class AnewTracking {
 public:
  AnewTracking(const rosbag::Bag& bag, const TrackingInputOptions& options, Findings& findings)
      : options_(options), findings_(findings), input_(options, [&findings](const auto& r) { findings.add(r); }) {
    for (const std::string& camera : options.tracking.cameras)
      frames_.try_emplace(camera, bag, camera, options.tracking.sync_tolerance_s);
    take_first(bag);
    for (const rosbag::MessageInstance& message : rosbag::View(bag)) add(message);
    input_.finish();
  }

  // Of each camera, what is wrong with it; without those of which all is well.
  std::map<std::string, std::string> notes() const {
    std::map<std::string, std::string> notes;
    for (const auto& [camera, frames] : frames_) {
      std::string note = frames.note();
      for (const std::string& more : {input_.missing(camera), findings_.problems_of(camera)})
        if (!more.empty()) note += (note.empty() ? "" : "; ") + more;
      if (!note.empty()) notes[camera] = note;
    }
    return notes;
  }

  std::string why_nothing() const {
    std::string text;
    if (!input_.tracking()) text = "there is no scene: it holds no simulator/scene, and none was given";
    for (const auto& [camera, note] : notes()) text += (text.empty() ? "" : ". ") + (camera + ": " + note);
    return text;
  }

  std::string why_unseen() const {
    std::string text;
    for (const auto& [camera, frame] : findings_.last_frames())
      text += (text.empty() ? "" : ". ") + (camera + ": in its last image " +
                                            explain_unseen(frame, input_.tracking()->cameras().at(camera),
                                                           input_.tracking()->markers(), input_.settings()));
    return text;
  }

 private:
  // A lens or a scene that comes at the time of the first images, or after them, counts for these too.
  void take_first(const rosbag::Bag& bag) {
    std::vector<std::string> first;
    for (const std::string& camera : options_.tracking.cameras) first.push_back(info_topic(camera));
    if (options_.scene.empty()) first.push_back(topics::simulator_scene);
    for (const std::string& topic : first)
      for (const rosbag::MessageInstance& message : only(bag, {topic})) {
        add(message);
        break;
      }
  }

  void add(const rosbag::MessageInstance& message) {
    const std::string topic = relative(message.getTopic());
    if (topic == topics::simulator_markers) input_.add_simulated(*read_message<MarkerObservations>(message));
    if (topic == topics::simulator_scene && options_.scene.empty())
      input_.start(read_message<std_msgs::String>(message)->data);
    for (auto& [camera, frames] : frames_) {
      if (topic == info_topic(camera)) add_info(camera, *read_message<CameraInfo>(message), frames);
      frames.add(message, [this](const RgbdFrame& frame) { input_.add_frame(frame); });
    }
  }

  void add_info(const std::string& camera, const CameraInfo& info, RecordedFrames& frames) {
    try {
      input_.add_info(camera, info);
    } catch (const std::invalid_argument& error) {
      frames.refuse(error.what());
    }
  }

  const TrackingInputOptions& options_;
  Findings& findings_;
  TrackingInput input_;
  std::map<std::string, RecordedFrames> frames_;
};

template <typename Message>
std::vector<Message> messages_of(const rosbag::Bag& bag, const std::string& topic) {
  std::vector<Message> messages;
  for (const rosbag::MessageInstance& message : only(bag, {topic})) messages.push_back(*read_message<Message>(message));
  return messages;
}

// Of messages at the same time; where a camera's frame came late there are several. Numbers that publishers count by
// are not compared.
template <typename Message>
void compare(const std::vector<Message>& recorded, const std::vector<Message>& replayed, long& alike, long& other) {
  std::map<ros::Time, std::vector<Message>> by_stamp;
  for (Message message : recorded) {
    message.header.seq = 0;
    by_stamp[message.header.stamp].push_back(std::move(message));
  }
  for (const Message& message : replayed) {
    const auto then = by_stamp.find(message.header.stamp);
    if (then == by_stamp.end()) continue;
    const bool found = std::find(then->second.begin(), then->second.end(), message) != then->second.end();
    ++(found ? alike : other);
  }
}

template <typename Message>
void write(rosbag::Bag& bag, const std::string& topic, const std::vector<Message>& messages) {
  for (const Message& message : messages) bag.write("/" + topic, message.header.stamp, message);
}

// Whole, or not at all.
void write_output(const std::string& path, const std::vector<MarkerObservations>& measured,
                  const std::vector<RealityGap>& gaps) {
  const std::string part = path + ".part";
  try {
    rosbag::Bag output(part, rosbag::bagmode::Write);
    write(output, topics::tracker_markers, measured);
    write(output, topics::reality_gap, gaps);
    output.close();
    std::filesystem::rename(part, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw;
  }
}

void require_seen(const Findings& findings, const std::string& bag, const std::string& why) {
  if (findings.any_seen()) return;
  throw std::runtime_error(bag + ": none of its " + std::to_string(findings.seen().size()) + " markers was seen in " +
                           std::to_string(findings.measured().size()) + " times" + (why.empty() ? "" : ". " + why));
}

}  // namespace

ReplaySummary replay_tracking(const TrackingInputOptions& options, const std::string& bag_path,
                              const std::string& output_path) {
  if (is_same_file(bag_path, output_path))
    throw std::invalid_argument("output: " + output_path + " would be written over bag; give it a file of its own");
  set_outputs({{"output", output_path}});
  const rosbag::Bag bag = open_bag(bag_path);
  const double start_s = cpu_time_s();
  Findings findings;
  ReplaySummary summary;
  const auto steps = messages_of<TrackerUpdateLog>(bag, topics::tracker_steps);
  summary.repeated = !steps.empty();
  if (summary.repeated) {
    const RepeatedSteps done =
        repeat_steps(bag, steps, options, [&](const MarkerTracking::Result& result) { findings.add(result); });
    summary.without_images = done.without_images;
    summary.resumed = done.resumed;
    if (findings.measured().empty())
      throw std::runtime_error(bag_path + ": the recording lacks the images of all " + std::to_string(steps.size()) +
                               " steps of its tracker; record with record_images:=true");
    require_seen(findings, bag_path, "");
  } else {
    const AnewTracking anew(bag, options, findings);
    if (findings.measured().empty())
      throw std::runtime_error(bag_path + ": nothing of it could be tracked. " + anew.why_nothing());
    require_seen(findings, bag_path, anew.why_unseen());
    for (const auto& [camera, note] : anew.notes()) summary.notes.push_back(camera + ": " + note);
  }
  const std::vector<MarkerObservations>& measured = findings.measured();
  const auto gaps = gaps_between(measured, messages_of<MarkerObservations>(bag, topics::simulator_markers));
  write_output(output_path, measured, gaps);
  summary.written = static_cast<long>(measured.size());
  summary.seen = findings.seen();
  summary.cpu_s = cpu_time_s() - start_s;
  compare(messages_of<MarkerObservations>(bag, topics::tracker_markers), measured, summary.markers_alike,
          summary.markers_other);
  compare(messages_of<RealityGap>(bag, topics::reality_gap), gaps, summary.gaps_alike, summary.gaps_other);
  return summary;
}

}  // namespace soft_robot_lab
