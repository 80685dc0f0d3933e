// SPDX-License-Identifier: BSD-3-Clause
#include "skin_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace soft_robot_lab {
namespace {

// Of a step along which skin may be carried into skin, in faces' sizes.
constexpr double kShortWay = 0.2, kPartOfWay = 1.0, kMostParts = 8.0;
// Of the least depth that counts, and half of that as two bodies may go against each other: no part of a way is left
// out on which skin is too deep.
constexpr double kBetweenLooks = 0.3, kMostLooks = 1000.0;
constexpr double kTooDeep = 0.4;      // of the depth that counts
constexpr double kDeeper = 1.1;       // times where the step starts
constexpr double kGuarded = 5e-4;     // of a face's size: guards hold only what sinks in deeper
constexpr int kAnchorings = 3;        // looks for where a point that slipped is tied to
constexpr double kFarFromLaw = 1e-3;  // of a face's size: pressures that mean little, nor how they turn with the skin

}  // namespace

SkinContact::SkinContact(const Body& body, int first_pair, int first_anchor)
    : points_(body, PointSpread::dense),
      pairs_(body, points_),
      touching_(body.touching_bodies()),
      rubs_(std::any_of(touching_.begin(), touching_.end(), [](const auto& pair) { return pair.friction > 0.0; })),
      moduli_pa_(moduli_of_faces_pa(body)),
      first_pair_(first_pair),
      first_anchor_(first_anchor) {}

Eigen::Vector3d SkinContact::outward(int point, const Eigen::Matrix3Xd& positions_m) const {
  if (!points_.guards(point)) return points_.outward_m2(point, positions_m);
  return pairs_.normal(points_.mesh_faces()[static_cast<std::size_t>(points_.face_of(point))]) +
         pairs_.normal(points_.beside(point));
}

double SkinContact::youngs_modulus_pa(const ContactTouch& touch) const {
  const int face = points_.face_of(point_of(touch));
  const double own_pa = moduli_pa_[points_.mesh_faces()[static_cast<std::size_t>(face)]];
  return touch.on_skin() ? std::min(own_pa, moduli_pa_[touch.met.face]) : own_pa;
}

double SkinContact::slack_m(int point) const {
  return points_.guards(point) ? kGuarded * points_.face_size_m(point) : 0.0;
}

void SkinContact::find_touches(const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                               std::vector<ContactTouch>& touches) const {
  const auto pressures_pa = state.pressures_pa.segment(first_pair_, points_.count());
  const auto anchors_m = state.anchors_m.middleCols(first_anchor_, rubs_ ? points_.count() : 0);
  if (!found_.at(positions_m, pressures_pa, anchors_m)) {
    found_ = {positions_m, pressures_pa, anchors_m, {}};
    search(positions_m, state, found_.touches);
  }
  touches.insert(touches.end(), found_.touches.begin(), found_.touches.end());
}

void SkinContact::keep_faces(const std::vector<ContactTouch>& touches) {
  if (kept_.empty()) kept_.assign(static_cast<std::size_t>(points_.count()), -1);
  for (const ContactTouch& touch : touches)
    if (touch.on_skin() && touch.closed) kept_[static_cast<std::size_t>(point_of(touch))] = touch.met.face;
  found_ = {};
}

void SkinContact::let_faces_go() {
  kept_.clear();
  found_ = {};
}

bool SkinContact::keeps_any(int first, int end) const {
  return keeps_faces() && std::any_of(kept_.begin() + first, kept_.begin() + end, [](int face) { return face >= 0; });
}

void SkinContact::search(const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                         std::vector<ContactTouch>& touches) const {
  pairs_.prepare(positions_m);
  for (int face = 0; face < points_.face_count(); ++face) {
    const int first = points_.first_point(face), end = points_.first_point(face + 1);
    const bool pressed = !state.pressures_pa.segment(first_pair_ + first, end - first).isZero(0.0);
    if (!pressed && !pairs_.may_be_inside(face) && !keeps_any(first, end)) continue;
    for (int point = first; point < end; ++point) add_touch(point, positions_m, state, touches);
  }
}

std::optional<SkinGap> SkinContact::met_by(int point, bool pressed, const Eigen::Matrix3Xd& positions_m) const {
  const int face = points_.face_of(point);
  const Eigen::Vector3d at_m = points_.at(point, positions_m);
  if (keeps_any(point, point + 1)) {
    const int kept = kept_[static_cast<std::size_t>(point)];
    std::optional<SkinGap> met = pairs_.meet_again(kept, at_m, outward(point, positions_m), positions_m);
    if (met) return met;
  }
  if (!pressed && !pairs_.may_be_inside(face, at_m)) return std::nullopt;
  return pairs_.meet(face, at_m, outward(point, positions_m), pressed, positions_m);
}

// A point that has lost the skin it pressed against is a face's size away from it: open.
bool SkinContact::find_touch(int point, double pressure_pa, const Eigen::Matrix3Xd& positions_m,
                             ContactTouch& touch) const {
  touch.pair = first_pair_ + point;
  touch.pressure_pa = pressure_pa;
  const std::optional<SkinGap> met = met_by(point, pressure_pa != 0.0, positions_m);
  touch.gap_m = met ? met->gap_m + slack_m(point) : points_.face_size_m(point);
  if (met) {
    touch.normal = met->normal;
    touch.bend = met->curvature_per_m;
    touch.met = met->at;
  }
  touch.closed = met && law(touch).closed(touch.gap_m, pressure_pa);
  return touch.closed || pressure_pa != 0.0;
}

void SkinContact::add_touch(int point, const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                            std::vector<ContactTouch>& touches) const {
  ContactTouch touch;
  if (!find_touch(point, state.pressures_pa[first_pair_ + point], positions_m, touch)) return;
  if (rubs_ && touch.on_skin() && friction(touch) > 0.0) add_friction(positions_m, state, touch);
  touches.push_back(std::move(touch));
}

void SkinContact::add_friction(const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                               ContactTouch& touch) const {
  const int point = point_of(touch);
  const Eigen::Vector3d anchor = state.anchors_m.col(first_anchor_ + point);
  if (anchor.z() < 0.0) return;
  touch.friction = {FrictionLaw::compliance_of_skin(points_.face_size_m(point), youngs_modulus_pa(touch)),
                    friction(touch) * touch.pressure_pa};
  touch.anchored_at = anchor;
  touch.anchor_m = at_anchor(anchor, positions_m);
  touch.set_way_m(points_.at(point, positions_m) - touch.anchor_m);
}

int SkinContact::side_of(const ContactTouch& touch) const {
  const TouchingBodies& pair = touching_[static_cast<std::size_t>(pair_of(touch))];
  if (pair.first == pair.second) return 0;
  return pairs_.body_of(touch.met.face) == pair.second ? 1 : -1;
}

bool far_from_law(const SkinContact& skin, const ContactTouch& touch) {
  return std::abs(skin.law(touch).mismatch_m(touch.gap_m, touch.pressure_pa)) >
         kFarFromLaw * skin.points().face_size_m(skin.point_of(touch));
}

Eigen::MatrixXd hessian_of_turn(const ContactTouch& touch, const Eigen::MatrixXd& turn, const Eigen::MatrixXd& local) {
  const Eigen::MatrixXd turned = turn.transpose() * local, tilts = touch.met.dual_per_m * turn;
  return turned + turned.transpose() + touch.met.above_m * tilts.transpose() * tilts;
}

Eigen::MatrixXd SkinContact::hessian(const ContactTouch& touch, bool convex, bool soft) const {
  const int nodes = points_.nodes_per_face(), point = point_of(touch);
  const NormalLaw normal = law(touch);
  const double weight_m2 = points_.weight_m2(point);
  Eigen::VectorXd shape(2 * nodes);
  shape << points_.shape(point), -touch.met.shape.head(nodes);
  // Rows of the gap's derivatives: of itself, of the coordinates where it is met, of the normal's turning.
  Eigen::MatrixXd gap(1, 6 * nodes), local(2, 6 * nodes), turn = Eigen::MatrixXd::Zero(2, 6 * nodes);
  for (int a = 0; a < 2 * nodes; ++a) {
    gap.middleCols<3>(3 * a) = shape[a] * touch.normal.transpose();
    local.middleCols<3>(3 * a) = shape[a] * touch.met.dual_per_m.transpose();
    if (a >= nodes) turn.middleCols<3>(3 * a) = touch.met.slopes.row(a - nodes).transpose() * touch.normal.transpose();
  }
  Eigen::MatrixXd sum = gap.transpose() * gap * (weight_m2 / (soft ? normal.soft_m_pa : normal.compliance_m_pa));
  // What joins the motions of the two places.
  Eigen::Matrix3d tie = Eigen::Matrix3d::Zero();
  if (touch.rubs()) tie += weight_m2 * touch.friction.stiffness_pa_m(touch.away_m, touch.normal);
  if (!convex && !far_from_law(*this, touch)) {
    const double push_n = weight_m2 * touch.pressure_pa;
    sum += push_n * hessian_of_turn(touch, turn, local);
    tie += push_n * touch.bend;
  }
  for (int a = 0; a < 2 * nodes; ++a)
    for (int b = 0; b < 2 * nodes; ++b) sum.block<3, 3>(3 * a, 3 * b) += shape[a] * shape[b] * tie;
  return sum;
}

Eigen::Vector3d relative_m(const SkinContact& skin, const ContactTouch& touch, const Eigen::Matrix3Xd& columns) {
  Eigen::Vector3d relative_m = skin.points().at(skin.point_of(touch), columns);
  for (int a = 0; a < skin.points().nodes_per_face(); ++a)
    relative_m -= touch.met.shape[a] * columns.col(skin.pairs().node(touch.met.face, a));
  return relative_m;
}

void SkinContact::find_edges(const Eigen::Matrix3Xd& positions_m, std::vector<ContactTouch>& touches) const {
  for (ContactTouch& touch : touches)
    if (touch.closed && touch.on_skin())
      touch.met.at_edge = pairs_.at_edge(touch.met, points_.at(point_of(touch), positions_m), positions_m);
}

void SkinContact::add_back(const ContactTouch& touch, const Eigen::Vector3d& force_n,
                           Eigen::Matrix3Xd& forces_n) const {
  for (int a = 0; a < points_.nodes_per_face(); ++a)
    forces_n.col(pairs_.node(touch.met.face, a)) -= touch.met.shape[a] * force_n;
}

double SkinContact::deepest(const Eigen::Matrix3Xd& positions_m) const {
  pairs_.prepare(positions_m);
  double deepest = 0.0;
  for (int face = 0; face < points_.face_count(); ++face) {
    if (!pairs_.may_be_inside(face)) continue;
    for (int point = points_.first_point(face); point < points_.first_point(face + 1); ++point) {
      const std::optional<SkinGap> met = met_by(point, false, positions_m);
      if (met) deepest = std::max(deepest, -met->gap_m / pairs_.deepest_m(met->at.face));
    }
  }
  return deepest;
}

double SkinContact::first_length(const Eigen::Matrix3Xd& positions_m, const Eigen::Matrix3Xd& motion_m) const {
  if (points_.count() == 0) return 1.0;
  const double way = motion_m.colwise().norm().maxCoeff() / pairs_.smallest_size_m();
  if (way < kShortWay) return 1.0;
  const int parts = static_cast<int>(std::clamp(std::ceil(way / kPartOfWay), 1.0, kMostParts));
  const double too_deep = std::max(kTooDeep, kDeeper * deepest(positions_m));
  for (int part = 1; part <= parts; ++part)
    if (deepest(positions_m + motion_m * part / parts) > too_deep) return std::max(part - 1.0, 0.5) / parts;
  return 1.0;
}

bool SkinContact::passes(const Eigen::Matrix3Xd& from_m, const Eigen::Matrix3Xd& to_m) const {
  if (points_.count() == 0) return false;
  Eigen::Matrix3Xd way_m = to_m - from_m;
  const double way = (way_m.colwise() - way_m.rowwise().mean()).colwise().norm().maxCoeff() / pairs_.least_deepest_m();
  if (way < kShortWay) return false;
  const int looks = static_cast<int>(std::clamp(std::ceil(way / kBetweenLooks), 1.0, kMostLooks));
  const double too_deep = std::max(kTooDeep, kDeeper * deepest(from_m));
  for (int look = 1; look <= looks; ++look)
    if (deepest(from_m + way_m * look / looks) > too_deep) return true;
  return false;
}

// Where a point sticks its anchor stays to the last bit: what sticks does not creep.
void SkinContact::commit(const Eigen::Matrix3Xd& positions_m, ContactState& state) const {
  if (!rubs_) return;
  std::vector<ContactTouch> touches;
  find_touches(positions_m, state, touches);
  std::vector<const ContactTouch*> pressed(static_cast<std::size_t>(points_.count()), nullptr);
  for (const ContactTouch& touch : touches)
    if (touch.pressure_pa > 0.0 && touch.rubs()) pressed[static_cast<std::size_t>(point_of(touch))] = &touch;
  for (int point = 0; point < points_.count(); ++point) {
    const ContactTouch* touch = pressed[static_cast<std::size_t>(point)];
    if (touch && !touch->friction.slips(touch->away_m)) continue;
    state.anchors_m.col(first_anchor_ + point) = new_anchor(point, touch, positions_m);
  }
}

// What slips goes on on the face that it meets, whose plane beyond the closest place is not quite where it lies.
Eigen::Vector3d SkinContact::new_anchor(int point, const ContactTouch* slipped,
                                        const Eigen::Matrix3Xd& positions_m) const {
  const auto as_vector = [](const SkinAnchor& anchor) { return Eigen::Vector3d(anchor.r, anchor.s, anchor.face); };
  const Eigen::Vector3d none(0.0, 0.0, -1.0), point_m = points_.at(point, positions_m);
  const int face = points_.face_of(point);
  if (!slipped) {
    if (!pairs_.any_near(face)) return none;
    const std::optional<SkinAnchor> found = pairs_.anchor(face, point_m, outward(point, positions_m), positions_m);
    return found ? as_vector(*found) : none;
  }
  const Eigen::Vector3d tied_m = slipped->friction.compliance_m_pa * slipped->friction.traction_pa(slipped->away_m);
  Eigen::Vector3d at_m = point_m - tied_m, anchor = none;
  double least_off_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kAnchorings; ++i) {
    const Eigen::Vector3d next = as_vector(pairs_.anchor_on(slipped->met.face, at_m, positions_m).first);
    Eigen::Vector3d off_m = point_m - at_anchor(next, positions_m) - tied_m;
    off_m -= slipped->normal * slipped->normal.dot(off_m);
    if (!(off_m.norm() < least_off_m)) break;
    least_off_m = off_m.norm();
    anchor = next;
    at_m += off_m;
  }
  return anchor;
}

}  // namespace soft_robot_lab
