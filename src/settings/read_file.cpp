// SPDX-License-Identifier: BSD-3-Clause
#include "read_file.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw std::invalid_argument((path.empty() ? "''" : path) + ": cannot be read: " + reason);
}

// Opened without waiting for a pipe's other end, and then checked, so that nobody can put another file in its place.
class RegularFile {
 public:
  RegularFile(const std::string& path, std::uintmax_t largest_bytes)
      : path_(path), file_(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (file_ < 0) refuse(path, std::strerror(errno));
    try {
      check(largest_bytes);
    } catch (...) {
      close(file_);
      throw;
    }
  }
  ~RegularFile() { close(file_); }
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  std::string read() const {
    std::string text(size_, '\0');
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t count = ::read(file_, text.data() + done, text.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) refuse(path_, std::strerror(errno));
      if (count == 0) break;  // it was cut meanwhile
      done += static_cast<std::size_t>(count);
    }
    text.resize(done);
    return text;
  }

 private:
  void check(std::uintmax_t largest_bytes) {
    struct stat status {};
    if (fstat(file_, &status) != 0) refuse(path_, std::strerror(errno));
    if (S_ISDIR(status.st_mode)) refuse(path_, "it is a folder");
    if (!S_ISREG(status.st_mode)) refuse(path_, "it is no regular file");
    const auto bytes = static_cast<std::uintmax_t>(status.st_size);
    if (bytes > largest_bytes)
      refuse(path_, std::to_string(bytes) + " bytes are out of range [0, " + std::to_string(largest_bytes) + "]");
    size_ = bytes;
  }

  std::string path_;
  int file_;
  std::size_t size_ = 0;
};

}  // namespace

std::string read_regular_file(const std::string& path, std::uintmax_t largest_bytes) {
  return RegularFile(path, largest_bytes).read();
}

void require_regular_file(const std::string& path, std::uintmax_t largest_bytes) { RegularFile(path, largest_bytes); }

}  // namespace soft_robot_lab
