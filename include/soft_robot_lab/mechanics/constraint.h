// SPDX-License-Identifier: BSD-3-Clause
// The two interfaces through which anything pulls, pushes or fills the body: a compliant scalar constraint, and a
// further energy.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "drive_state.h"
#include "embedding.h"

namespace soft_robot_lab {

// What a second derivative couples: node i as i, carried point k of the constraint as ~k.
using Clique = std::vector<int>;

// Takes second derivatives, clique by clique.
class CliqueSink {
 public:
  virtual ~CliqueSink() = default;
  // Adds coefficients[i] coefficients[j] block for every two members i, j of the clique; the block is symmetric.
  virtual void add_outer(int clique, const std::vector<double>& coefficients, const Eigen::Matrix3d& block) = 0;
  // Adds a symmetric matrix over 3*i + axis of the clique's members.
  virtual void add_dense(int clique, const Eigen::MatrixXd& matrix) = 0;
};

// The energy U(C) of a constraint near one value and multiplier, written so that a rigid constraint stays finite (XPBD,
// Macklin et al. 2016). The multiplier y = dU/dC is an unknown of its own; the nodes feel the force -y dC/dx.
//   offset + compliance-weighted linearisation:   compliance * y = offset + dC   where C grows by dC
// A law C = c(y) that is not straight is linearised at the present y: compliance = c'(y), offset = C - c(y) + c'(y) y.
struct ConstraintLaw {
  double offset = 0.0;      // what compliance * y must be at this value; C - L for a cable of length L; unit of C
  double compliance = 0.0;  // c'(y) = 1 / U''(C) >= 0; 0 is rigid
  double min_multiplier = -std::numeric_limits<double>::infinity();  // 0 for a cable, which cannot push
  double max_multiplier = std::numeric_limits<double>::infinity();   // equal to the minimum: y is prescribed
  double offset_per_command = 0.0;                                   // d offset / d command at fixed C
  double multiplier_per_command = 0.0;                               // d y / d command where y is prescribed

  bool prescribed() const { return min_multiplier == max_multiplier; }
};

// A scalar function C(x) of the node positions (3 x nodes, [m]) with an energy U(C). It never changes: what it follows
// besides the positions, its actuator's command and memory, is `drive`, so that several threads can ask it at once.
// A solver reads the cliques once, then per iteration: value, law, gradient, Hessian.
class Constraint {
 public:
  virtual ~Constraint() = default;

  // Points through which the constraint acts on many nodes at once, such as a cable's via points. They become unknowns
  // of their own in the solver's matrix, so that two far points couple without coupling all their nodes.
  virtual std::vector<EmbeddedPoint> carried_points() const { return {}; }

  // The second derivative of C couples only members that share a clique; the members of one clique are distinct.
  virtual std::vector<Clique> cliques() const = 0;

  virtual double value(const Eigen::Matrix3Xd& positions_m, const DriveState& drive) const = 0;

  // Adds scale * dC/dx to a 3 x nodes matrix.
  virtual void add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                            Eigen::Matrix3Xd& gradient) const = 0;

  // Adds scale * d2C/dx2, with carried points p = W x in place of their nodes.
  virtual void add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                           CliqueSink& hessian) const = 0;

  virtual ConstraintLaw law(double value, double multiplier, const DriveState& drive) const = 0;
};

// Where two constraints meet that share one stock of length, such as two spans of a cable at the point between them.
// Their multipliers, which are not negative, may differ by a factor of `ratio`; at that bound length slips over from
// the smaller one's side to the larger one's (friction on a capstan). A flow is the length [m] that the first has
// gained from the second: it lowers the first's offset and raises the second's.
class FrictionContact {
 public:
  virtual ~FrictionContact() = default;
  virtual double ratio(const Eigen::Matrix3Xd& positions_m) const = 0;  // >= 1
  // Adds scale * d log(ratio)/dx to a 3 x nodes matrix.
  virtual void add_log_ratio_gradient(const Eigen::Matrix3Xd& positions_m, double scale,
                                      Eigen::Matrix3Xd& gradient) const = 0;
  int first = 0, second = 1;  // in the order of the actuator's constraints
};

// A further energy E(x) of the node positions (3 x nodes, [m]), such as that of a magnet in a field. It never changes;
// what it follows besides the positions is `drive`, as for a constraint. E is smooth, or its gradient at least
// continuous, and finite for all positions.
class EnergyTerm {
 public:
  virtual ~EnergyTerm() = default;

  // The second derivative couples only nodes that share a clique; the nodes of one clique are distinct. Those of one
  // element cost nothing more; empty for an energy that is linear in the positions.
  virtual std::vector<Clique> cliques() const = 0;

  // E [J]; adds dE/dx [N] to a 3 x nodes matrix.
  virtual double add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& drive,
                              Eigen::Matrix3Xd& gradient_n) const = 0;

  // Adds d2E/dx2; `convex`: a symmetric matrix near it without negative eigenvalues.
  virtual void add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, bool convex,
                           CliqueSink& hessian) const = 0;

  // Adds d2E/(dx dc), c the actuated command [N per unit of the command]; nothing where E does not depend on it.
  virtual void add_command_gradient(const Eigen::Matrix3Xd& /*positions_m*/, const DriveState& /*drive*/,
                                    Eigen::Matrix3Xd& /*gradient*/) const {}
};

}  // namespace soft_robot_lab
