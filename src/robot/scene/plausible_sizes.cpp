// SPDX-License-Identifier: BSD-3-Clause
#include "plausible_sizes.h"

#include <sstream>

namespace soft_robot_lab {
namespace {

constexpr double kShortest_m = 1e-3, kLongest_m = 2.0;  // of a body, along its longest axis
constexpr double kSoftest_pa = 1e3;                     // a tenth of the softest silicone that is cast
constexpr double kLongestStalk = 1.0;                   // times the body's size

SolveWarning about(const std::string& kind, double size, const std::string& unit, const std::ostringstream& text) {
  SolveWarning warning;
  warning.kind = kind;
  warning.size = size;
  warning.unit = unit;
  warning.text = text.str();
  return warning;
}

void check_body(const Body& body, std::vector<SolveWarning>& warnings) {
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  const double length_m = (nodes_m.rowwise().maxCoeff() - nodes_m.rowwise().minCoeff()).maxCoeff();
  if (length_m >= kShortest_m && length_m <= kLongest_m) return;
  std::ostringstream text;
  text << "the body is " << length_m << " m long, where robots are " << kShortest_m << " to " << kLongest_m
       << " m: lengths are metres; if its file has millimetres, set `scale: 0.001` beside it";
  warnings.push_back(about("implausible_size", length_m, "m", text));
}

void check_modulus(const Body& body, std::vector<SolveWarning>& warnings) {
  const double modulus_pa = body.material().youngs_modulus_pa;
  if (modulus_pa >= kSoftest_pa) return;
  std::ostringstream text;
  text << "Young's modulus is " << modulus_pa << " Pa, where silicones have " << kSoftest_pa
       << " Pa and more: if youngs_modulus_pa was given in MPa, multiply it by 1e6";
  warnings.push_back(about("implausible_stiffness", modulus_pa, "Pa", text));
}

void check_stalk(const Marker& marker, const Body& body, const MeshLocator& locator,
                 std::vector<SolveWarning>& warnings) {
  const double stalk_m = locator.locate(marker.rest_position_m()).distance_m;
  if (stalk_m <= kLongestStalk * body.size_m()) return;
  std::ostringstream text;
  text << "marker " << marker.name() << " is " << stalk_m << " m off the body, which is " << body.size_m()
       << " m large: its position_m is in metres, and turns with the skin on a stalk of that length";
  add_warning(about("implausible_stalk", stalk_m, "m", text), warnings);
}

}  // namespace

std::vector<SolveWarning> implausible_sizes(const Body& body, const MeshLocator& locator,
                                            const std::vector<Marker>& markers) {
  std::vector<SolveWarning> warnings;
  check_body(body, warnings);
  check_modulus(body, warnings);
  for (const Marker& marker : markers) check_stalk(marker, body, locator, warnings);
  return warnings;
}

}  // namespace soft_robot_lab
