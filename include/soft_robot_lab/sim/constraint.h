// The one interface through which anything pulls, pushes or fills the body: a compliant scalar constraint.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Takes second derivatives, clique by clique: the sets of nodes that a constraint declared with coupled_nodes().
class CliqueSink {
 public:
  virtual ~CliqueSink() = default;
  // Adds coefficients[i] coefficients[j] block for every two nodes i, j of the clique; the block is symmetric.
  virtual void add_outer(int clique, const std::vector<double>& coefficients, const Eigen::Matrix3d& block) = 0;
  // Adds a symmetric matrix over 3*i + axis of the clique's nodes.
  virtual void add_dense(int clique, const Eigen::MatrixXd& matrix) = 0;
};

// The energy U(C) of a constraint near one value, written so that a rigid constraint stays finite (XPBD, Macklin et al. 2016).
// The multiplier y = dU/dC is an unknown of its own; the nodes feel the force -y dC/dx.
//   offset + compliance-weighted linearisation:   compliance * y = offset + dC   where C grows by dC
struct ConstraintLaw {
  double offset = 0.0;      // compliance * dU/dC at this value; C - L for a cable of length L; unit of C
  double compliance = 0.0;  // 1 / U''(C) >= 0; 0 is rigid
  double min_multiplier = -std::numeric_limits<double>::infinity();  // 0 for a cable, which cannot push
  double max_multiplier = std::numeric_limits<double>::infinity();   // equal to the minimum: y is prescribed
  double offset_per_command = 0.0;      // d offset / d command at fixed C
  double multiplier_per_command = 0.0;  // d y / d command where y is prescribed

  bool prescribed() const { return min_multiplier == max_multiplier; }
};

// A scalar function C(x) of the node positions (3 x nodes, [m]) with an energy U(C).
// A solver reads `coupled_nodes` once, then per iteration: value, law, gradient, Hessian.
class Constraint {
 public:
  virtual ~Constraint() = default;

  // Sets of distinct nodes (cliques); the second derivative of C couples only nodes that share one.
  virtual std::vector<std::vector<int>> coupled_nodes() const = 0;

  virtual double value(const Eigen::Matrix3Xd& positions_m) const = 0;

  // Adds scale * dC/dx to a 3 x nodes matrix.
  virtual void add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const = 0;

  // Adds scale * d2C/dx2.
  virtual void add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const = 0;

  virtual ConstraintLaw law(double value) const = 0;
};

}  // namespace soft_robot_lab
