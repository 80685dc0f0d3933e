// SPDX-License-Identifier: BSD-3-Clause
// Judges from what is seen of a session's nodes and of its recording, once a second, whether they do their work. Times
// are the machine's, which no clock that is set changes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <sys/types.h>

namespace soft_robot_lab {

struct Finding {
  enum class Level { ok, warning, error };
  Level level = Level::ok;
  std::string text;
};

// A moment, as the machine counts it and as people read it.
struct Moment {
  double time_s = 0.0;
  std::string clock;
};

// Whether a node runs, and since when not.
class NodeWatch {
 public:
  explicit NodeWatch(std::string name) : name_(std::move(name)) {}

  static constexpr double longest_start_s = 30.0;

  // `process` of the node; none where none answers.
  Finding update(const Moment& now, std::optional<pid_t> process);
  const std::string& name() const { return name_; }
  int restarts() const { return restarts_; }
  const std::string& last_restart() const { return last_restart_; }  // empty: none

 private:
  std::string name_;
  std::optional<pid_t> process_;  // the last
  std::optional<Moment> gone_;
  int restarts_ = 0;
  std::string last_restart_;
};

// What the recorder writes to, and how much more it can.
struct BagSight {
  std::string path;  // empty: to nothing
  std::uintmax_t bytes = 0;
  std::optional<std::uintmax_t> free_bytes;  // of the disk
};

// The bag that a process of this machine writes, and the space in `folder`, where there is no bag yet.
BagSight look_at_bag(std::optional<pid_t> process, const std::string& folder);

// Where no bag can be written into the folder, or one is written elsewhere; nothing wrong where the folder can still be
// made.
Finding place_of(const BagSight& bag, const std::string& folder);

// rosbag stays alive but stops recording where less than `least_free_bytes` are free, and goes on when there are more.
class BagWatch {
 public:
  static constexpr std::uintmax_t least_free_bytes = std::uintmax_t{1} << 30;
  static constexpr std::uintmax_t low_bytes = 5 * least_free_bytes;  // rosbag warns from here on too
  static constexpr double longest_silence_s = 20.0;                  // a bag is written in blocks

  Finding update(const Moment& now, const BagSight& bag);

 private:
  std::string path_;
  std::uintmax_t bytes_ = 0;
  std::optional<Moment> grown_;  // when it last did
};

// The worse of two; of two that are as bad, both.
Finding worst_of(const Finding& a, const Finding& b);

}  // namespace soft_robot_lab
