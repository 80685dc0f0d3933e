// SPDX-License-Identifier: BSD-3-Clause
#include "stl_file.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace soft_robot_lab {
namespace {

template <typename Value>
void append(std::string& bytes, const Value& value) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), &value, sizeof(Value));
  bytes.append(raw.data(), raw.size());
}

}  // namespace

// Little-endian, as all machines that this package knows.
std::string binary_stl(const Surface& surface, const std::string& title) {
  std::string bytes = title;
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(surface.triangle_count()));
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int i = 0; i < 3; ++i) append(bytes, static_cast<float>(surface.normals(i, t)));
    for (int corner = 0; corner < 3; ++corner)
      for (int i = 0; i < 3; ++i) append(bytes, static_cast<float>(1000 * surface.corner(t, corner)[i]));
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

}  // namespace soft_robot_lab
