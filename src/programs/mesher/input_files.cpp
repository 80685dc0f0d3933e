// SPDX-License-Identifier: BSD-3-Clause
#include "input_files.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "settings/read_file.h"
#include "settings/write_file.h"

namespace soft_robot_lab {

namespace fs = std::filesystem;

InputFiles::InputFiles(const std::string& output_file)
    : folder_(fs::absolute(output_file).parent_path() / "mesher.XXXXXX") {
  if (mkdtemp(folder_.data()) == nullptr)
    throw std::runtime_error(output_file + ": cannot be written: " + std::strerror(errno));
}

InputFiles::~InputFiles() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::string InputFiles::copy(const std::string& file, MeshFormat format) {
  if (!has_ending_of(file, format)) throw std::invalid_argument(file + ": its name must end with " + ending_of(format));
  const std::string ending = ending_of(format == MeshFormat::obj ? MeshFormat::stl : format);  // of what Gmsh reads
  const std::string copied = folder_ + "/input_" + std::to_string(file_of_.size()) + ending;
  const std::string bytes = read_regular_file(file, kLargestMesh_bytes);
  try {
    write_file(copied, safe_content(bytes, format));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(file + ": " + error.what());
  }
  file_of_[copied] = file;
  return copied;
}

void InputFiles::copy_into(Solid& solid) {
  if (solid.kind == Solid::Kind::stl_file)
    solid.file = copy(solid.file, has_ending_of(solid.file, MeshFormat::obj) ? MeshFormat::obj : MeshFormat::stl);
  if (solid.kind == Solid::Kind::step_file) solid.file = copy(solid.file, MeshFormat::step);
  for (Solid& part : solid.parts) copy_into(part);
}

std::string InputFiles::in_users_names(std::string message) const {
  for (const auto& [copied, file] : file_of_)
    for (std::size_t at = message.find(copied); at != std::string::npos; at = message.find(copied, at + file.size()))
      message.replace(at, copied.size(), file);
  return message;
}

}  // namespace soft_robot_lab
