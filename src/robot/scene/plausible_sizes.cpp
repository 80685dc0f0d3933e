// SPDX-License-Identifier: BSD-3-Clause
#include "plausible_sizes.h"

#include <optional>
#include <sstream>

#include "scene_warning.h"
#include "sections.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr double kShortest_m = 1e-3, kLongest_m = 2.0;  // of a body, along its longest axis
constexpr double kSoftest_pa = 1e3;                     // a tenth of the softest silicone that is cast
constexpr double kMostMegapascals = 20.0;               // of what is cast; a larger number was rather meant in kPa
constexpr double kLongestStalk = 1.0;                   // times the body's size
constexpr double kLargestGravity_m_s2 = 50.0;           // five times the earth's
constexpr double kEarth_m_s2 = 9.81;

// Where millimetres become metres: a file has a key for it, a solid has a shape.
std::string way_to_metres(const YamlNode& section) {
  return is_of_file(section)
             ? "if its file has millimetres, set `scale: 0.001` beside it"
             : "if its solid has millimetres, write metres, or put it into `scale: {factor: 0.001, solid: ...}`";
}

void check_body(const YamlNode& scene, const Body& body, std::vector<SolveWarning>& warnings) {
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  const double length_m = (nodes_m.rowwise().maxCoeff() - nodes_m.rowwise().minCoeff()).maxCoeff();
  if (length_m >= kShortest_m && length_m <= kLongest_m) return;
  std::ostringstream text;
  text << "the body is " << length_m << " m long, where robots are " << kShortest_m << " to " << kLongest_m
       << " m: lengths are metres; " << way_to_metres(body_sections(scene).front());
  warnings.push_back(scene_warning("implausible_size", text.str(), length_m, "m"));
}

void check_material(const YamlNode& node, std::vector<SolveWarning>& warnings) {
  const double modulus_pa = read_material(node).youngs_modulus_pa;
  const std::optional<YamlNode> stated = stated_modulus(node);
  if (modulus_pa >= kSoftest_pa || !stated) return;
  const std::string path = stated->path(), key = path.substr(path.rfind('.') + 1);
  const bool megapascals = modulus_pa < kMostMegapascals;
  std::ostringstream text;
  text << "Young's modulus is " << modulus_pa << " Pa, where silicones have " << kSoftest_pa << " Pa and more: if "
       << key << " was given in " << (megapascals ? "MPa, multiply it by 1e6" : "kPa, multiply it by 1000")
       << ": did you mean " << path << ": " << format_number((megapascals ? 1e6 : 1e3) * stated->as_number())
       << "? A `stiffness_ratio` beside it says that it is meant";
  warnings.push_back(scene_warning("implausible_stiffness", text.str(), modulus_pa, "Pa"));
}

void check_gravity(const Body& body, std::vector<SolveWarning>& warnings) {
  const double gravity_m_s2 = body.gravity_m_s2().norm();
  if (gravity_m_s2 <= kLargestGravity_m_s2) return;
  std::ostringstream text;
  text << "gravity_m_s2 is " << gravity_m_s2 << " m/s2 long, " << gravity_m_s2 / kEarth_m_s2
       << " times the earth's: it is in metres; did you mean [0, 0, -9.81]?";
  warnings.push_back(scene_warning("implausible_gravity", text.str(), gravity_m_s2, "m/s2"));
}

void check_stalk(const Marker& marker, const Body& body, const MeshLocator& locator,
                 std::vector<SolveWarning>& warnings) {
  const double stalk_m = locator.locate(marker.rest_position_m()).distance_m;
  if (stalk_m <= kLongestStalk * body.size_m()) return;
  std::ostringstream text;
  text << "marker " << marker.name() << " is " << stalk_m << " m off the body, which is " << body.size_m()
       << " m large: its position_m is in metres, and turns with the skin on a stalk of that length";
  add_warning(scene_warning("implausible_stalk", text.str(), stalk_m, "m"), warnings);
}

}  // namespace

std::vector<SolveWarning> implausible_sizes(const YamlNode& scene, const Body& body, const MeshLocator& locator,
                                            const std::vector<Marker>& markers) {
  std::vector<SolveWarning> warnings;
  check_body(scene, body, warnings);
  for (const YamlNode& section : body_sections(scene))
    for (const YamlNode& material : materials_of(section)) check_material(material, warnings);
  check_gravity(body, warnings);
  for (const Marker& marker : markers) check_stalk(marker, body, locator, warnings);
  return warnings;
}

}  // namespace soft_robot_lab
