// SPDX-License-Identifier: BSD-3-Clause
// What the fuzzers' targets share: a rule that must hold, and bytes as a file that is read.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace soft_robot_lab {

using FuzzBytes = std::vector<std::uint8_t>;
using FuzzTarget = void (*)(const std::uint8_t* data, std::size_t size);

inline void require_rule(bool holds) {
  if (!holds) std::abort();
}

// In memory; gone with the object.
class FuzzFile {
 public:
  FuzzFile(const std::uint8_t* data, std::size_t size) : file_(memfd_create("fuzz", 0)) {
    require_rule(file_ >= 0 && write(file_, data, size) == static_cast<ssize_t>(size));
  }
  ~FuzzFile() { close(file_); }
  FuzzFile(const FuzzFile&) = delete;
  FuzzFile& operator=(const FuzzFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

// Every file of the folder, and `variants` copies of each with random changes. Gives the number of files.
inline int run_corpus(const std::string& folder, FuzzTarget target, int variants) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::mt19937_64 random(1);
  for (const std::string& name : files) {
    std::ifstream file(name, std::ios::binary);
    const FuzzBytes original{std::istreambuf_iterator<char>(file), {}};
    target(original.data(), original.size());
    for (int i = 0; i < variants && !original.empty(); ++i) {
      FuzzBytes bytes = original;
      for (int change = 0; change < 1 + i % 4; ++change) {
        const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size());
        if (random() % 4 == 0)
          bytes.insert(at, static_cast<std::uint8_t>(random()));
        else
          *at = static_cast<std::uint8_t>(random());
      }
      if (i % 7 == 0) bytes.resize(random() % bytes.size());
      target(bytes.data(), bytes.size());
    }
  }
  return static_cast<int>(files.size());
}

}  // namespace soft_robot_lab
