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
#include "settings/write_file.h"

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

// Whatever the umask. Folders that are there keep their modes. 0, or why there is none.
int make_private_folders(const fs::path& path) {
  std::error_code ignored;
  if (path.empty() || fs::is_directory(path, ignored)) return 0;
  if (const int error = make_private_folders(path.parent_path()); error != 0) return error;
  if (mkdir(path.c_str(), kOwnersAlone) == 0) return chmod(path.c_str(), kOwnersAlone) == 0 ? 0 : errno;
  const int error = errno;
  return fs::is_directory(path, ignored) ? 0 : error;
}

[[noreturn]] void refuse_folder(const std::string& folder, const std::string& why) {
  throw std::runtime_error(folder + ": " + why + "; set HOME or XDG_CACHE_HOME to a folder of your own");
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

void ContentCache::keep_text(const std::string& text, const std::string& key, const std::string& ending) const {
  try {
    const WorkFolder work(folder_);
    const std::string part = work.file("text");
    write_file(part, text);
    keep(part, key, ending);
  } catch (const std::runtime_error&) {
    return;
  }
}

WorkFolder::WorkFolder(const std::string& beside) : path_(beside + "/" + kWorkFolder + "XXXXXX") {
  if (const int error = make_private_folders(beside); error != 0)
    refuse_folder(beside, std::string("cannot be made: ") + std::strerror(error));
  remove_abandoned(beside);
  if (mkdtemp(path_.data()) == nullptr)
    refuse_folder(beside, std::string("cannot be written to: ") + std::strerror(errno));
  chmod(path_.c_str(), kOwnersAlone);
  lock_ = open_folder(path_);
  if (lock_ >= 0) flock(lock_, LOCK_EX);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) close(lock_);
}

bool can_be_private(const std::string& folder) {
  return make_private_folders(folder) == 0 && access(folder.c_str(), R_OK | W_OK | X_OK) == 0;
}

void require_private_folder(const std::string& folder) {
  if (const int error = make_private_folders(folder); error != 0)
    refuse_folder(folder, std::string("cannot be made: ") + std::strerror(error));
  struct stat status {};
  const bool own = lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid() &&
                   (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  if (!own) refuse_folder(folder, "others may write there");
}

}  // namespace soft_robot_lab
