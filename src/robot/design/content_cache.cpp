// SPDX-License-Identifier: BSD-3-Clause
#include "content_cache.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "content_hash.h"
#include "settings/read_file.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

std::string checksum(const std::string& path) {
  ContentHash hash;
  hash.add(read_regular_file(path, kLargestMesh_bytes));
  return hash.hex();
}

std::string name_of(const std::string& key, const std::string& sum, const std::string& ending) {
  return key + "-" + sum + ending;
}

bool is_own_file(const fs::path& path) {
  struct stat status {};
  return lstat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid();
}

bool is_whole(const fs::path& path, const std::string& key, const std::string& ending) {
  try {
    return is_own_file(path) && path.filename() == name_of(key, checksum(path), ending);
  } catch (const std::invalid_argument&) {
    return false;
  }
}

constexpr mode_t kOwnersAlone = S_IRWXU;
constexpr const char* kWorkFolder = "work.";
constexpr std::chrono::minutes kYoung{1};  // may not be locked yet

int open_folder(const fs::path& path) { return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); }

// Its program holds its lock no more.
bool is_abandoned(const fs::path& path) {
  std::error_code gone;
  const fs::file_time_type changed = fs::last_write_time(path, gone);
  if (gone || changed > fs::file_time_type::clock::now() - kYoung) return false;
  const int folder = open_folder(path);
  if (folder < 0) return false;
  const bool free = flock(folder, LOCK_EX | LOCK_NB) == 0;
  close(folder);
  return free;
}

// Whatever the umask. Folders that are there keep their modes.
void make_private_folders(const fs::path& path) {
  if (path.empty() || fs::is_directory(path)) return;
  make_private_folders(path.parent_path());
  if (mkdir(path.c_str(), kOwnersAlone) == 0) chmod(path.c_str(), kOwnersAlone);
  if (!fs::is_directory(path)) throw std::runtime_error(path.string() + ": cannot be made: " + std::strerror(errno));
}

void remove_abandoned(const fs::path& beside) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(beside, ignored))
    if (entry.path().filename().string().rfind(kWorkFolder, 0) == 0 && is_abandoned(entry.path()))
      fs::remove_all(entry.path(), ignored);
}

}  // namespace

std::string ContentCache::find(const std::string& key, const std::string& ending) const {
  std::error_code none;
  std::vector<fs::path> candidates;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, none)) {
    const std::string name = entry.path().filename();
    const bool fits = name.size() == name_of(key, ContentHash().hex(), ending).size() &&
                      name.compare(0, key.size() + 1, key + "-") == 0 &&
                      name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
    if (fits) candidates.push_back(entry.path());
  }
  std::sort(candidates.begin(), candidates.end());
  for (const fs::path& path : candidates) {
    if (is_whole(path, key, ending)) return path;
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  return "";
}

std::string ContentCache::keep(const std::string& part, const std::string& key, const std::string& ending) const {
  const fs::path place = fs::path(folder_) / name_of(key, checksum(part), ending);
  fs::permissions(part, fs::perms::owner_read | fs::perms::owner_write);
  fs::rename(part, place);
  return place;
}

WorkFolder::WorkFolder(const std::string& beside) : path_(beside + "/" + kWorkFolder + "XXXXXX") {
  make_private_folders(beside);
  remove_abandoned(beside);
  if (mkdtemp(path_.data()) == nullptr)
    throw std::runtime_error(beside + ": cannot be written to: " + std::strerror(errno));
  chmod(path_.c_str(), kOwnersAlone);
  lock_ = open_folder(path_);
  if (lock_ >= 0) flock(lock_, LOCK_EX);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) close(lock_);
}

void require_private_folder(const std::string& folder) {
  make_private_folders(folder);
  struct stat status {};
  const bool own = lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid() &&
                   (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  if (!own)
    throw std::runtime_error(folder + ": others may write there; set HOME or XDG_CACHE_HOME to a folder of your own");
}

}  // namespace soft_robot_lab
