// SPDX-License-Identifier: BSD-3-Clause
// The volume that a surface of the body encloses, exact on linear and quadratic faces, with its derivatives.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

// By the divergence theorem the volume is a third of the integral of x . n over the surface: on these faces a sum of
// weight * det(x_i, x_j, x_k) over triples of their nodes, from which value, gradient and Hessian follow exactly.
//
// An open surface is closed by caps: each loop of its edge is a curve, and the cap is the cone over that curve with its
// apex in the curve's centre of length (of the rest shape, in material weights). The cap's volume follows from the
// curve in closed form, so it belongs to value and derivatives alike: the pressure on a cap acts on the loop's nodes.
class EnclosedVolume {
 public:
  // `faces`: columns of mesh.faces, which turn outwards from the body: into the volume. Throws std::invalid_argument
  // with the place where the edge of the surface cannot be capped.
  EnclosedVolume(const TetMesh& mesh, const std::vector<int>& faces);

  // A part weight * det(x_i - origin, x_j - origin, x_k - origin) of the volume; members as in a clique.
  struct Triple {
    double weight;
    std::array<int, 3> members;
  };
  std::vector<Triple> triples() const;
  const Eigen::Vector3d& origin_m() const { return origin_m_; }

  const std::vector<EmbeddedPoint>& cap_centres() const { return cap_centres_; }
  std::vector<Clique> cliques() const;  // one per face and per edge of a loop; cap centre k as ~k

  double value_m3(const Eigen::Matrix3Xd& positions_m) const;
  void add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const;
  void add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const;

 private:
  struct Term {
    int i, j, k;    // places among the members of a patch
    double weight;  // of det(x_i, x_j, x_k)
  };
  struct Patch {
    Clique members;
    const std::vector<Term>* terms;
  };
  static const std::vector<Term>& terms_of(std::size_t member_count, bool cap);
  void add_caps(const TetMesh& mesh, const std::vector<int>& faces);
  Eigen::Matrix3Xd corners(const Patch& patch, const Eigen::Matrix3Xd& positions_m,
                           const Eigen::Matrix3Xd& centres_m) const;
  Eigen::Matrix3Xd centres(const Eigen::Matrix3Xd& positions_m) const;

  std::vector<Patch> patches_;
  std::vector<EmbeddedPoint> cap_centres_;
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();  // near the surface, so that little cancels
};

}  // namespace soft_robot_lab
