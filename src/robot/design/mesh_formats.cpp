// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_formats.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "plain_obj.h"
#include "plain_stl.h"

namespace soft_robot_lab {
namespace {

constexpr std::array<std::pair<const char*, MeshFormat>, 6> kEndings{{{".msh", MeshFormat::msh},
                                                                      {".vtk", MeshFormat::vtk},
                                                                      {".stl", MeshFormat::stl},
                                                                      {".obj", MeshFormat::obj},
                                                                      {".step", MeshFormat::step},
                                                                      {".stp", MeshFormat::step}}};

const std::string kByteOrderMark = "\xef\xbb\xbf";  // which office programs set before UTF-8

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

void require_start(const std::string& bytes, const std::vector<std::string>& starts, const std::string& what) {
  for (const std::string& start : starts)
    if (bytes.compare(0, start.size(), start) == 0) return;
  const std::string is = bytes.compare(0, 5, "<?xml") == 0 || bytes.compare(0, 8, "<VTKFile") == 0 ? "is XML, " : "is ";
  throw std::invalid_argument(is + "no " + what + " file: it must start with " + starts.front());
}

}  // namespace

bool has_ending_of(const std::string& file, MeshFormat format) {
  const std::string ending = lower(std::filesystem::path(file).extension());
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](const auto& known) { return known.first == ending && known.second == format; });
}

std::string ending_of(MeshFormat format) {
  const auto named = std::find_if(kEndings.begin(), kEndings.end(), [&](const auto& e) { return e.second == format; });
  return named->first;
}

std::string safe_content(std::string bytes, MeshFormat format) {
  if (bytes.compare(0, kByteOrderMark.size(), kByteOrderMark) == 0) bytes.erase(0, kByteOrderMark.size());
  switch (format) {
    case MeshFormat::msh:
      require_start(bytes, {"$MeshFormat", "$NOD", "$Comments"}, "MSH");
      break;
    case MeshFormat::vtk:
      require_start(bytes, {"# vtk DataFile"}, "legacy VTK");
      break;
    case MeshFormat::step:
      require_start(bytes.substr(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size())), {"ISO-10303-21"}, "STEP");
      break;
    case MeshFormat::stl:
      return plain_stl(bytes);
    case MeshFormat::obj:
      return plain_obj(bytes);
  }
  return bytes;
}

}  // namespace soft_robot_lab
