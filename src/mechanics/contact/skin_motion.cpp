// SPDX-License-Identifier: BSD-3-Clause
#include "skin_motion.h"

namespace soft_robot_lab {
namespace {

// How the nodes of the face that is met move along its normal, along its two coordinates.
Eigen::Vector2d tilt_of(const SkinContact& skin, const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m) {
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
  for (int a = 0; a < skin.points().nodes_per_face(); ++a)
    tilt += touch.met.slopes.row(a).transpose() * touch.normal.dot(motion_m.col(skin.pairs().node(touch.met.face, a)));
  return tilt;
}

}  // namespace

double SkinGradient::dot(const double* columns) const {
  double sum = 0.0;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (int axis = 0; axis < 3; ++axis)
      sum += at_nodes(axis, static_cast<Eigen::Index>(a)) * columns[3 * nodes[a] + axis];
  return sum;
}

SkinGradient gradient_of(const SkinContact& skin, const ContactTouch& touch) {
  const int nodes = skin.points().nodes_per_face(), point = skin.point_of(touch);
  SkinGradient gradient{touch.pair, touch.met.face, skin.pairs().nodes(skin.faces_of(touch)),
                        Eigen::Matrix3Xd(3, 2 * nodes)};
  for (int a = 0; a < nodes; ++a) {
    gradient.at_nodes.col(a) = -skin.points().shape(point)[a] * touch.normal;
    gradient.at_nodes.col(nodes + a) = touch.met.shape[a] * touch.normal;
  }
  return gradient;
}

// As the normal turns: dn = -dual n.(slopes dx) - bend d(x - y). At an edge that turns as its place moves.
SkinPlaceMotion place_motion(const SkinContact& skin, const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                             const Eigen::Matrix3Xd& motion_m) {
  const SkinPlace& met = touch.met;
  const Eigen::Vector2d tilt = tilt_of(skin, touch, motion_m);
  const double gap_m = touch.normal.dot(relative_m);
  if (!met.at_edge)
    return {met.dual_per_m.transpose() * (relative_m + met.above_m * met.dual_per_m * tilt),
            -met.dual_per_m * tilt - touch.bend * relative_m, gap_m};
  double along = met.at_edge->by_way_per_m.dot(relative_m);
  for (int a = 0; a < skin.points().nodes_per_face(); ++a)
    along += met.at_edge->by_nodes_per_m.col(a).dot(motion_m.col(skin.pairs().node(met.face, a)));
  const Eigen::Vector2d local = along * met.at_edge->along;
  const Eigen::Vector3d turn = -met.at_edge->dual_per_m * (tilt + met.at_edge->curvature_m * local);
  return {local, turn, gap_m + turn.dot(met.at_edge->beyond_m)};
}

Eigen::Vector3d away_motion_m(const SkinContact& skin, const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                              const Eigen::Matrix3Xd& motion_m) {
  const Eigen::Vector3d& anchor = touch.anchored_at;
  const Eigen::Vector3d way_m = skin.points().at(skin.point_of(touch), motion_m) -
                                skin.pairs().at(static_cast<int>(anchor.z()), anchor.x(), anchor.y(), motion_m);
  return touch.along_surface(way_m, place_motion(skin, touch, relative_m, motion_m).turn);
}

void add_back_moved(const SkinContact& skin, const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                    const Eigen::Matrix3Xd& motion_m, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& forces_n) {
  const Eigen::Vector2d along = place_motion(skin, touch, relative_m, motion_m).local;
  for (int a = 0; a < skin.points().nodes_per_face(); ++a)
    forces_n.col(skin.pairs().node(touch.met.face, a)) -= touch.met.slopes.row(a).dot(along) * force_n;
}

}  // namespace soft_robot_lab
