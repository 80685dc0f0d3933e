// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mechanics/actuators/cable/path_length.h"
#include "mechanics/complementarity/multiplier_problem.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"
#include "soft_robot_lab/mechanics/model.h"
#include "reduced_skin.h"
#include "volume_polynomials.h"

namespace soft_robot_lab {

// The exact lengths of all cables of a model, and the exact volumes of its chambers, as functions of reduced
// coordinates; in the model's order.
class ReducedConstraints {
 public:
  // Keeps the model's constraints, so lives no longer than it. Throws std::invalid_argument naming an actuator that is
  // neither a cable nor a chamber, one whose forces stay as they are over a step, and a cable with `around`.
  ReducedConstraints(const Model& model, const Eigen::MatrixXd& modes);

  struct Values {
    Eigen::MatrixXd gradients;  // modes x constraints: d value / dq
    std::vector<ConstraintLaw> laws;
    std::vector<std::vector<Path::Span>> spans;  // per cable
    std::vector<FrictionContactBound> friction_contacts;
    std::vector<ReducedSkin::Touch> touches;  // constraints after the others

    void add(const std::vector<ReducedSkin::Touch>& more);
    std::vector<Eigen::Index> touching() const;  // places of `touches`
  };
  // Multipliers: tensions [N], and gauge pressures below zero [Pa].
  Values at(const Eigen::VectorXd& q, const Eigen::VectorXd& multipliers, const DriveStates& drives) const;

  // sum over constraints of multiplier times d2 value / dq2; `values` are those of q.
  Eigen::MatrixXd hessian(const Eigen::VectorXd& q, const Values& values, const Eigen::VectorXd& multipliers) const;

  // Of the friction contacts' ratios, modes x contacts: d log(ratio) / dq.
  Eigen::MatrixXd log_ratio_gradients(const Eigen::VectorXd& q) const;
  int friction_contact_count() const { return static_cast<int>(rubbing_.contacts.size()); }

  // Whether an actuator takes something from the state that a step starts from (Actuator::begin_step).
  bool begin_steps() const { return begin_steps_; }

  std::size_t count() const { return actuators_.size(); }
  std::size_t actuator_of(std::size_t constraint) const { return actuators_[constraint]; }

 private:
  struct Cable {
    const Path* path;
    Eigen::Index constraint;
    Eigen::VectorXd rest_places_m;       // 3*point + axis
    Eigen::MatrixXd places;              // 3*point + axis x modes
    std::vector<Eigen::MatrixXd> spans;  // per span 3 x modes: second end less first
  };
  struct Chamber {
    Eigen::Index constraint;
    double rest_volume_m3;
  };
  // Where cables rub, and the nodes that these contacts look at.
  struct Rubbing {
    struct Contact {
      const FrictionContact* law;
      int first, second;  // constraints of the model
    };
    std::vector<Contact> contacts;
    std::vector<int> nodes;
    Eigen::Matrix3Xd rest_m;  // of all nodes
    Eigen::MatrixXd modes;    // 3*place among `nodes` + axis x modes

    Eigen::Matrix3Xd positions_m(const Eigen::VectorXd& q) const;  // of others as at rest
  };
  void add_constraint(const Constraint& constraint, const Actuator& actuator, const Model& model,
                      const Eigen::MatrixXd& modes, std::vector<DeterminantSum>& volumes);
  void find_rubbing(const Model& model, const Eigen::MatrixXd& modes);
  void add_cable(const PathLength& length, const Eigen::Matrix3Xd& rest_positions_m, const Eigen::MatrixXd& modes);
  void add_cables_at(const Eigen::VectorXd& q, Values& values, Eigen::VectorXd& amounts) const;
  void add_chambers_at(const Eigen::VectorXd& q, Values& values, Eigen::VectorXd& amounts) const;

  Eigen::Index modes_;
  std::vector<std::size_t> actuators_;  // per constraint
  std::vector<const Constraint*> all_;  // likewise
  std::vector<Cable> cables_;
  std::vector<Chamber> chambers_;
  Rubbing rubbing_;
  bool begin_steps_ = false;
  std::optional<VolumePolynomials> volumes_;  // of all chambers, less those at rest
};

}  // namespace soft_robot_lab
