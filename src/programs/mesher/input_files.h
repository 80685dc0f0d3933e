// SPDX-License-Identifier: BSD-3-Clause
// The files that a request names, for Gmsh to read: checked copies with endings of our own, in a folder of our own.
// Beside a user's file may lie others that Gmsh would read as scripts (NAME.msh.opt), and its name may mean more to
// Gmsh than its ending (NAME.stl.gz is unpacked by a program).
#pragma once

#include <map>
#include <string>

#include "robot/design/mesh_formats.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

class InputFiles {
 public:
  // The copies' folder is made beside a file that will be written, and goes with this object.
  explicit InputFiles(const std::string& output_file);
  ~InputFiles();
  InputFiles(const InputFiles&) = delete;
  InputFiles& operator=(const InputFiles&) = delete;

  // The path of the copy. Throws std::invalid_argument with the file's name where it is not of that format.
  std::string copy(const std::string& file, MeshFormat format);
  // The same for all that a solid is read from, which then names the copies.
  void copy_into(Solid& solid);
  // What was said of the copies, said of the files.
  std::string in_users_names(std::string message) const;

 private:
  std::string folder_;
  std::map<std::string, std::string> file_of_;  // by copy
};

}  // namespace soft_robot_lab
