// SPDX-License-Identifier: BSD-3-Clause
// A program writes over no file that it reads because the command line or a settings file names it.
#pragma once

#include <string>
#include <vector>

namespace soft_robot_lab {

// As files are written: folders on the way need not be there, where `..` leads out of them again. A device is never
// the same, as /dev/null may be named twice.
bool is_same_file(const std::string& one, const std::string& other);

struct OutputName {
  std::string option, file;
};

// What this process was asked to write. Until then, as in nodes, which write what they read, nothing below refuses.
void set_outputs(std::vector<OutputName> outputs);
// The option that asks for this file to be written, or nothing.
std::string output_over(const std::string& file);

// From now on write_file refuses this file, as one of a folder of results.
void keep_file(const std::string& file);
bool is_kept(const std::string& file);

}  // namespace soft_robot_lab
