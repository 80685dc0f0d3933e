// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace soft_robot_lab {

// The file was there to be written to, but its disk is full or broken.
class WriteError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Writes a file whole: first beside its place, then moved there, so that a full disk leaves the old one as it was.
// A device or a pipe is written to as it is. Throws WriteError, or std::runtime_error
// where it cannot be opened, with the name and the reason.
void write_file(const std::string& path, const std::string& text);

}  // namespace soft_robot_lab
