// SPDX-License-Identifier: BSD-3-Clause
// A stiff magnet in the silicone, in an even field whose strength is the command: an example of an energy of one's own.
//
//   E = -m B . n,   n = d / |d|,   d = x1 - x0
// m: moment [A m^2], B: field [T], x0 and x1: the magnet's south and north pole in the body.
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "soft_robot_lab/mechanics/actuator.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace example_plugin {

class MagnetEnergy : public soft_robot_lab::EnergyTerm {
 public:
  MagnetEnergy(const soft_robot_lab::EmbeddedPoint& south, const soft_robot_lab::EmbeddedPoint& north,
               double moment_a_m2, const Eigen::Vector3d& field_axis)
      : moment_a_m2_(moment_a_m2), field_axis_(field_axis) {
    for (const auto& [point, sign] : {std::pair(&south, -1.0), std::pair(&north, 1.0)}) add(*point, sign);
  }

  std::vector<soft_robot_lab::Clique> cliques() const override { return {nodes_}; }

  double add_gradient(const Eigen::Matrix3Xd& positions_m, const soft_robot_lab::DriveState& drive,
                      Eigen::Matrix3Xd& gradient_n) const override {
    return add_scaled(positions_m, drive.actuated_command, gradient_n);
  }

  void add_hessian(const Eigen::Matrix3Xd& positions_m, const soft_robot_lab::DriveState& drive, bool convex,
                   soft_robot_lab::CliqueSink& hessian) const override {
    const Eigen::Vector3d d = span_m(positions_m), n = d.normalized(), b = drive.actuated_command * field_axis_;
    Eigen::Matrix3d block = 3.0 * b.dot(n) * n * n.transpose() - b.dot(n) * Eigen::Matrix3d::Identity() -
                            b * n.transpose() - n * b.transpose();
    block *= -moment_a_m2_ / d.squaredNorm();
    if (convex) {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> own(block);
      block = own.eigenvectors() * own.eigenvalues().cwiseMax(0.0).asDiagonal() * own.eigenvectors().transpose();
    }
    hessian.add_outer(0, weights_, block);
  }

  void add_command_gradient(const Eigen::Matrix3Xd& positions_m, const soft_robot_lab::DriveState& /*drive*/,
                            Eigen::Matrix3Xd& gradient) const override {
    add_scaled(positions_m, 1.0, gradient);  // E is linear in the field
  }

 private:
  void add(const soft_robot_lab::EmbeddedPoint& point, double sign) {
    for (std::size_t k = 0; k < point.nodes.size(); ++k) {
      std::size_t at = 0;
      while (at < nodes_.size() && nodes_[at] != point.nodes[k]) ++at;
      if (at == nodes_.size()) {
        nodes_.push_back(point.nodes[k]);
        weights_.push_back(0.0);
      }
      weights_[at] += sign * point.weights[k];
    }
  }

  Eigen::Vector3d span_m(const Eigen::Matrix3Xd& positions_m) const {
    Eigen::Vector3d span = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < nodes_.size(); ++k) span += weights_[k] * positions_m.col(nodes_[k]);
    return span;
  }

  double add_scaled(const Eigen::Matrix3Xd& positions_m, double field_t, Eigen::Matrix3Xd& gradient_n) const {
    const Eigen::Vector3d d = span_m(positions_m), n = d.normalized(), b = field_t * field_axis_;
    const Eigen::Vector3d force_n = -moment_a_m2_ / d.norm() * (b - n * n.dot(b));
    for (std::size_t k = 0; k < nodes_.size(); ++k) gradient_n.col(nodes_[k]) += weights_[k] * force_n;
    return -moment_a_m2_ * b.dot(n);
  }

  soft_robot_lab::Clique nodes_;
  std::vector<double> weights_;  // of d
  double moment_a_m2_;
  Eigen::Vector3d field_axis_;
};

// Settings: south_m, north_m; moment_a_m2; field_axis; max_field_t. Commands are field strengths [T].
class Magnet : public soft_robot_lab::Actuator {
 public:
  std::vector<const soft_robot_lab::Constraint*> constraints() const override { return {}; }
  std::vector<const soft_robot_lab::EnergyTerm*> energy_terms() const override { return {energy_.get()}; }
  soft_robot_lab::ActuatorReading observe(const Eigen::Matrix3Xd& /*positions_m*/,
                                          const std::vector<double>& /*multipliers*/,
                                          const soft_robot_lab::DriveState& /*drive*/) const override {
    return {};
  }

 protected:
  void on_initialise(const soft_robot_lab::YamlNode& settings, const soft_robot_lab::Body& /*body*/,
                     const soft_robot_lab::MeshLocator& locator) override {
    const Eigen::Vector3d south_m = settings.vector3("south_m"), north_m = settings.vector3("north_m");
    if (south_m == north_m) settings.child("north_m").fail("is where south_m is");
    const Eigen::Vector3d axis = settings.vector3("field_axis");
    if (axis.isZero(0.0)) settings.child("field_axis").fail("has no length");
    const double most_t = settings.number("max_field_t", {0.0, 100.0, true, false});
    energy_ = std::make_unique<MagnetEnergy>(locator.embed(south_m), locator.embed(north_m),
                                             settings.number("moment_a_m2"), axis.normalized());
    limits_ = {0.0, -most_t, most_t, "T"};
  }

 private:
  std::unique_ptr<MagnetEnergy> energy_;
};

}  // namespace example_plugin

#ifndef EXAMPLE_PLUGIN_WITHOUT_ROS
#include <pluginlib/class_list_macros.hpp>
PLUGINLIB_EXPORT_CLASS(example_plugin::Magnet, soft_robot_lab::Actuator)
#endif
