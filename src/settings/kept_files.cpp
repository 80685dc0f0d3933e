// SPDX-License-Identifier: BSD-3-Clause
#include "kept_files.h"

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

struct KeptFiles {
  std::mutex mutex;
  std::optional<std::vector<OutputName>> outputs;
  std::set<std::string> kept;  // without links
};

KeptFiles& kept_files() {
  static KeptFiles files;
  return files;
}

std::string without_links(const std::string& file) {
  std::error_code ignored;
  return fs::weakly_canonical(file, ignored).string();
}

}  // namespace

bool is_same_file(const std::string& one, const std::string& other) {
  std::error_code ignored;
  const fs::path first = without_links(one), second = without_links(other);
  if (fs::exists(first, ignored) && fs::exists(second, ignored))
    return fs::equivalent(first, second, ignored) && !fs::is_other(first, ignored);
  return first == second;
}

void set_outputs(std::vector<OutputName> outputs) {
  KeptFiles& files = kept_files();
  const std::lock_guard<std::mutex> lock(files.mutex);
  files.outputs = std::move(outputs);
  files.kept.clear();
}

std::string output_over(const std::string& file) {
  KeptFiles& files = kept_files();
  const std::lock_guard<std::mutex> lock(files.mutex);
  if (files.outputs)
    for (const OutputName& output : *files.outputs)
      if (is_same_file(output.file, file)) return output.option;
  return "";
}

void keep_file(const std::string& file) {
  KeptFiles& files = kept_files();
  const std::lock_guard<std::mutex> lock(files.mutex);
  if (files.outputs) files.kept.insert(without_links(file));
}

bool is_kept(const std::string& file) {
  KeptFiles& files = kept_files();
  const std::lock_guard<std::mutex> lock(files.mutex);
  return !files.kept.empty() && files.kept.count(without_links(file)) > 0;
}

}  // namespace soft_robot_lab
