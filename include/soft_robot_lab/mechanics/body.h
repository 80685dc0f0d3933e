// SPDX-License-Identifier: BSD-3-Clause
// A silicone body, or several: what never changes while they are simulated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "embedding.h"
#include "material.h"
#include "obstacle.h"
#include "tet_mesh.h"
#include "viscosity.h"

namespace soft_robot_lab {

// What linear tetrahedra keep nearly constant: each its own volume, which locks in silicone, or the mean around each
// vertex.
enum class LinearVolume { element, vertex_averaged };

using FixedAxes = Eigen::Matrix<bool, 3, Eigen::Dynamic>;

// A held region of the body.
struct Hold {
  std::string name;        // empty: its place in the list stands for it
  std::vector<int> nodes;  // without those of the regions before it
  Eigen::Matrix<bool, 3, 1> axes;
  std::vector<ObstaclePose> motion;  // about its centre; empty: it stands still
  Eigen::Vector3d center_m;          // of the rest positions' box
};

// Two bodies of a mesh, or one and itself, whose skin meets.
struct TouchingBodies {
  int first = 0, second = 0;  // indices into TetMesh::bodies
  double friction = 0.0;      // Coulomb's coefficient
};

// What a load came to.
struct AppliedLoad {
  double area_m2 = 0.0;                               // loaded rest area; 0: it acts on edges or at a point
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  // in all
  double mass_kg = 0.0;                               // of what hangs there, with its weight beside the force
};

// Threads of one kind in the silicone, that neither bend nor slip and weigh nothing.
struct Fibre {
  std::string name;
  std::vector<std::vector<Eigen::Vector3d>> lines_m;  // through corners, in the rest shape
  double axial_stiffness_n = 0.0;                     // E A of each: its tension at a strain of 1
  bool only_tension = true;                           // in silicone a thin thread that is pushed buckles
};

// A fibre's threads in one element that go much the same way. They have one mean stretch, the sum of their chords over
// that at rest, as one of each would lock where they are many.
struct FibreGroup {
  int fibre = 0, tet = 0;
  Eigen::MatrixXd weights;  // the element's nodes x chords: a chord is nodes * weights
  double rest_length_m = 0.0;
};

// Dead loads are per undeformed area or volume and keep their direction. Frame: robot_base; SI units.
class Body {
 public:
  // Checks the mesh (check_mesh) and the material; nothing is fixed, no gravity.
  Body(const TetMesh& mesh, const Material& material);
  // The same with a material for each region of the mesh, in its order.
  Body(TetMesh mesh, std::vector<Material> of_regions);

  // Holds the listed axes of every node whose rest position lies in the box; returns how many nodes. Here and below
  // `only_body` of the mesh's bodies is looked at, or all.
  int fix_nodes(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                const Eigen::Matrix<bool, 3, 1>& axes);
  // The same of nodes that move so, as obstacles do; at time 0 they are where the mesh has them. Throws
  // std::invalid_argument for a motion out of range, one that turns what is not held along all axes, and nodes that
  // other regions hold too.
  int fix_nodes(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                const Eigen::Matrix<bool, 3, 1>& axes, std::vector<ObstaclePose> motion, std::string name,
                std::optional<int> only_body = std::nullopt);

  // On the part of each boundary face that lies in the box, with the weights of the face's shape functions; returns the
  // loaded rest area [m^2]. A corner that is no further than 2 um, or 1e-3 of the body's size, from a side of the box
  // counts as on it.
  double add_traction(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m,
                      const Eigen::Vector3d& traction_pa, std::optional<int> only_body = std::nullopt);
  // The same with a total force spread evenly over the area; over the edges of boundary faces that lie in the box where
  // no part of a face does. Throws std::invalid_argument where there is neither.
  void add_force(const Eigen::Vector3d& box_min_m, const Eigen::Vector3d& box_max_m, const Eigen::Vector3d& force_n,
                 std::optional<int> only_body = std::nullopt);

  // At a point of the body. It sinks in the more the finer the mesh is: no continuum carries a point force.
  void add_force(const EmbeddedPoint& at, const Eigen::Vector3d& force_n);

  // A mass fixed to a point: its weight acts there; its inertia is lumped on the point's nodes, the total exact. Throws
  // std::invalid_argument: mass_kg.
  void hang(const EmbeddedPoint& at, double mass_kg);

  // Throws std::invalid_argument for vertex_averaged on a quadratic mesh, or with several materials.
  void set_linear_volume(LinearVolume volume);

  // Its threads go with the elements that they lie in; what lies outside by less than a tenth of an element with the
  // nearest one. Throws std::invalid_argument: linear elements, a stiffness out of (0, 1e5] N, a line of one point,
  // too many pieces, and a line that leaves the body, with the place.
  void add_fibre(Fibre fibre);

  void set_viscosity(const Viscosity& viscosity);  // throws std::invalid_argument: Viscosity::validate

  // What the skin touches, where each stands at the start of its motion. Throws std::invalid_argument for a shape or
  // motion out of range, two of one name, and one that is inside the body, with depth and place.
  void set_obstacles(std::vector<Obstacle> obstacles);

  // Whose skin does not pass through whose. Throws std::invalid_argument: no such body, friction out of [0, inf), a
  // pair given twice, and two bodies of which one is inside the other, with depth and place.
  void let_skin_touch(std::vector<TouchingBodies> pairs);
  void let_touch_itself(double friction = 0.0);  // the same of all bodies, each with itself and with all others

  void set_gravity(const Eigen::Vector3d& gravity_m_s2) { gravity_m_s2_ = gravity_m_s2; }

  const TetMesh& mesh() const { return mesh_; }
  // Of several the softest, which sets the scale of forces and times.
  const Material& material() const { return materials_.softest; }
  const Material& material_of(int element) const { return materials_.of_regions[mesh_.region_of(element)]; }
  bool one_material() const;  // whether all elements are alike
  const std::vector<Fibre>& fibres() const { return fibres_.all; }
  const std::vector<FibreGroup>& fibre_groups() const { return fibres_.groups; }
  const Viscosity& viscosity() const { return viscosity_; }
  LinearVolume linear_volume() const { return linear_volume_; }
  const FixedAxes& fixed() const { return fixed_; }
  int fixed_node_count() const;
  int body_of_node(int node) const { return body_of_node_[static_cast<std::size_t>(node)]; }
  const std::vector<Hold>& holds() const { return holds_; }
  bool holds_move() const;
  double end_of_hold_motion_s() const;
  bool holds_move_between(double from_s, double to_s) const;
  // Puts the nodes of holds that move to where these are at a time.
  void place_held_nodes(double time_s, Eigen::Matrix3Xd& positions_m) const;
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  bool touches_itself() const { return !touching_bodies_.empty(); }
  const std::vector<TouchingBodies>& touching_bodies() const { return touching_bodies_; }
  const Eigen::VectorXd& node_masses_kg() const { return masses_.nodes_kg; }        // with what hangs on the body
  const Eigen::VectorXd& own_weights_kg() const { return masses_.own_weights_kg; }  // gravity's shares of the silicone
  const std::vector<AppliedLoad>& loads() const { return loads_; }  // in the order in which they were added
  const Eigen::Vector3d& gravity_m_s2() const { return gravity_m_s2_; }
  Eigen::Matrix3Xd external_forces_n() const;  // gravity and dead loads, 3 x nodes
  const Eigen::Matrix3Xd& dead_loads_n() const { return dead_loads_n_; }
  double size_m() const { return size_m_; }  // diagonal of the rest bounding box

 private:
  Eigen::VectorXd areas_m2(const Eigen::AlignedBox3d& box, std::optional<int> only_body) const;
  void load(const Eigen::Vector3d& force_n, const Eigen::VectorXd& shares, const AppliedLoad& applied);
  bool is_in(int node, const Eigen::AlignedBox3d& box, std::optional<int> only_body) const;
  Eigen::VectorXd edge_lengths_m(const Eigen::AlignedBox3d& box, std::optional<int> only_body) const;

  struct Materials {
    std::vector<Material> of_regions;
    Material softest;
  };
  struct Fibres {
    std::vector<Fibre> all;
    std::vector<FibreGroup> groups;
  };
  struct Masses {
    Eigen::VectorXd nodes_kg;  // lumped
    // As shape functions share weight: of the silicone, and of what hangs on it. May be negative.
    Eigen::VectorXd own_weights_kg, hung_weights_kg;
  };

  TetMesh mesh_;
  double size_m_ = 0.0;
  Materials materials_;
  Fibres fibres_;
  Viscosity viscosity_;
  LinearVolume linear_volume_ = LinearVolume::element;
  std::vector<int> body_of_node_;
  FixedAxes fixed_;
  std::vector<Hold> holds_;
  Masses masses_;
  std::vector<AppliedLoad> loads_;
  Eigen::Matrix3Xd dead_loads_n_;
  std::vector<Obstacle> obstacles_;
  std::vector<TouchingBodies> touching_bodies_;
  Eigen::Vector3d gravity_m_s2_ = Eigen::Vector3d::Zero();
};

}  // namespace soft_robot_lab
