// SPDX-License-Identifier: BSD-3-Clause
// The numbers that a fit changes: their names, bounds and present values, and the scene that they make.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "soft_robot_lab/control/identification/fit_model.h"
#include "robot/scene/scene_cables.h"

namespace soft_robot_lab {

struct FitNumber {
  enum class Kind { modulus, of_cables, backlash, camera, damping, creep, density };
  std::string name;
  Kind kind = Kind::modulus;
  std::string key;                  // of_cables
  std::vector<std::string> cables;  // of_cables, backlash
  int axis = 0;                     // camera: x, y, z, then those of the rotation vector
  double start = 0.0, min = 0.0, max = 0.0;
  double size = 1.0;  // what counts as a change of about one
};

// Twelve digits, in the "C" locale.
std::string text_of(double value);

// With the density that makes the body as heavy as it was weighed.
SceneOptions weighed(const std::string& scene, SceneOptions options, double mass_kg);

class FitParameters {
 public:
  // Throws std::invalid_argument naming the parameter, and what is known or allowed.
  FitParameters(const std::string& scene, const SceneOptions& options, const std::vector<FitParameter>& asked);

  const std::vector<FitNumber>& numbers() const { return numbers_; }
  // Where asked for; not among the numbers.
  const std::optional<FitNumber>& damping() const { return damping_; }
  const std::vector<FitNumber>& creep() const { return creep_; }  // stiffness ratio and relaxation time, or none
  std::vector<FitNumber> numbers_in_time() const;                 // the numbers, and the logarithms of both of creep

  // With those of the scene's options; numbers of these names stay as the scene has them.
  Overrides overrides(const Eigen::VectorXd& values, const std::set<std::string>& left_out = {}) const;
  Eigen::Isometry3d measured_from_base(const Eigen::VectorXd& values) const;
  std::map<std::string, double> backlash_m(const Eigen::VectorXd& values) const;  // by cable
  // d measured marker / d number, each in its `size`, at a point of robot_base; `by_model` are the columns of the
  // model's numbers, 3 x model_columns(), and of values after these, in their own units.
  Eigen::Matrix3Xd measured_jacobian(const Eigen::VectorXd& values, const Eigen::Vector3d& point_m,
                                     const Eigen::Matrix3Xd& by_model) const;
  // Columns of the numbers that are of the model, and what they are there; cables are actuators of the same names.
  std::vector<std::size_t> model_columns() const;
  std::vector<ModelParameter> model_parameters(const Simulation& simulation) const;

 private:
  // d measured / d camera numbers at a point of robot_base: columns of axes 0 to 5.
  Eigen::Matrix<double, 3, 6> camera_jacobian(const Eigen::VectorXd& values, const Eigen::Vector3d& point_m) const;
  void add(const FitParameter& asked, const std::string& cable);
  void add_damping(const FitParameter& asked);
  void add_creep(const FitParameter& asked);
  void add_of_material(FitNumber::Kind kind, double present, double factor, const FitParameter& asked);
  void add_camera(const FitParameter& asked);
  void add_of_cables(const FitParameter& asked, const std::string& cable);
  FitNumber number_of_cables(const std::string& key, const std::string& cable) const;
  void add_number(FitNumber number, const FitParameter& asked);
  static FitNumber with_bounds(FitNumber number, const FitParameter& asked);
  double present(const std::string& cable, const std::string& key, double otherwise) const;
  Eigen::Matrix<double, 6, 1> camera(const Eigen::VectorXd& values) const;

  Overrides base_overrides_;
  Material material_;
  SceneCables cables_;
  std::vector<FitNumber> numbers_;
  Viscosity viscosity_;  // of the scene
  std::optional<FitNumber> damping_;
  std::vector<FitNumber> creep_;
};

}  // namespace soft_robot_lab
