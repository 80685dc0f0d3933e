// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/body.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "fibre_groups.h"
#include "gap.h"
#include "overlap.h"
#include "settings/point_text.h"
#include "mechanics/mesh/load_weights.h"

namespace soft_robot_lab {
namespace {

constexpr double kOnSide_m = 2e-6, kOnSide = 1e-3;  // of a load's box; the second of the body's size

void check_hold(const std::vector<ObstaclePose>& motion, const Eigen::Matrix<bool, 3, 1>& axes) {
  if (motion.empty()) return;
  validate_motion(motion);
  const bool turns = std::any_of(motion.begin(), motion.end(),
                                 [](const ObstaclePose& pose) { return !pose.rotation_rad.isZero(0.0); });
  if (turns && !axes.all())
    throw std::invalid_argument("motion: rotation_rad needs all of axes x, y, z; this region holds fewer");
  if (!pose_at(motion, Eigen::Vector3d::Zero(), 0.0).matrix().isIdentity(0.0))
    throw std::invalid_argument(
        "motion: at time_s 0 the region must be where the mesh has it; start with {time_s: 0} and no translation_m");
}

bool holder_moves(const std::vector<Hold>& holds, int node) {
  return std::any_of(holds.begin(), holds.end(), [&](const Hold& hold) {
    return !hold.motion.empty() && std::find(hold.nodes.begin(), hold.nodes.end(), node) != hold.nodes.end();
  });
}

}  // namespace

Body::Body(const TetMesh& mesh, const Material& material)
    : Body(mesh, std::vector<Material>(mesh.regions.size(), material)) {}

Body::Body(TetMesh mesh, std::vector<Material> of_regions)
    : mesh_(std::move(mesh)), materials_{std::move(of_regions), {}} {
  if (materials_.of_regions.size() != mesh_.regions.size())
    throw std::invalid_argument("a mesh of " + std::to_string(mesh_.regions.size()) + " regions has " +
                                std::to_string(materials_.of_regions.size()) + " materials");
  for (const Material& material : materials_.of_regions) material.validate();
  materials_.softest =
      *std::min_element(materials_.of_regions.begin(), materials_.of_regions.end(),
                        [](const Material& a, const Material& b) { return a.youngs_modulus_pa < b.youngs_modulus_pa; });
  check_mesh(mesh_);
  complete_boundary(mesh_);
  body_of_node_ = bodies_of_nodes(mesh_);
  size_m_ = (mesh_.nodes_m.rowwise().maxCoeff() - mesh_.nodes_m.rowwise().minCoeff()).norm();
  fixed_ = FixedAxes::Constant(3, mesh_.node_count(), false);
  dead_loads_n_ = Eigen::Matrix3Xd::Zero(3, mesh_.node_count());
  masses_.nodes_kg = masses_.own_weights_kg = masses_.hung_weights_kg = Eigen::VectorXd::Zero(mesh_.node_count());
  for (int e = 0; e < mesh_.tet_count(); ++e) {
    const double mass_kg = material_of(e).density_kg_m3 * rest_volume_m3(mesh_, e);
    for (Eigen::Index a = 0; a < mesh_.tets.rows(); ++a) {
      const double fraction = !mesh_.quadratic() ? 0.25 : a < 4 ? 1.0 / 36.0 : 4.0 / 27.0;
      masses_.nodes_kg[mesh_.tets(a, e)] += fraction * mass_kg;
      masses_.own_weights_kg[mesh_.tets(a, e)] +=
          fraction * mass_kg;  // as inertia is lumped, or free fall would strain
    }
  }
}

int Body::fix_nodes(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                    const Eigen::Matrix<bool, 3, 1>& axes) {
  return fix_nodes(box_min_m, box_max_m, axes, {}, "", std::nullopt);
}

int Body::fix_nodes(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                    const Eigen::Matrix<bool, 3, 1>& axes, std::vector<ObstaclePose> motion, std::string name,
                    std::optional<int> only_body) {
  check_hold(motion, axes);
  Hold hold{std::move(name), {}, axes, std::move(motion), Eigen::Vector3d::Zero()};
  Eigen::AlignedBox3d box;
  int count = 0;
  for (int node = 0; node < mesh_.node_count(); ++node) {
    if (!is_in(node, {box_min_m, box_max_m}, only_body)) continue;
    ++count;
    box.extend(mesh_.nodes_m.col(node));
    const bool taken = fixed_.col(node).any();
    const bool twice = taken && (fixed_.col(node).array() && axes.array()).any();
    if (twice && (!hold.motion.empty() || holder_moves(holds_, node)))
      throw std::invalid_argument("fixed: two regions hold the node at rest position " +
                                  point_text(mesh_.nodes_m.col(node)) + ", and one of them moves; choose boxes apart");
    fixed_.col(node) = fixed_.col(node).array() || axes.array();
    if (!twice) hold.nodes.push_back(node);
  }
  if (count > 0) hold.center_m = box.center();
  holds_.push_back(std::move(hold));
  return count;
}

bool Body::holds_move() const {
  return std::any_of(holds_.begin(), holds_.end(), [](const Hold& hold) { return !hold.motion.empty(); });
}

double Body::end_of_hold_motion_s() const {
  double end_s = 0.0;
  for (const Hold& hold : holds_)
    if (!hold.motion.empty()) end_s = std::max(end_s, hold.motion.back().time_s);
  return end_s;
}

bool Body::holds_move_between(double from_s, double to_s) const {
  return std::any_of(holds_.begin(), holds_.end(), [&](const Hold& hold) {
    return pose_at(hold.motion, hold.center_m, from_s).matrix() != pose_at(hold.motion, hold.center_m, to_s).matrix();
  });
}

void Body::place_held_nodes(double time_s, Eigen::Matrix3Xd& positions_m) const {
  for (const Hold& hold : holds_) {
    if (hold.motion.empty()) continue;
    const Eigen::Isometry3d pose = pose_at(hold.motion, hold.center_m, time_s);
    for (const int node : hold.nodes) {
      const Eigen::Vector3d there_m = pose * Eigen::Vector3d(mesh_.nodes_m.col(node));
      positions_m.col(node) = hold.axes.select(there_m, positions_m.col(node));
    }
  }
}

bool Body::is_in(int node, const Eigen::AlignedBox3d& box, std::optional<int> only_body) const {
  return (!only_body || body_of_node(node) == *only_body) && box.contains(mesh_.nodes_m.col(node));
}

// Integrals of the shape functions over the edges of boundary faces whose ends lie in the box (Simpson's rule), per
// node.
Eigen::VectorXd Body::edge_lengths_m(const Eigen::AlignedBox3d& box, std::optional<int> only_body) const {
  const TetMesh& mesh = mesh_;
  Eigen::VectorXd lengths_m = Eigen::VectorXd::Zero(mesh.node_count());
  std::set<std::pair<int, int>> seen;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    for (int side = 0; side < 3; ++side) {
      const int a = mesh.faces(side, face), b = mesh.faces((side + 1) % 3, face);
      if (!is_in(a, box, only_body) || !is_in(b, box, only_body)) continue;
      if (!seen.insert({std::min(a, b), std::max(a, b)}).second) continue;
      const double length_m = (mesh.nodes_m.col(a) - mesh.nodes_m.col(b)).norm();
      const bool quadratic = mesh.faces.rows() == 6;
      for (const int end : {a, b}) lengths_m[end] += length_m / (quadratic ? 6.0 : 2.0);
      if (quadratic) lengths_m[mesh.faces(3 + side, face)] += length_m * 2.0 / 3.0;
    }
  }
  return lengths_m;
}

// Integrals of the shape functions over the part of boundary faces that lies in the box, per node.
Eigen::VectorXd Body::areas_m2(const Eigen::AlignedBox3d& box, std::optional<int> only_body) const {
  const double on_side_m = std::min(kOnSide_m, kOnSide * size_m());
  Eigen::VectorXd areas_m2 = Eigen::VectorXd::Zero(mesh_.node_count());
  for (Eigen::Index face = 0; face < mesh_.faces.cols(); ++face) {
    if (only_body && body_of_node(mesh_.faces(0, face)) != *only_body) continue;
    const Eigen::VectorXd weights_m2 = face_weights_m2(mesh_, face, box, on_side_m);
    for (Eigen::Index a = 0; a < weights_m2.size(); ++a) areas_m2[mesh_.faces(a, face)] += weights_m2[a];
  }
  return areas_m2;
}

double Body::add_traction(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                          const Eigen::Vector3d& traction_pa, std::optional<int> only_body) {
  const Eigen::VectorXd areas_m2 = this->areas_m2({box_min_m, box_max_m}, only_body);
  const double area_m2 = areas_m2.sum();
  if (area_m2 > 0.0) load(traction_pa, areas_m2, {area_m2, area_m2 * traction_pa, 0.0});
  return area_m2;
}

void Body::add_force(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m, const Eigen::Vector3d& force_n,
                     std::optional<int> only_body) {
  const Eigen::AlignedBox3d box(box_min_m, box_max_m);
  const Eigen::VectorXd areas_m2 = this->areas_m2(box, only_body);
  const double area_m2 = areas_m2.sum();
  if (area_m2 > 0.0) return load(force_n, areas_m2 / area_m2, {area_m2, force_n, 0.0});
  const Eigen::VectorXd lengths_m = edge_lengths_m(box, only_body);
  if (!(lengths_m.sum() > 0.0))
    throw std::invalid_argument("force_n: no part of a boundary face, and no edge of one, lies inside the load's box");
  load(force_n, lengths_m / lengths_m.sum(), {0.0, force_n, 0.0});
}

void Body::add_force(const EmbeddedPoint& at, const Eigen::Vector3d& force_n) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(mesh_.node_count());
  for (std::size_t k = 0; k < at.nodes.size(); ++k) shares[at.nodes[k]] += at.weights[k];
  load(force_n, shares, {0.0, force_n, 0.0});
}

void Body::load(const Eigen::Vector3d& force_n, const Eigen::VectorXd& shares, const AppliedLoad& applied) {
  dead_loads_n_ += force_n * shares.transpose();
  loads_.push_back(applied);
}

void Body::hang(const EmbeddedPoint& at, double mass_kg) {
  if (!(mass_kg > 0.0) || !std::isfinite(mass_kg)) {
    std::ostringstream text;
    text << "mass_kg: " << mass_kg << " is out of range (0, inf)";
    throw std::invalid_argument(text.str());
  }
  double squares = 0.0;
  for (const double weight : at.weights) squares += weight * weight;
  for (std::size_t k = 0; k < at.nodes.size(); ++k) {
    masses_.nodes_kg[at.nodes[k]] += mass_kg * at.weights[k] * at.weights[k] / squares;
    masses_.hung_weights_kg[at.nodes[k]] += mass_kg * at.weights[k];
  }
  loads_.push_back({0.0, Eigen::Vector3d::Zero(), mass_kg});
}

void Body::set_linear_volume(LinearVolume volume) {
  if (volume == LinearVolume::vertex_averaged && mesh_.quadratic())
    throw std::invalid_argument("linear_volume: vertex_averaged is for element: linear, not quadratic");
  if (volume == LinearVolume::vertex_averaged && !one_material())
    throw std::invalid_argument("linear_volume: vertex_averaged knows one material, not several; choose element");
  linear_volume_ = volume;
}

bool Body::one_material() const {
  return std::all_of(materials_.of_regions.begin(), materials_.of_regions.end(),
                     [&](const Material& other) { return other == materials_.softest; });
}

void Body::add_fibre(Fibre fibre) {
  const std::vector<FibreGroup> groups =
      soft_robot_lab::fibre_groups(mesh_, fibre, static_cast<int>(fibres_.all.size()));
  fibres_.groups.insert(fibres_.groups.end(), groups.begin(), groups.end());
  fibres_.all.push_back(std::move(fibre));
}

void Body::set_viscosity(const Viscosity& viscosity) {
  viscosity.validate();
  viscosity_ = viscosity;
}

void Body::let_skin_touch(std::vector<TouchingBodies> pairs) {
  std::set<std::pair<int, int>> known;
  const auto count = static_cast<int>(mesh_.bodies.size());
  for (const TouchingBodies& pair : pairs) {
    std::ostringstream text;
    const auto [lower, upper] = std::minmax(pair.first, pair.second);
    if (lower < 0 || upper >= count)
      text << "contact of bodies " << pair.first << " and " << pair.second << ": there are " << count;
    else if (!(pair.friction >= 0.0) || !std::isfinite(pair.friction))
      text << "friction of skin on skin: " << pair.friction << " is out of range [0, inf)";
    else if (!known.emplace(lower, upper).second)
      text << "contact of '" << mesh_.bodies[static_cast<std::size_t>(pair.first)] << "' and '"
           << mesh_.bodies[static_cast<std::size_t>(pair.second)] << "' is given twice";
    if (!text.str().empty()) throw std::invalid_argument(text.str());
    if (lower != upper) refuse_overlap(*this, lower, upper);
  }
  touching_bodies_ = std::move(pairs);
}

void Body::let_touch_itself(double friction) {
  std::vector<TouchingBodies> all;
  const auto count = static_cast<int>(mesh_.bodies.size());
  for (int first = 0; first < count; ++first)
    for (int second = first; second < count; ++second) all.push_back({first, second, friction});
  let_skin_touch(std::move(all));
}

void Body::set_obstacles(std::vector<Obstacle> obstacles) {
  std::set<std::string> names;
  for (const Obstacle& obstacle : obstacles) {
    if (!names.insert(obstacle.name).second)
      throw std::invalid_argument("two obstacles are named '" + obstacle.name + "'");
    try {
      obstacle.validate();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("obstacle '" + obstacle.name + "': " + error.what());
    }
  }
  refuse_overlap(*this, obstacles);
  obstacles_ = std::move(obstacles);
}

int Body::fixed_node_count() const {
  int count = 0;
  for (Eigen::Index node = 0; node < fixed_.cols(); ++node) count += fixed_.col(node).any() ? 1 : 0;
  return count;
}

Eigen::Matrix3Xd Body::external_forces_n() const {
  return dead_loads_n_ + gravity_m_s2_ * (masses_.own_weights_kg + masses_.hung_weights_kg).transpose();
}

}  // namespace soft_robot_lab
