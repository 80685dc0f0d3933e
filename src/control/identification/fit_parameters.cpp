// SPDX-License-Identifier: BSD-3-Clause
#include "fit_parameters.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

const char* const kKnown =
    "youngs_modulus_pa, density_kg_m3, friction_coefficient, compliance_m_n, length_offset_m, backlash_m (each with "
    ".CABLE for one cable), camera_to_base, damping, creep";

const char* const kBacklash = "backlash_m";

constexpr double kCableCompliance = 1.0e-5;  // of a scene that says none (actuators/cable.h)

Overrides changed(const Material& material, double youngs_modulus_pa, double density_kg_m3) {
  const double grown = youngs_modulus_pa / material.youngs_modulus_pa;
  Overrides keys;
  switch (material.model) {
    case MaterialModel::mooney_rivlin:
      keys.set({"model"}, "mooney_rivlin").set({"c10_pa"}, grown * material.c10_pa());
      keys.set({"c01_pa"}, grown * material.c01_pa);
      break;
    case MaterialModel::yeoh:
      keys.set({"model"}, "yeoh").set({"c1_pa"}, grown * material.c10_pa());
      keys.set({"c2_pa"}, grown * material.c2_pa).set({"c3_pa"}, grown * material.c3_pa);
      break;
    case MaterialModel::neo_hookean:
      keys.set({"model"}, "neo_hookean").set({"youngs_modulus_pa"}, youngs_modulus_pa);
      break;
  }
  return keys.set({"poissons_ratio"}, material.poissons_ratio).set({"density_kg_m3"}, density_kg_m3);
}

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

}  // namespace

std::string text_of(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(12) << value;
  return text.str();
}

SceneOptions weighed(const std::string& scene, SceneOptions options, double mass_kg) {
  const double volume_m3 = volume(load_scene(scene, options).simulation->body().mesh());
  options.overrides.set({"body", "material", "density_kg_m3"}, mass_kg / volume_m3);
  return options;
}

FitParameters::FitParameters(const std::string& scene, const SceneOptions& options,
                             const std::vector<FitParameter>& asked)
    : base_overrides_(options.overrides), cables_(scene, options.overrides) {
  const Scene loaded = load_scene(scene, options);
  const Body& body = loaded.simulation->body();
  if (!body.one_material() || body.mesh().bodies.size() > 1)
    throw std::invalid_argument("a fit knows one body of one material, not several");
  material_ = body.material();
  viscosity_ = body.viscosity();
  for (const FitParameter& parameter : asked) {
    const std::size_t dot = parameter.name.find('.');
    FitParameter plain = parameter;
    plain.name = parameter.name.substr(0, dot);
    add(plain, dot == std::string::npos ? "" : parameter.name.substr(dot + 1));
  }
}

double FitParameters::present(const std::string& cable, const std::string& key, double otherwise) const {
  const std::optional<YamlNode> value = cables_.value(cable, key);
  return value ? value->as_number() : otherwise;
}

void FitParameters::add(const FitParameter& asked, const std::string& cable) {
  const std::string& key = asked.name;
  if (key == "friction_coefficient" || key == "compliance_m_n" || key == "length_offset_m" || key == kBacklash) {
    add_of_cables(asked, cable);
  } else if (cable.empty() && key == "damping") {
    add_damping(asked);
  } else if (cable.empty() && key == "creep") {
    add_creep(asked);
  } else if (cable.empty() && key == "youngs_modulus_pa") {
    add_of_material(FitNumber::Kind::modulus, material_.youngs_modulus_pa, 5.0, asked);
  } else if (cable.empty() && key == "density_kg_m3") {
    add_of_material(FitNumber::Kind::density, material_.density_kg_m3, 2.0, asked);
  } else if (cable.empty() && key == "camera_to_base") {
    add_camera(asked);
  } else {
    throw std::invalid_argument("parameters: '" + key + (cable.empty() ? "" : "." + cable) + "' is not one of " +
                                kKnown);
  }
}

void FitParameters::add_damping(const FitParameter& asked) {
  if (damping_) throw std::invalid_argument("parameters: damping is asked for twice");
  FitNumber number{asked.name, FitNumber::Kind::damping, asked.name, {}, 0, 0.0, 1e-5, 0.1, 1.0};
  number.start = viscosity_.rayleigh_stiffness_s > 0.0 ? viscosity_.rayleigh_stiffness_s : 2e-3;
  number.start = std::max(asked.min.value_or(number.min), std::min(asked.max.value_or(number.max), number.start));
  damping_ = with_bounds(number, asked);
}

void FitParameters::add_creep(const FitParameter& asked) {
  if (!creep_.empty()) throw std::invalid_argument("parameters: creep is asked for twice");
  if (asked.start || asked.min || asked.max)
    throw std::invalid_argument("parameters: creep is two numbers; it takes no start and no bounds");
  const bool known = viscosity_.hysteresis_ratio > 0.0;
  const auto number = [](const std::string& name, double start, double least, double most) {
    return FitNumber{name, FitNumber::Kind::creep, name, {}, 0, std::clamp(start, least, most), least, most, 1.0};
  };
  creep_ = {number("creep.stiffness_ratio", known ? viscosity_.hysteresis_ratio : 0.1, 1e-3, 3.0),
            number("creep.relaxation_time_s", known ? viscosity_.relaxation_time_s : 2.0, 0.1, 100.0)};
}

void FitParameters::add_of_material(FitNumber::Kind kind, double present, double factor, const FitParameter& asked) {
  add_number({asked.name, kind, asked.name, {}, 0, present, present / factor, present * factor, present}, asked);
}

void FitParameters::add_camera(const FitParameter& asked) {
  FitNumber number{asked.name, FitNumber::Kind::camera, asked.name, {}, 0, 0.0, 0.0, 0.0, 1.0};
  for (const char* part : {"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"}) {
    number.name = asked.name + "." + part;
    number.size = number.axis < 3 ? 1e-3 : 1e-2;
    number.max = number.axis < 3 ? 0.05 : 0.3;
    number.min = -number.max;
    add_number(number, asked);
    ++number.axis;
  }
}

// One number for all cables, but of lengths one for each.
void FitParameters::add_of_cables(const FitParameter& asked, const std::string& cable) {
  const std::string& key = asked.name;
  const std::vector<std::string> all = cable.empty() ? cables_.names() : std::vector<std::string>{cable};
  if (all.empty()) throw std::invalid_argument("parameters: " + key + ": the scene has no cables");
  if (!cable.empty()) cables_.require_known(cable);
  std::vector<std::vector<std::string>> groups = {all};
  const bool one_each = key == "length_offset_m" || key == kBacklash;
  if (one_each) {
    groups.clear();
    for (const std::string& one : all) groups.push_back({one});
  }
  for (const std::vector<std::string>& group : groups) {
    FitNumber number = number_of_cables(key, group[0]);
    number.cables = group;
    number.name = key + (group.size() < cables_.names().size() || one_each ? "." + group[0] : "");
    add_number(number, asked);
  }
}

FitNumber FitParameters::number_of_cables(const std::string& key, const std::string& cable) const {
  FitNumber number{key, FitNumber::Kind::of_cables, key, {}, 0, 0.0, 0.0, 0.0, 1.0};
  if (key == "friction_coefficient") {
    number.start = std::max(0.02, present(cable, key, 0.1));
    number.size = 0.1;
    number.min = 1e-3;  // at none at all, nothing says which way a cable slips
    number.max = 1.0;
  } else if (key == "compliance_m_n") {
    number.start = present(cable, key, kCableCompliance);
    number.size = 1e-5 + number.start;
    number.max = std::max(2e-3, 10.0 * number.start);
  } else {
    number.start = key == kBacklash ? 0.0 : present(cable, key, 0.0);
    number.size = 1e-3;
    number.min = key == kBacklash ? 0.0 : -0.01;
    number.max = 0.01;
  }
  if (key == kBacklash) number.kind = FitNumber::Kind::backlash;
  return number;
}

void FitParameters::add_number(FitNumber number, const FitParameter& asked) {
  for (const FitNumber& other : numbers_) {
    const bool shared = std::any_of(other.cables.begin(), other.cables.end(), [&](const std::string& cable) {
      return std::find(number.cables.begin(), number.cables.end(), cable) != number.cables.end();
    });
    if (other.name == number.name || (other.key == number.key && shared))
      throw std::invalid_argument("parameters: " + number.name + " is asked for twice");
  }
  numbers_.push_back(with_bounds(std::move(number), asked));
}

FitNumber FitParameters::with_bounds(FitNumber number, const FitParameter& asked) {
  number.start = asked.start.value_or(number.start);
  number.min = asked.min.value_or(number.min);
  number.max = asked.max.value_or(number.max);
  const bool positive = number.kind == FitNumber::Kind::modulus || number.kind == FitNumber::Kind::density ||
                        number.kind == FitNumber::Kind::damping || number.key == "friction_coefficient";
  const bool not_negative = number.key == "compliance_m_n" || number.key == kBacklash;
  if (!(std::isfinite(number.min) && std::isfinite(number.max) && number.min < number.max &&
        (!positive || number.min > 0.0) && (!not_negative || number.min >= 0.0)))
    throw std::invalid_argument("parameters: " + number.name + ": bounds " + text_of(number.min) + ", " +
                                text_of(number.max) + " must rise" +
                                (positive       ? " from above 0"
                                 : not_negative ? " from 0 or more"
                                                : ""));
  if (!(number.start >= number.min && number.start <= number.max))
    throw std::invalid_argument("parameters: " + number.name + ": start " + text_of(number.start) + " is not in [" +
                                text_of(number.min) + ", " + text_of(number.max) + "]");
  return number;
}

std::vector<FitNumber> FitParameters::numbers_in_time() const {
  std::vector<FitNumber> all = numbers_;
  for (FitNumber number : creep_) {
    for (double* value : {&number.start, &number.min, &number.max}) *value = std::log(*value);
    all.push_back(std::move(number));
  }
  return all;
}

Overrides FitParameters::overrides(const Eigen::VectorXd& values, const std::set<std::string>& left_out) const {
  Overrides overrides = base_overrides_;
  std::optional<double> modulus_pa, density_kg_m3;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const FitNumber& number = numbers_[i];
    if (left_out.count(number.name) > 0) continue;
    const double value = values[static_cast<Eigen::Index>(i)];
    if (number.kind == FitNumber::Kind::modulus) modulus_pa = value;
    if (number.kind == FitNumber::Kind::density) density_kg_m3 = value;
    if (number.kind != FitNumber::Kind::of_cables) continue;
    for (const std::string& cable : number.cables) {
      overrides.set({"cables", cable, number.key}, value);
      if (number.key == "friction_coefficient") overrides.set({"cables", cable, "model"}, "friction");
    }
  }
  if (modulus_pa || density_kg_m3)
    overrides.set({"body", "material"}, changed(material_, modulus_pa.value_or(material_.youngs_modulus_pa),
                                                density_kg_m3.value_or(material_.density_kg_m3)));
  return overrides;
}

std::map<std::string, double> FitParameters::backlash_m(const Eigen::VectorXd& values) const {
  std::map<std::string, double> backlash_m;
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    if (numbers_[i].kind == FitNumber::Kind::backlash)
      backlash_m[numbers_[i].cables.front()] = values[static_cast<Eigen::Index>(i)];
  return backlash_m;
}

Eigen::Matrix<double, 6, 1> FitParameters::camera(const Eigen::VectorXd& values) const {
  Eigen::Matrix<double, 6, 1> camera = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    if (numbers_[i].kind == FitNumber::Kind::camera) camera[numbers_[i].axis] = values[static_cast<Eigen::Index>(i)];
  return camera;
}

Eigen::Isometry3d FitParameters::measured_from_base(const Eigen::VectorXd& values) const {
  const Eigen::Matrix<double, 6, 1> six = camera(values);
  const Eigen::Vector3d turn = six.tail<3>();
  const double angle = turn.norm();
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.translation() = six.head<3>();
  if (angle > 0.0) transform.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  return transform;
}

// d(R p) = -[R p] J_l d turn, with the left Jacobian of the rotation vector.
Eigen::Matrix<double, 3, 6> FitParameters::camera_jacobian(const Eigen::VectorXd& values,
                                                           const Eigen::Vector3d& point_m) const {
  const Eigen::Vector3d turn = camera(values).tail<3>();
  const double angle = turn.norm();
  const Eigen::Matrix3d w = cross(turn);
  Eigen::Matrix3d left = Eigen::Matrix3d::Identity() + 0.5 * w;  // to the first order, for small angles
  if (angle > 1e-5)
    left = Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / (angle * angle) * w +
           (angle - std::sin(angle)) / (angle * angle * angle) * w * w;
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << Eigen::Matrix3d::Identity(), -cross(measured_from_base(values).linear() * point_m) * left;
  return jacobian;
}

Eigen::Matrix3Xd FitParameters::measured_jacobian(const Eigen::VectorXd& values, const Eigen::Vector3d& point_m,
                                                  const Eigen::Matrix3Xd& by_model) const {
  Eigen::Matrix3Xd all = Eigen::Matrix3Xd::Zero(3, values.size());
  const Eigen::Matrix3d turn = measured_from_base(values).linear();
  const Eigen::Matrix<double, 3, 6> by_camera = camera_jacobian(values, point_m);
  Eigen::Index model_column = 0;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const FitNumber& number = numbers_[i];
    const auto column = static_cast<Eigen::Index>(i);
    if (number.kind == FitNumber::Kind::camera) {
      all.col(column) = number.size * by_camera.col(number.axis);
    } else {
      all.col(column) = number.size * turn * by_model.col(model_column++);
    }
  }
  for (auto column = static_cast<Eigen::Index>(numbers_.size()); column < values.size(); ++column)
    all.col(column) = turn * by_model.col(model_column++);
  return all;
}

std::vector<std::size_t> FitParameters::model_columns() const {
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    if (numbers_[i].kind != FitNumber::Kind::camera) columns.push_back(i);
  return columns;
}

std::vector<ModelParameter> FitParameters::model_parameters(const Simulation& simulation) const {
  std::vector<ModelParameter> parameters;
  for (const std::size_t i : model_columns()) {
    ModelParameter parameter{numbers_[i].key, {}};
    for (const std::string& cable : numbers_[i].cables) parameter.actuators.push_back(simulation.actuator_index(cable));
    parameters.push_back(std::move(parameter));
  }
  return parameters;
}

}  // namespace soft_robot_lab
