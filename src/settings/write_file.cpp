// SPDX-License-Identifier: BSD-3-Clause
#include "write_file.h"

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kept_files.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

std::string reason(const std::string& path, int error) { return path + ": cannot be written: " + std::strerror(error); }
[[noreturn]] void refuse(const std::string& path, int error) { throw std::runtime_error(reason(path, error)); }
[[noreturn]] void fail(const std::string& path, int error) { throw WriteError(reason(path, error)); }

// 0, or why not.
int write_all(int file, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = write(file, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) return errno;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return 0;
}

// Some disks are found full only here.
int write_and_close(int file, const std::string& text) {
  const int error = write_all(file, text);
  const int at_end = close(file) == 0 ? 0 : errno;
  return error != 0 ? error : at_end;
}

// A pipe that nobody reads is not waited for: no signal would end that.
void write_in_place(const std::string& path, const std::string& text) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK, 0666);
  if (file < 0 && errno == ENXIO) throw std::runtime_error(path + ": cannot be written: nobody reads this pipe");
  if (file < 0) refuse(path, errno);
  fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
  if (const int error = write_and_close(file, text); error != 0) fail(path, error);
}

// Where the path leads through links; the file itself need not be there.
fs::path place_of(const std::string& path) {
  std::error_code ignored;
  const fs::path place = fs::weakly_canonical(path, ignored);
  return place.empty() ? fs::path(path) : place;
}

// A new file beside the place, with a name that nobody can lay a link under beforehand; -1 where there can be none.
int open_part(const fs::path& place, std::string& part) {
  constexpr int tries = 100;
  for (int i = 0; i < tries; ++i) {
    std::uint64_t random = 0;
    if (getrandom(&random, sizeof random, 0) != sizeof random) return -1;
    part = place.string() + "." + std::to_string(random) + ".part";
    const int file = open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

}  // namespace

void write_file(const std::string& path, const std::string& text) {
  if (is_kept(path))
    throw std::runtime_error(path + ": would be written over, though it was read; give the result another place");
  struct stat old {};
  const bool exists = stat(path.c_str(), &old) == 0;
  if (exists && !S_ISREG(old.st_mode)) return write_in_place(path, text);
  if (exists && access(path.c_str(), W_OK) != 0) refuse(path, errno);
  const fs::path place = place_of(path);
  std::string part;
  const int file = open_part(place, part);
  if (file < 0 && exists) return write_in_place(path, text);  // a file that may be written to, in a folder that may not
  if (file < 0) refuse(path, errno);
  if (exists) fchmod(file, old.st_mode & 07777);
  int error = write_and_close(file, text);
  if (error == 0 && std::rename(part.c_str(), place.c_str()) != 0) error = errno;
  if (error == 0) return;
  unlink(part.c_str());
  fail(path, error);
}

}  // namespace soft_robot_lab
