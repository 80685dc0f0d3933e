// SPDX-License-Identifier: BSD-3-Clause
// Where points of the skin meet other skin, of the same body or another, in the present shape. Bullet's tree of boxes
// finds the faces that are near; the closest place on a face and the gap to it are ours, in double precision.
//
// No pairs are faces that share a node, and faces that lie wholly behind one another at rest, nearer than a few faces,
// but for those of one side, which may fold: the two sides of a thin wall. Nor are faces of which one is partly behind
// the other at rest, in a curved wall. Those of two bodies are where these touch at all.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "closest_place.h"
#include "mechanics/body/contact_points.h"
#include "present_faces.h"
#include "skin_at_rest.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// A place on the face that a point meets, and what the derivatives of the gap need there.
struct SkinPlace {
  template <int rows, int columns>
  using Table = Eigen::Matrix<double, rows, columns, Eigen::DontAlign>;

  int face = -1;                                 // of the mesh; -1: none
  double r = 0.0, s = 0.0;                       // coordinates on it
  Table<6, 1> shape = Table<6, 1>::Zero();       // functions of the face's nodes; the last are zero for 3 nodes
  Table<6, 2> slopes = Table<6, 2>::Zero();      // their derivatives along the face's two coordinates
  Table<3, 2> dual_per_m = Table<3, 2>::Zero();  // dual tangents: d coordinate / d position of the point
  double above_m = 0.0;                          // the gap
  std::shared_ptr<const PlaceAtEdge> at_edge;    // none, or not looked for: SkinContact::find_edges
};

struct SkinGap {
  double gap_m = 0.0;  // negative: the point is inside
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature_per_m = Eigen::Matrix3d::Zero();  // n . d2y, as the point above has it
  SkinPlace at;
};

struct SkinAnchor {
  int face;     // of the mesh
  double r, s;  // coordinates on it
};

// A point's face, in the order of ContactPoints, and the mesh's face that it may meet.
using FacePair = std::pair<int, int>;

class SkinPairs {
 public:
  SkinPairs() = default;  // none
  SkinPairs(const Body& body, const ContactPoints& points);

  // Looks at these pairs alone from now on, whatever is near; other nodes may stand anywhere then.
  void restrict_to(const std::vector<FacePair>& pairs);

  // Must come before the next three, at the same positions. What it finds serves until a node has moved far; so an
  // object serves one thread.
  void prepare(const Eigen::Matrix3Xd& positions_m);

  // The body of a mesh's face; and of a point's face and a mesh's the pair of bodies, -1: these do not touch.
  int body_of(int face) const { return rest_.body_of(face); }
  int pair_of(int face, int other) const { return rest_.pair_of(face, other); }

  bool any_near(int face) const { return !near_[static_cast<std::size_t>(face)].empty(); }
  // Whether anything of this face may be inside the body, by boxes; and whether this point of it may be, by those.
  bool may_be_inside(int face) const { return !overlaps_[static_cast<std::size_t>(face)].empty(); }
  bool may_be_inside(int face, const Eigen::Vector3d& point_m) const;
  // The closest skin that a point of this face meets at this place, or none within the depth that counts;
  // `outside_too`: also where the point is not inside.
  std::optional<SkinGap> meet(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                              bool outside_too, const Eigen::Matrix3Xd& positions_m) const;

  // None where the point is above the face.
  std::shared_ptr<const PlaceAtEdge> at_edge(const SkinPlace& met, const Eigen::Vector3d& point_m,
                                             const Eigen::Matrix3Xd& positions_m) const;

  // On a face that the point has met before: also beyond an edge of that, as if it went on, for a tenth of its size.
  std::optional<SkinGap> meet_again(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                    const Eigen::Matrix3Xd& positions_m) const;

  // Where friction ties a point of this face to: on the nearest face that faces it, or beyond an edge of that in its
  // plane, where the point is about to be covered. None where nothing is within a face's size.
  std::optional<SkinAnchor> anchor(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                   const Eigen::Matrix3Xd& positions_m) const;
  // The same on this face of the mesh; and how far away its closest place is.
  std::pair<SkinAnchor, double> anchor_on(int other, const Eigen::Vector3d& point_m,
                                          const Eigen::Matrix3Xd& positions_m) const;

  // How deep behind it skin still counts as inside: half its size, or all of the wall behind it.
  double deepest_m(int face) const { return rest_.deepest_m(face); }
  double least_deepest_m() const { return rest_.deepest_m().minCoeff(); }
  // Of the face's corners, at the positions of prepare().
  const Eigen::Vector3d& normal(int face) const { return present_[face].normal; }
  double smallest_size_m() const { return rest_.sizes_m().minCoeff(); }
  // Where a place of a face is.
  Eigen::Vector3d at(int face, double r, double s, const Eigen::Matrix3Xd& positions_m) const;

  int node(int face, int corner) const { return rest_.faces()(corner, face); }  // of the mesh's face
  std::vector<int> nodes(const FacePair& pair) const;                           // of both faces

 private:
  // Whether a point of this face of the points may be inside the body behind another face: their boxes meet, they do
  // not look the same way, and any of it lies lower than the top of the other.
  bool may_overlap(int face, int other) const;
  // How far nodes must move, but all alike, before that may be so, if by less than slack_m_; not above 0: it may now.
  double clear_m(int same, int other) const;
  // Both of the mesh: all of mine, where none of it is deeper behind the other.
  bool lies_beside(int mine, int other, double deepest_m) const;
  // Whether a face is not met from so far beside it by what is no farther from its plane, nor from the face itself.
  bool beyond_sides(int face, double beside_m, double along_m, double reach_m) const;
  // A face that a point may meet.
  struct Candidate {
    int face;
    double least_m;   // bound of the distance
    double beside_m;  // how far beside the face along its plane, at least; negative above it
    double along_m;   // how far from any of the face square to that, at most
  };
  Candidate candidate(int other, const Eigen::Vector3d& point_m) const;
  bool meets_within(const Candidate& candidate, double reach_m) const;  // false: there is no such meeting
  bool out_of_reach(int face, int other) const;                         // whether all of it is farther away than counts
  const std::vector<int>& in_reach_of(int face) const;                  // those of near_ that a point of it may meet
  bool is_behind(int other, const Eigen::Vector3d& point_m) const;      // or in front of it, but not above all of it
  // False where one look shows that a point with this normal does not meet the face.
  bool may_meet(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward) const;
  struct Meeting {
    int face;
    SeenPlace place;
    double way_m;  // to where the face is closest
  };
  bool is_inside(const Meeting& met) const;  // or just on it
  // Whether a point of this face is behind another, but outside by skin that is nearer: as in front of the other side
  // of a wedge.
  bool is_occluded(int face, const Meeting& behind, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                   const Eigen::Matrix3Xd& positions_m) const;
  bool is_outside(int other, const Meeting& behind, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                  const Eigen::Matrix3Xd& positions_m) const;
  std::optional<Meeting> meeting(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                 const Eigen::Matrix3Xd& positions_m) const;
  // Whether the point is inside by any one face, or just on it.
  bool is_inside_any(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                     const Eigen::Matrix3Xd& positions_m) const;
  SkinGap gap_at(const Meeting& met, const Eigen::Matrix3Xd& positions_m) const;
  double moved_m(const Eigen::Matrix3Xd& from_m) const;  // the farthest node of the skin since then, but all alike
  void find_near(const Eigen::Matrix3Xd& positions_m);
  void list_faces_in_pairs();
  void find_close(const Eigen::Matrix3Xd& positions_m);

  SkinAtRest rest_;
  double margin_m_ = 0.0, slack_m_ = 0.0;
  bool restricted_ = false;

  struct Close {
    int face;
    double clear_m;
  };
  // Per face of the points: those near it, until a node has moved by half of margin_m_ from near_at_m_, but all alike;
  // of these the ones that may overlap it, until a node has moved by slack_m_ from close_at_m_; and those that may now.
  Eigen::Matrix3Xd near_at_m_, close_at_m_;
  std::vector<std::vector<int>> near_, overlaps_;
  std::vector<std::vector<Close>> close_;
  std::vector<int> in_pairs_;                  // faces of the mesh that are in any of near_
  std::vector<int> any_close_;                 // faces of the points
  PresentFaces present_;                       // of the mesh, at the positions of prepare()
  mutable std::vector<Candidate> candidates_;  // of one point
  // Per face of the points, where it was asked for at the present positions.
  struct Reach {
    bool known = false;
    std::vector<int> others;
  };
  mutable std::vector<Reach> reach_;
};

}  // namespace soft_robot_lab
