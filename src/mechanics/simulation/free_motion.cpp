// SPDX-License-Identifier: BSD-3-Clause
#include "free_motion.h"

#include <sstream>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "mechanics/body/contact_points.h"

namespace soft_robot_lab {
namespace {

using Gram = Eigen::Matrix<double, 6, 6>;
constexpr double kNothing = 1e-8;  // of the largest resistance, or of a direction

// What a place that resists along this direction adds: to translations, and to turns over the body's size.
void resist(const Eigen::Vector3d& arm, const Eigen::Vector3d& along, Gram& gram) {
  Eigen::Matrix<double, 6, 1> row;
  row << along, arm.cross(along);
  gram += row * row.transpose();
}

// The x, y, z within a space of directions, or the directions themselves where they lie askew.
std::string names(const Eigen::MatrixXd& columns) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(columns, Eigen::ComputeThinU);
  const Eigen::Index rank = (svd.singularValues().array() > 1e-6).count();
  const Eigen::MatrixXd space = svd.matrixU().leftCols(rank);
  std::ostringstream text;
  Eigen::Index named = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (space.row(axis).norm() < 1.0 - 1e-6) continue;
    text << (named++ > 0 ? ", " : "") << "xyz"[axis];
  }
  if (named == rank) return text.str();
  text.str("");
  for (Eigen::Index i = 0; i < rank; ++i)
    text << (i > 0 ? ", " : "") << "(" << space(0, i) << ", " << space(1, i) << ", " << space(2, i) << ")";
  return text.str();
}

void resist(const Eigen::Vector3d& arm, const Eigen::Vector3d& normal, bool rubs, Gram& gram) {
  resist(arm, normal, gram);
  if (!rubs) return;
  const Eigen::Vector3d across = normal.unitOrthogonal();
  resist(arm, across, gram);
  resist(arm, normal.cross(across), gram);
}

// "moving along y and turning about x"
std::string unresisted(const Gram& gram) {
  const Eigen::SelfAdjointEigenSolver<Gram> eigen(gram);
  const double most = eigen.eigenvalues()[5];
  const Eigen::Index count = (eigen.eigenvalues().array() <= kNothing * most).count();
  if (count == 0) return "";
  const Eigen::MatrixXd free = eigen.eigenvectors().leftCols(count);
  const Eigen::JacobiSVD<Eigen::MatrixXd> turns(free.bottomRows(3), Eigen::ComputeFullV);
  const Eigen::Index turning = (turns.singularValues().array() > 1e-6).count();
  const Eigen::MatrixXd moves = free * turns.matrixV().rightCols(count - turning);
  std::string text;
  if (moves.cols() > 0) text = "moving along " + names(moves.topRows(3));
  if (turning > 0)
    text += (text.empty() ? "turning about " : " and turning about ") +
            names((free * turns.matrixV().leftCols(turning)).bottomRows(3));
  return text;
}

}  // namespace

std::string free_motion(const ContactTerm& contact, int free, const ContactSums& touching) {
  Gram gram = Gram::Zero();
  const double size_m = contact.free().size_m(free);
  for (const ContactTouch& touch : touching.touches)
    if (touch.free == free && touch.pressure_pa > 0.0)
      resist(touch.arm_m / size_m, touch.normal, touch.rubs() && touch.friction.limit_pa > 0.0, gram);
  for (const RigidTouch& touch : touching.rigid) {
    const bool one = contact.rigid().free_of(touch.pair) == free,
               other = contact.rigid().other_free_of(touch.pair) == free;
    if ((one || other) && touch.force_n > 0.0)
      resist((one ? touch.arm_m : touch.other_arm_m) / size_m, touch.normal,
             touch.rubs() && touch.friction.limit_pa > 0.0, gram);
  }
  return unresisted(gram);
}

std::string free_motion(const Body& body, const Eigen::Matrix3Xd& positions_m, const ContactSums& touching) {
  const Eigen::Vector3d middle_m = positions_m.rowwise().mean();
  const auto arm = [&](const Eigen::Vector3d& at_m) { return Eigen::Vector3d((at_m - middle_m) / body.size_m()); };
  Gram gram = Gram::Zero();
  for (Eigen::Index node = 0; node < positions_m.cols(); ++node)
    for (int axis = 0; axis < 3; ++axis)
      if (body.fixed()(axis, node)) resist(arm(positions_m.col(node)), Eigen::Vector3d::Unit(axis), gram);
  for (const ContactTouch& touch : touching.touches) {
    if (touch.pressure_pa == 0.0 || touch.on_skin() || touch.free >= 0) continue;
    const Eigen::Vector3d place = arm(touching.points_m.col(touch.pair % touching.points_m.cols()));
    resist(place, touch.normal, touch.rubs() && touch.friction.limit_pa > 0.0, gram);
  }
  return unresisted(gram);
}

}  // namespace soft_robot_lab
