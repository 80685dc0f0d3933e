// SPDX-License-Identifier: BSD-3-Clause
#include "plausible_sizes.h"

#include <algorithm>
#include <cmath>
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
constexpr double kLightest_kg_m3 = 20.0, kHeaviest_kg_m3 = 25e3;  // a light foam, and platinum
constexpr double kLongestStalk = 1.0;                             // times the body's size
constexpr double kLargestGravity_m_s2 = 50.0;                     // five times the earth's
constexpr double kEarth_m_s2 = 9.81;
constexpr double kLargestStrain = 2.0;  // by what the file loads a body with

// Where millimetres become metres: a file has a key for it, a solid has a shape.
std::string way_to_metres(const YamlNode& section) {
  return is_of_file(section)
             ? "if its file has millimetres, set `scale: 0.001` beside it"
             : "if its solid has millimetres, write metres, or put it into `scale: {factor: 0.001, solid: ...}`";
}

std::optional<SolveWarning> odd_body(const YamlNode& scene, const Body& body) {
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  const double length_m = (nodes_m.rowwise().maxCoeff() - nodes_m.rowwise().minCoeff()).maxCoeff();
  if (length_m >= kShortest_m && length_m <= kLongest_m) return std::nullopt;
  std::ostringstream text;
  text << "the body is " << length_m << " m long, where robots are " << kShortest_m << " to " << kLongest_m
       << " m: lengths are metres; " << way_to_metres(body_sections(scene).front());
  return scene_warning("implausible_size", text.str(), length_m, "m");
}

std::optional<SolveWarning> odd_material(const YamlNode& node) {
  const double modulus_pa = read_material(node).youngs_modulus_pa;
  const std::optional<YamlNode> stated = stated_modulus(node);
  if (modulus_pa >= kSoftest_pa || !stated) return std::nullopt;
  const std::string path = stated->path(), key = path.substr(path.rfind('.') + 1);
  const bool megapascals = modulus_pa < kMostMegapascals;
  std::ostringstream text;
  text << "Young's modulus is " << modulus_pa << " Pa, where silicones have " << kSoftest_pa << " Pa and more: if "
       << key << " was given in " << (megapascals ? "MPa, multiply it by 1e6" : "kPa, multiply it by 1000")
       << ": did you mean " << path << ": " << format_number((megapascals ? 1e6 : 1e3) * stated->as_number())
       << "? A `stiffness_ratio` beside it says that it is meant";
  return scene_warning("implausible_stiffness", text.str(), modulus_pa, "Pa");
}

std::optional<SolveWarning> odd_density(const YamlNode& node) {
  const double density_kg_m3 = read_material(node).density_kg_m3;
  const bool light = density_kg_m3 < kLightest_kg_m3;
  if ((!light && density_kg_m3 <= kHeaviest_kg_m3) || !node.has("density_kg_m3")) return std::nullopt;
  const YamlNode stated = node.child("density_kg_m3");
  std::ostringstream text;
  text << "density_kg_m3 is " << density_kg_m3 << ", where silicones have 900 to 1500 kg/m3: if it was given in "
       << (light ? "g/cm3, multiply it by 1000" : "g/m3, divide it by 1000") << ": did you mean " << stated.path()
       << ": " << format_number((light ? 1e3 : 1e-3) * density_kg_m3) << "?";
  return scene_warning("implausible_density", text.str(), density_kg_m3, "kg/m3");
}

std::optional<SolveWarning> odd_gravity(const Body& body) {
  const double gravity_m_s2 = body.gravity_m_s2().norm();
  if (gravity_m_s2 <= kLargestGravity_m_s2) return std::nullopt;
  std::ostringstream text;
  text << "gravity_m_s2 is " << gravity_m_s2 << " m/s2 long, " << gravity_m_s2 / kEarth_m_s2
       << " times the earth's: it is in metres; did you mean [0, 0, -9.81]?";
  return scene_warning("implausible_gravity", text.str(), gravity_m_s2, "m/s2");
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

void add(const std::optional<SolveWarning>& warning, std::vector<SolveWarning>& warnings) {
  if (warning) warnings.push_back(*warning);
}

// Of a column of the material, as high as the body.
double weight_pa(const Material& material, const Body& body) {
  const double gravity_m_s2 = body.gravity_m_s2().norm();
  if (gravity_m_s2 == 0.0) return 0.0;
  const Eigen::RowVectorXd heights_m = (body.gravity_m_s2() / gravity_m_s2).transpose() * body.mesh().nodes_m;
  return material.density_kg_m3 * gravity_m_s2 * (heights_m.maxCoeff() - heights_m.minCoeff());
}

// The largest side of the box around the body: no section through it is much larger.
double largest_side_m2(const Body& body) {
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  const Eigen::Vector3d size_m = nodes_m.rowwise().maxCoeff() - nodes_m.rowwise().minCoeff();
  return size_m.prod() / size_m.minCoeff();
}

// What the run commands in Pa, and in N.
double commanded_pa(const Simulation& simulation, const RunSettings& run) {
  double most_pa = 0.0;
  for (const TimedCommands& timed : run.commands)
    for (const auto& [name, value] : timed.commands) {
      const std::string unit = simulation.actuators()[simulation.actuator_index(name)]->limits().unit;
      if (unit == "Pa") most_pa = std::max(most_pa, std::abs(value));
      if (unit == "N") most_pa = std::max(most_pa, std::abs(value) / largest_side_m2(simulation.body()));
    }
  return most_pa;
}

double strain(const Material& material, const Body& body, double loads_pa) {
  return std::max(weight_pa(material, body), loads_pa) / material.youngs_modulus_pa;
}

// Without `material`: the default one.
void refuse_odd(const YamlNode& scene, const YamlNode& section, const YamlNode* material, const Body& body,
                double strain) {
  if (strain <= kLargestStrain) return;
  const auto refuse = [&](const YamlNode& where, const std::string& why) {
    std::ostringstream text;
    text << "its weight, loads or commands would strain the body by " << strain << ", where robots bear "
         << kLargestStrain << ": " << why;
    where.fail(text.str());
  };
  const std::string lifts = "; a `stiffness_ratio: 1` in its `material` says that it is meant";
  if (const auto odd = material ? odd_material(*material) : std::nullopt) refuse(*stated_modulus(*material), odd->text);
  if (const auto odd = odd_gravity(body)) refuse(scene.child("gravity_m_s2"), odd->text + lifts);
  if (const auto odd = odd_body(scene, body)) refuse(section, odd->text + lifts);
}

}  // namespace

std::vector<SolveWarning> implausible_sizes(const YamlNode& scene, const Body& body, const MeshLocator& locator,
                                            const std::vector<Marker>& markers) {
  std::vector<SolveWarning> warnings;
  add(odd_body(scene, body), warnings);
  for (const YamlNode& section : body_sections(scene))
    for (const YamlNode& material : materials_of(section)) {
      add(odd_material(material), warnings);
      add(odd_density(material), warnings);
    }
  add(odd_gravity(body), warnings);
  for (const Marker& marker : markers) check_stalk(marker, body, locator, warnings);
  return warnings;
}

void refuse_megapascals(const YamlNode& scene) {
  for (const YamlNode& section : body_sections(scene))
    for (const YamlNode& material : materials_of(section)) {
      const auto odd = odd_material(material);
      if (odd && odd->size < kMostMegapascals) stated_modulus(material)->fail(odd->text);
    }
}

void refuse_unbearable(const YamlNode& scene, const Simulation& simulation, const RunSettings& run) {
  const Body& body = simulation.body();
  const double loads_pa =
      std::max(body.dead_loads_n().colwise().norm().sum() / largest_side_m2(body), commanded_pa(simulation, run));
  for (const YamlNode& section : body_sections(scene)) {
    for (const YamlNode& material : materials_of(section))
      if (!material.has("stiffness_ratio"))
        refuse_odd(scene, section, &material, body, strain(read_material(material), body, loads_pa));
    if (!section.has("material")) refuse_odd(scene, section, nullptr, body, strain(Material(), body, loads_pa));
  }
}

}  // namespace soft_robot_lab
