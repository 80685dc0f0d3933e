// SPDX-License-Identifier: BSD-3-Clause
#include "contact_term.h"

#include <algorithm>
#include <cmath>

#include "mechanics/body/gap.h"

namespace soft_robot_lab {
namespace {

// By how much less a face may look at an obstacle than another that meets it in an edge (cosines).
constexpr double kLooksAway = 0.05, kPressedLooksAway = 0.1;

}  // namespace

void add_back(const ContactTouch& touch, const Eigen::Vector3d& force_n, FreeColumns& forces) {
  forces.col(2 * touch.free) -= force_n;
  forces.col(2 * touch.free + 1) -= touch.arm_m.cross(force_n);
}

ContactTerm::ContactTerm(const Body& body)
    : obstacles_(body.obstacles()),
      points_(obstacles_.empty() ? ContactPoints() : ContactPoints(body)),
      moduli_pa_(obstacles_.empty() ? Eigen::VectorXd() : moduli_of_faces_pa(body)(points_.mesh_faces())),
      free_(obstacles_, body.gravity_m_s2()),
      rigid_(obstacles_, free_) {
  int anchors = 0;
  for (const Obstacle& obstacle : obstacles_) {
    const bool rubs = obstacle.friction > 0.0;
    first_anchor_.push_back(rubs ? anchors : -1);
    if (rubs) anchors += points_.count();
  }
  if (body.touches_itself()) skin_ = SkinContact(body, obstacle_pairs(), anchors);
  for (const Obstacle& obstacle : obstacles_) nothing_.emplace_back().surface = obstacle.name;
  const auto name = [&](int of) { return body.mesh().bodies[static_cast<std::size_t>(of)]; };
  for (const TouchingBodies& pair : body.touching_bodies()) {
    ContactReading& reading = nothing_.emplace_back();
    reading.surface = kSkin;
    if (body.mesh().bodies.size() == 1) continue;
    reading.on = name(pair.first);
    reading.surface = name(pair.second);
  }
  anchor_count_ = anchors + (skin_.rubs() ? skin_.points().count() : 0);
}

std::vector<Clique> ContactTerm::cliques() const {
  std::vector<Clique> faces;
  for (int face = 0; face < points_.face_count(); ++face) {
    const auto nodes = points_.faces().col(face);
    faces.emplace_back(nodes.begin(), nodes.end());
  }
  return faces;
}

NormalLaw ContactTerm::law(const ContactTouch& touch) const {
  return of_skin(touch.pair) ? skin_.law(touch) : law_on_obstacle(point_of(touch.pair));
}

NormalLaw ContactTerm::law_on_obstacle(int point) const {
  return NormalLaw::of_skin(points_.face_size_m(point), moduli_pa_[points_.face_of(point)]);
}

ContactState ContactTerm::untouched(const Eigen::Matrix3Xd& positions_m, double time_s) const {
  ContactState state;
  if (empty()) return state;
  state.time_s = time_s;
  state.pressures_pa = Eigen::VectorXd::Zero(pair_count());
  state.anchors_m = Eigen::Matrix3Xd::Zero(3, anchor_count_);
  state.free = state.free_before = free_.at_start();
  state.before_s = time_s;
  state.rigid_forces_n = Eigen::VectorXd::Zero(rigid_.pair_count());
  state.rigid_ties_m = Eigen::Matrix3Xd::Zero(3, rigid_.pair_count());
  commit(positions_m, state);
  return state;
}

Eigen::Matrix3Xd ContactTerm::all_points(const Eigen::Matrix3Xd& positions_m) const {
  Eigen::Matrix3Xd all(3, points_.count());
  for (int point = 0; point < points_.count(); ++point) all.col(point) = points_.at(point, positions_m);
  return all;
}

ContactSums ContactTerm::sums(const Eigen::Matrix3Xd& positions_m, const ContactState& state) const {
  ContactSums sums;
  if (empty()) return sums;
  sums.points_m = all_points(positions_m);
  for (std::size_t i = 0; i < obstacles_.size(); ++i) find_touches(static_cast<int>(i), positions_m, state, sums);
  if (skin_.pair_count() > 0) skin_.find_touches(positions_m, state, sums.touches);
  if (skin_.rubs()) sums.positions_m = positions_m;
  for (const ContactTouch& touch : sums.touches) {
    const double off_m = law(touch).mismatch_m(touch.gap_m, touch.pressure_pa);
    sums.mismatch = std::max(sums.mismatch, std::abs(off_m) / face_size_m(touch));
  }
  if (free_.count() == 0) return sums;
  sums.free = state.free;
  sums.rigid = rigid_.touches(state);
  sums.mismatch = std::max(sums.mismatch, rigid_.mismatch(sums.rigid));
  return sums;
}

Eigen::Isometry3d ContactTerm::pose_of(int obstacle, const ContactState& state) const {
  const int free = free_.index_of(obstacle);
  return free >= 0 ? free_.pose(free, state.free)
                   : pose_at(obstacles_[static_cast<std::size_t>(obstacle)], state.time_s);
}

// A gap grows no faster than its point moves, so a face that is far away is passed by at one look.
void ContactTerm::find_touches(int obstacle, const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                               ContactSums& sums) const {
  const Obstacle& one = obstacles_[static_cast<std::size_t>(obstacle)];
  const Eigen::Isometry3d pose = pose_of(obstacle, state);
  const int free = free_.index_of(obstacle);
  const bool flat = is_flat(one.shape);
  for (int face = 0; face < points_.face_count(); ++face) {
    const int first = points_.first_point(face), count = points_.first_point(face + 1) - first;
    const int first_pair = obstacle * points_.count() + first;
    const auto places_m = sums.points_m.middleCols(first, count);
    const Eigen::Vector3d middle_m = places_m.rowwise().mean();
    const double reach_m = (places_m.colwise() - middle_m).colwise().norm().maxCoeff();
    if (state.pressures_pa.segment(first_pair, count).isZero(0.0) &&
        gap_to(one.shape, pose, middle_m).gap_m > reach_m + 1e-12)
      continue;
    for (int k = 0; k < count; ++k) {
      if (!points_.serves(first + k, flat)) continue;
      const int pair = first_pair + k;
      const Gap gap = gap_to(one.shape, pose, places_m.col(k));
      const double pressure_pa = state.pressures_pa[pair];
      const double margin = pressure_pa > 0.0 ? kPressedLooksAway : kLooksAway;
      const bool closed = law_on_obstacle(first + k).closed(gap.gap_m, pressure_pa) &&
                          points_.looks_most(first + k, -gap.normal, margin, positions_m);
      if (!closed && pressure_pa == 0.0) continue;
      ContactTouch touch{pair, closed, gap.gap_m, pressure_pa, gap.normal, gap.hessian, {}};
      touch.free = free;
      if (free >= 0) touch.arm_m = places_m.col(k) - state.free.centers_m.col(free);
      if (one.friction > 0.0) add_friction(pose, obstacle, state, sums, touch);
      sums.touches.push_back(std::move(touch));
    }
  }
}

void ContactTerm::add_friction(const Eigen::Isometry3d& pose, int obstacle, const ContactState& state,
                               const ContactSums& sums, ContactTouch& touch) const {
  const int point = point_of(touch.pair);
  touch.friction = {FrictionLaw::compliance_of_skin(points_.face_size_m(point), moduli_pa_[points_.face_of(point)]),
                    obstacle_of(touch.pair).friction * touch.pressure_pa};
  touch.anchor_m = pose * state.anchors_m.col(first_anchor_[static_cast<std::size_t>(obstacle)] + point);
  touch.set_way_m(sums.points_m.col(point) - touch.anchor_m);
}

void ContactTerm::add_at(const ContactTouch& touch, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& forces_n) const {
  const ContactPoints& points = points_of(touch.pair);
  const int point = point_of(touch.pair), face = points.face_of(point);
  const auto shape = points.shape(point);
  for (int a = 0; a < points.nodes_per_face(); ++a) forces_n.col(points.node(face, a)) += shape[a] * force_n;
  if (touch.on_skin()) skin_.add_back(touch, force_n, forces_n);
}

Eigen::Vector3d ContactTerm::relative_motion_m(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                               const FreeColumns& free_motion) const {
  if (touch.on_skin()) return relative_m(skin_, touch, motion_m);
  Eigen::Vector3d relative_m = points_of(touch.pair).at(point_of(touch.pair), motion_m);
  if (touch.free >= 0)
    relative_m -=
        free_motion.col(2 * touch.free) + Eigen::Vector3d(free_motion.col(2 * touch.free + 1)).cross(touch.arm_m);
  return relative_m;
}

Eigen::Vector3d ContactTerm::force_n(const ContactTouch& touch) const {
  Eigen::Vector3d force_pa = -touch.pressure_pa * touch.normal;
  if (touch.rubs()) force_pa += touch.friction.traction_pa(touch.away_m);
  return weight_m2(touch.pair) * force_pa;
}

void ContactTerm::add_forces(const ContactSums& at, Eigen::Matrix3Xd& residual_n) const {
  for (const ContactTouch& touch : at.touches) add_at(touch, force_n(touch), residual_n);
}

FreeColumns ContactTerm::free_forces_n(const ContactSums& at) const {
  FreeColumns forces = FreeColumns::Zero(3, 2 * free_.count());
  for (const ContactTouch& touch : at.touches)
    if (touch.free >= 0) add_back(touch, force_n(touch), forces);
  rigid_.add_forces(at.rigid, forces);
  return forces;
}

// dn = H d(x - y) + turn x n, and the arm turns with the point: derivatives of w l n on the nodes, of -w l n and of
// -w l arm x n on the obstacle.
void ContactTerm::add_free_hessian(const std::vector<ContactTouch>& touches, bool convex, Eigen::MatrixXd& border,
                                   Eigen::MatrixXd& own) const {
  const auto cross = [](const Eigen::Vector3d& v) {
    return (Eigen::Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
  };
  for (const ContactTouch& touch : touches) {
    if (!touch.closed || touch.free < 0) continue;
    const double weight_m2 = this->weight_m2(touch.pair), push_n = convex ? 0.0 : weight_m2 * touch.pressure_pa;
    Eigen::Matrix3d block = weight_m2 / law(touch).compliance_m_pa * touch.normal * touch.normal.transpose();
    block -= push_n * touch.bend;
    if (touch.rubs()) block += weight_m2 * touch.friction.stiffness_pa_m(touch.away_m, touch.normal);
    const Eigen::Matrix3d arm = cross(touch.arm_m), normal = cross(touch.normal);
    Eigen::Matrix<double, 3, 6> way;  // of the obstacle at the point
    way << Eigen::Matrix3d::Identity(), -arm;
    Eigen::Matrix<double, 3, 6> coupling = -block * way;
    coupling.rightCols<3>() += push_n * normal;
    Eigen::Matrix<double, 6, 6> of_one = way.transpose() * block * way;
    of_one.topRightCorner<3, 3>() -= push_n * normal;
    of_one.bottomLeftCorner<3, 3>() += push_n * normal;
    of_one.bottomRightCorner<3, 3>() -= 0.5 * push_n * (arm * normal + normal * arm);
    const int point = point_of(touch.pair), face = points_.face_of(point), first = 6 * touch.free;
    own.block<6, 6>(first, first) += of_one;
    for (int a = 0; a < points_.nodes_per_face(); ++a)
      border.block<3, 6>(3 * points_.node(face, a), first) += points_.shape(point)[a] * coupling;
  }
}

void ContactTerm::add_hessian(const std::vector<ContactTouch>& touches, bool convex, bool soft,
                              CliqueSink& matrix) const {
  const int nodes = points_.nodes_per_face();
  for (const ContactTouch& touch : touches) {
    if (!touch.closed || touch.on_skin()) continue;
    const NormalLaw normal = law(touch);
    const double compliance_m_pa = soft ? normal.soft_m_pa : normal.compliance_m_pa;
    Eigen::Matrix3d block = touch.normal * touch.normal.transpose() / compliance_m_pa;
    if (!convex) block -= touch.pressure_pa * touch.bend;
    if (touch.rubs()) block += touch.friction.stiffness_pa_m(touch.away_m, touch.normal);
    const auto shape = points_.shape(point_of(touch.pair));
    matrix.add_outer(face_of(touch.pair), {shape.data(), shape.data() + nodes}, weight_m2(touch.pair) * block);
  }
}

int ContactTerm::nodes_of(const ContactTouch& touch, std::array<int, 12>& nodes, std::array<double, 12>& shares) const {
  const ContactPoints& points = points_of(touch.pair);
  const int point = point_of(touch.pair), face = points.face_of(point), per_face = points.nodes_per_face();
  int count = 0;
  const auto add = [&](int node, double share) {
    nodes[static_cast<std::size_t>(count)] = node;
    shares[static_cast<std::size_t>(count++)] = share;
  };
  for (int a = 0; a < per_face; ++a) add(points.node(face, a), points.shape(point)[a]);
  for (int a = 0; touch.on_skin() && a < per_face; ++a) add(skin_.pairs().node(touch.met.face, a), -touch.met.shape[a]);
  return count;
}

void ContactTerm::commit(const Eigen::Matrix3Xd& positions_m, ContactState& state) const {
  if (free_.count() > 0) rigid_.commit(state);
  if (state.anchors_m.cols() == 0) return;
  skin_.commit(positions_m, state);
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    if (first_anchor_[i] < 0) continue;
    const Eigen::Isometry3d back = pose_of(static_cast<int>(i), state).inverse();
    ContactSums sums;
    sums.points_m = all_points(positions_m);
    find_touches(static_cast<int>(i), positions_m, state, sums);
    for (const ContactTouch& touch : sums.touches)
      if (touch.pressure_pa > 0.0)
        sums.points_m.col(point_of(touch.pair)) -=
            touch.friction.compliance_m_pa * touch.friction.traction_pa(touch.away_m);
    for (int point = 0; point < points_.count(); ++point)
      state.anchors_m.col(first_anchor_[i] + point) = back * sums.points_m.col(point);
  }
}

ContactReading& ContactTerm::reading_of(const ContactTouch& touch, std::vector<ContactReading>& all) const {
  if (!of_skin(touch.pair)) return all[static_cast<std::size_t>(touch.pair / points_.count())];
  return all[obstacles_.size() + static_cast<std::size_t>(skin_.pair_of(touch))];
}

// Skin on skin has two sides, and each its points.
std::vector<ContactReading> ContactTerm::readings(const Eigen::Matrix3Xd& positions_m,
                                                  const ContactState& state) const {
  std::vector<ContactReading> all = nothing_;
  for (const ContactTouch& touch : sums(positions_m, state).touches) {
    if (of_skin(touch.pair) && !touch.on_skin()) continue;  // it lost the skin that it pressed against
    ContactReading& reading = reading_of(touch, all);
    reading.largest_penetration_m = std::max(reading.largest_penetration_m, slack_m(touch.pair) - touch.gap_m);
    if (touch.pressure_pa == 0.0) continue;
    const ContactPoints& points = points_of(touch.pair);
    const int point = point_of(touch.pair), side = touch.on_skin() ? skin_.side_of(touch) : 1;
    const double area_m2 = (touch.on_skin() ? 0.5 : 1.0) * points.present_area_m2(point, positions_m);
    if (touch.rubs())
      (touch.friction.at_limit(touch.away_m) ? reading.slipping_area_m2 : reading.sticking_area_m2) += area_m2;
    const double push_n = weight_m2(touch.pair) * touch.pressure_pa;
    reading.force_n -= side * force_n(touch);
    reading.normal += side * push_n * touch.normal;
    reading.normal_force_n += push_n;
    reading.center_m += push_n * points.at(point, positions_m);
    reading.area_m2 += area_m2;
    reading.largest_pressure_pa = std::max(reading.largest_pressure_pa, touch.pressure_pa);
  }
  for (ContactReading& reading : all) finish(reading);
  if (free_.count() == 0) return all;
  for (ContactReading& reading : rigid_.readings(state)) all.push_back(std::move(reading));
  return all;
}

}  // namespace soft_robot_lab
