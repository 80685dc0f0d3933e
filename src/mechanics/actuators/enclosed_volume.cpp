// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuators/enclosed_volume.h"

#include <map>

#include <Eigen/Geometry>

#include "surface_edge.h"

namespace soft_robot_lab {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// Length-weighted mean of a loop's points; a quadratic edge counts by Simpson's rule.
EmbeddedPoint centre_of(const std::vector<EdgeOfFace>& loop, const TetMesh& mesh) {
  std::map<int, double> weights;
  double total = 0.0;
  for (const EdgeOfFace& edge : loop) {
    const double length = (mesh.nodes_m.col(edge.to) - mesh.nodes_m.col(edge.from)).norm();
    const bool curved = edge.middle >= 0;
    for (const int end : {edge.from, edge.to}) weights[end] += length * (curved ? 1.0 / 6.0 : 0.5);
    if (curved) weights[edge.middle] += length * 2.0 / 3.0;
    total += length;
  }
  EmbeddedPoint centre;
  for (const auto& [node, weight] : weights) {
    centre.nodes.push_back(node);
    centre.weights.push_back(weight / total);
  }
  return centre;
}

}  // namespace

// Integrals of the shape functions: a third of x . (dx/dr x dx/ds) over a triangle in reference coordinates r, s, and a
// sixth of apex . (x x dx/dt) along an edge; negative, as the faces turn outwards from the body.
const std::vector<EnclosedVolume::Term>& EnclosedVolume::terms_of(std::size_t member_count, bool cap) {
  static const std::vector<Term> linear_face{{0, 1, 2, -1.0 / 6.0}};
  static const std::vector<Term> linear_cap{{0, 1, 2, 1.0 / 6.0}};  // from, to, apex
  static const std::vector<Term> quadratic_cap{
      {0, 2, 3, 2.0 / 9}, {2, 1, 3, 2.0 / 9}, {0, 1, 3, -1.0 / 18}};  // from, to, middle, apex
  static const std::vector<Term> quadratic_face{
      {0, 1, 2, -1.0 / 45}, {0, 1, 3, -1.0 / 30}, {0, 1, 4, 1.0 / 18},  {0, 1, 5, 1.0 / 18},  {0, 2, 3, -1.0 / 18},
      {0, 2, 4, -1.0 / 18}, {0, 2, 5, 1.0 / 30},  {0, 3, 4, -2.0 / 45}, {0, 3, 5, -4.0 / 15}, {0, 4, 5, -2.0 / 45},
      {1, 2, 3, 1.0 / 18},  {1, 2, 4, -1.0 / 30}, {1, 2, 5, 1.0 / 18},  {1, 3, 4, 4.0 / 15},  {1, 3, 5, 2.0 / 45},
      {1, 4, 5, -2.0 / 45}, {2, 3, 4, -2.0 / 45}, {2, 3, 5, 2.0 / 45},  {2, 4, 5, 4.0 / 15},  {3, 4, 5, -8.0 / 45}};
  if (cap) return member_count == 3 ? linear_cap : quadratic_cap;
  return member_count == 3 ? linear_face : quadratic_face;
}

EnclosedVolume::EnclosedVolume(const TetMesh& mesh, const std::vector<int>& faces) {
  for (const int face : faces) {
    Clique members(mesh.faces.col(face).data(), mesh.faces.col(face).data() + mesh.faces.rows());
    origin_m_ += mesh.nodes_m.col(members[0]) / static_cast<double>(faces.size());
    patches_.push_back({members, &terms_of(members.size(), false)});
  }
  add_caps(mesh, faces);
}

void EnclosedVolume::add_caps(const TetMesh& mesh, const std::vector<int>& faces) {
  for (const std::vector<EdgeOfFace>& loop : edge_loops(mesh, faces)) {
    const int apex = ~static_cast<int>(cap_centres_.size());
    cap_centres_.push_back(centre_of(loop, mesh));
    for (const EdgeOfFace& edge : loop) {
      Clique members{edge.from, edge.to};
      if (edge.middle >= 0) members.push_back(edge.middle);
      members.push_back(apex);
      patches_.push_back({members, &terms_of(members.size(), true)});
    }
  }
}

std::vector<Clique> EnclosedVolume::cliques() const {
  std::vector<Clique> all;
  for (const Patch& patch : patches_) all.push_back(patch.members);
  return all;
}

std::vector<EnclosedVolume::Triple> EnclosedVolume::triples() const {
  std::vector<Triple> all;
  for (const Patch& patch : patches_) {
    const auto member = [&](int i) { return patch.members[static_cast<std::size_t>(i)]; };
    for (const Term& term : *patch.terms)
      all.push_back({term.weight, {member(term.i), member(term.j), member(term.k)}});
  }
  return all;
}

Eigen::Matrix3Xd EnclosedVolume::centres(const Eigen::Matrix3Xd& positions_m) const {
  Eigen::Matrix3Xd result(3, cap_centres_.size());
  for (std::size_t k = 0; k < cap_centres_.size(); ++k)
    result.col(static_cast<Eigen::Index>(k)) = cap_centres_[k].at(positions_m);
  return result;
}

Eigen::Matrix3Xd EnclosedVolume::corners(const Patch& patch, const Eigen::Matrix3Xd& positions_m,
                                         const Eigen::Matrix3Xd& centres_m) const {
  Eigen::Matrix3Xd x(3, patch.members.size());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const int member = patch.members[static_cast<std::size_t>(i)];
    x.col(i) = (member < 0 ? centres_m.col(~member) : positions_m.col(member)) - origin_m_;
  }
  return x;
}

double EnclosedVolume::value_m3(const Eigen::Matrix3Xd& positions_m) const {
  const Eigen::Matrix3Xd centres_m = centres(positions_m);
  double volume = 0.0;
  for (const Patch& patch : patches_) {
    const Eigen::Matrix3Xd x = corners(patch, positions_m, centres_m);
    for (const Term& term : *patch.terms)
      volume += term.weight * x.col(term.i).dot(Eigen::Vector3d(x.col(term.j)).cross(Eigen::Vector3d(x.col(term.k))));
  }
  return volume;
}

void EnclosedVolume::add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const {
  const Eigen::Matrix3Xd centres_m = centres(positions_m);
  Eigen::Matrix3Xd of_centres = Eigen::Matrix3Xd::Zero(3, centres_m.cols());
  for (const Patch& patch : patches_) {
    const Eigen::Matrix3Xd corners_m = corners(patch, positions_m, centres_m);
    const auto x = [&](int i) { return Eigen::Vector3d(corners_m.col(i)); };
    const auto add = [&](int i, const Eigen::Vector3d& part) {
      const int member = patch.members[static_cast<std::size_t>(i)];
      (member < 0 ? of_centres.col(~member) : gradient.col(member)) += part;
    };
    for (const Term& term : *patch.terms) {
      add(term.i, scale * term.weight * x(term.j).cross(x(term.k)));
      add(term.j, scale * term.weight * x(term.k).cross(x(term.i)));
      add(term.k, scale * term.weight * x(term.i).cross(x(term.j)));
    }
  }
  for (std::size_t k = 0; k < cap_centres_.size(); ++k)
    for (std::size_t n = 0; n < cap_centres_[k].nodes.size(); ++n)
      gradient.col(cap_centres_[k].nodes[n]) +=
          cap_centres_[k].weights[n] * of_centres.col(static_cast<Eigen::Index>(k));
}

void EnclosedVolume::add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const {
  const Eigen::Matrix3Xd centres_m = centres(positions_m);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Patch& patch = patches_[p];
    const Eigen::Matrix3Xd x = corners(patch, positions_m, centres_m);
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3 * x.cols(), 3 * x.cols());
    // d2/dx_i dx_j of det(x_i, x_j, x_k) is -[x_k]: cyclically, and antisymmetric in its places.
    const auto couple = [&](int i, int j, const Eigen::Matrix3d& minus_cross) {
      block.block<3, 3>(3 * i, 3 * j) -= minus_cross;
      block.block<3, 3>(3 * j, 3 * i) += minus_cross;
    };
    for (const Term& term : *patch.terms) {
      const double weight = scale * term.weight;
      couple(term.i, term.j, cross_matrix(weight * x.col(term.k)));
      couple(term.j, term.k, cross_matrix(weight * x.col(term.i)));
      couple(term.k, term.i, cross_matrix(weight * x.col(term.j)));
    }
    hessian.add_dense(static_cast<int>(p), block);
  }
}

}  // namespace soft_robot_lab
