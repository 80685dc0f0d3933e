#pragma once

#include <string>

namespace soft_robot_lab {

// Writes a file whole: first beside its place, then moved there, so that a full disk leaves the old one as it was.
// A device or a pipe is written to as it is. Throws std::runtime_error with the name and the reason.
void write_file(const std::string& path, const std::string& text);

}  // namespace soft_robot_lab
