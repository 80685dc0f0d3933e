// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <unistd.h>

#include "soft_robot_lab/control/identification/fit_model.h"
#include "robot/scene/sections.h"
#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFirstLine = "# Fitted to measured markers.";

std::string as_comment(const std::string& text) {
  std::string comment;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) comment += "# " + line + "\n";
  return comment;
}

// From the folder of `file`, so that both may move together.
std::string path_from(const std::string& file, const std::string& scene) {
  const fs::path folder = fs::weakly_canonical(fs::absolute(file)).parent_path();
  return fs::weakly_canonical(fs::absolute(scene)).lexically_relative(folder).string();
}

}  // namespace

void require_writable(const std::string& file) {
  const fs::path path = fs::absolute(file);
  const fs::path checked = fs::exists(path) ? path : path.parent_path();
  if (file.empty() || fs::is_directory(path) || access(checked.c_str(), W_OK) != 0)
    throw std::invalid_argument("file: '" + file +
                                "' cannot be written; allowed: a file in a folder that exists and may be written to");
}

void require_not_read(const std::string& file, const std::string& scene) {
  for (const std::string& read : files_of_scene(scene))
    if (read == fs::weakly_canonical(file))
      throw std::invalid_argument("file: '" + file + "' is read for the scene " + scene +
                                  ", and would include itself; name another");
}

void require_own_or_new(const std::string& file) {
  const fs::file_status status = fs::symlink_status(fs::absolute(file));
  if (!fs::exists(status)) return;
  std::string first;
  if (fs::is_regular_file(status)) std::getline(std::ifstream(file), first);
  if (first != kFirstLine)
    throw std::invalid_argument("file: '" + file +
                                "' exists, and no fit wrote it; name another, or remove it where it is not needed");
}

void write_fitted_scene(const FitResult& result, const std::string& scene, const std::string& file) {
  std::ostringstream out;
  out << kFirstLine << "\n" << as_comment(summary(result));
  const Eigen::Vector3d& t = result.measured_from_base.translation();
  const Eigen::Quaterniond q(result.measured_from_base.linear());
  out << "# Where the cameras believe robot_base to be: " << t.x() << " " << t.y() << " " << t.z() << " m, quaternion "
      << q.x() << " " << q.y() << " " << q.z() << " " << q.w() << " (x y z w); a scene does not hold it.\n";
  for (const auto& [cable, backlash_m] : result.backlash_m)
    out << "# Backlash of " << cable << "'s drive: " << backlash_m
        << " m; by its step_m it is the motor's backlash_steps, and a scene does not hold it.\n";
  out << "include: " << quote(path_from(file, scene)) << "\n" << result.overrides.text();
  write_file(file, out.str());
}

}  // namespace soft_robot_lab
