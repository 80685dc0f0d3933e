// SPDX-License-Identifier: BSD-3-Clause
#include "session_watch.h"

#include <cstdio>
#include <filesystem>
#include <system_error>

#include <unistd.h>

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

// Also one that is not closed yet.
bool is_bag(const fs::path& file) {
  return file.extension() == ".bag" || (file.extension() == ".active" && file.stem().extension() == ".bag");
}

std::string open_bag(pid_t process) {
  std::error_code error;
  for (const auto& file : fs::directory_iterator("/proc/" + std::to_string(process) + "/fd", error)) {
    const std::string path = fs::read_symlink(file.path(), error).string();
    if (!error && is_bag(path)) return path;
  }
  return {};
}

std::string megabytes(std::uintmax_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f MB", static_cast<double>(bytes) / 1048576.0);
  return text;
}

}  // namespace

Finding NodeWatch::update(const Moment& now, std::optional<pid_t> process) {
  if (!process) {
    if (!gone_) gone_ = now;
    if (!process_ && now.time_s - gone_->time_s >= longest_start_s)
      return {Finding::Level::error, name_ + ": does not start; the session's log says why"};
    if (!process_) return {Finding::Level::warning, name_ + ": not started yet"};
    return {Finding::Level::error, name_ + ": not running since " + gone_->clock};
  }
  if (process_ && *process_ != *process) {
    ++restarts_;
    last_restart_ = now.clock;
  }
  process_ = process;
  gone_.reset();
  return {Finding::Level::ok, name_ + " runs"};
}

BagSight look_at_bag(std::optional<pid_t> process, const std::string& folder) {
  BagSight bag;
  if (process) bag.path = open_bag(*process);
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(bag.path, error);
  if (!error) bag.bytes = bytes;
  const fs::space_info space = fs::space(bag.path.empty() ? fs::path(folder) : fs::path(bag.path).parent_path(), error);
  if (!error) bag.free_bytes = space.available;
  return bag;
}

Finding place_of(const BagSight& bag, const std::string& folder) {
  std::error_code error;
  if (!bag.path.empty() && !fs::equivalent(fs::path(bag.path).parent_path(), folder, error))
    return {Finding::Level::error, "recording: it goes into " + bag.path + ", not into " + folder};
  fs::path there = fs::absolute(folder, error);
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  if (fs::is_directory(there, error) && access(there.c_str(), W_OK | X_OK) == 0) return {};
  return {Finding::Level::error, "recording: bag_folder " + folder + " cannot be written into"};
}

Finding BagWatch::update(const Moment& now, const BagSight& bag) {
  if (!grown_ || bag.path != path_ || bag.bytes != bytes_) grown_ = now;
  path_ = bag.path;
  bytes_ = bag.bytes;
  if (bag.free_bytes && *bag.free_bytes < least_free_bytes)
    return {Finding::Level::error, "recording: the disk is full: " + megabytes(*bag.free_bytes) + " are free, below " +
                                       megabytes(least_free_bytes) + " nothing is recorded"};
  if (now.time_s - grown_->time_s >= longest_silence_s)
    return {Finding::Level::error, "recording: nothing was written since " + grown_->clock};
  if (bag.free_bytes && *bag.free_bytes < low_bytes)
    return {Finding::Level::warning, "recording: the disk is nearly full: " + megabytes(*bag.free_bytes) +
                                         " are free, below " + megabytes(least_free_bytes) + " nothing is recorded"};
  return {Finding::Level::ok, "recording grows"};
}

Finding worst_of(const Finding& a, const Finding& b) {
  if (a.level != b.level) return a.level > b.level ? a : b;
  return {a.level, a.text.empty() ? b.text : b.text.empty() ? a.text : a.text + "; " + b.text};
}

}  // namespace soft_robot_lab
