// SPDX-License-Identifier: BSD-3-Clause
#include "skin_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "closest_place.h"
#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

constexpr double kDeepest = SkinAtRest::kDeepest, kAgainst = SkinAtRest::kAgainst;

constexpr double kLeastAbove = 0.25;  // of its square, what is left of a face's size as seen from a point
constexpr double kMargin = 0.05;      // of the body's size: what near faces are looked for within
constexpr double kSlack = 0.0007;   // of the same: which of them may overlap is looked for once nodes have moved so far
constexpr double kPairMoves = 6.0;  // by so many times as much as nodes do two faces move against each other, at most
constexpr double kWiderSlack = 0.01;  // of the body's size, the same where few pairs are looked at
constexpr double kOneWay = 0.9;       // cosine: neither face meets the other, nor do the guards at its edges
constexpr double kAlong = 0.6;        // cosine: faces bend less than to turn such normals against one another
constexpr double kOverEdge = 0.01;    // of a face's size: a point so far beyond its edge still meets it
constexpr double kBeyondEdge = 1e-9;  // of the same: a point no farther beyond it counts as above the face
constexpr double kClearly = 2.0;      // times that: a point so far beyond it does not, however the face bends
constexpr double kHeldOver = SkinAtRest::kHeldOver;
constexpr double kDeepBehind = 1e-2;  // of a face's size: the same where that skin does not face the point
constexpr double kMuchNearer = 0.5;   // of the way to the face behind which it is: skin beside which it has come in
constexpr double kSameWay = 1e-6;     // relative
constexpr double kJustOn = 1e-6;      // of the same: so high above a face a point may just touch it

}  // namespace

SkinPairs::SkinPairs(const Body& body, const ContactPoints& points)
    : rest_(body, points),
      margin_m_(kMargin * body.size_m()),
      slack_m_(kSlack * body.size_m()),
      overlaps_(rest_.same().size()),
      close_(rest_.same().size()),
      present_(rest_.faces(), rest_.deepest_m(), kOverEdge * rest_.sizes_m()),
      reach_(rest_.same().size()) {}

void SkinPairs::restrict_to(const std::vector<FacePair>& pairs) {
  restricted_ = true;
  slack_m_ *= kWiderSlack / kSlack;
  rest_.keep_nothing();
  near_.assign(rest_.same().size(), {});
  for (const auto& [face, other] : pairs)
    if (rest_.counts(face, other)) near_[static_cast<std::size_t>(face)].push_back(other);
  list_faces_in_pairs();
}

void SkinPairs::list_faces_in_pairs() {
  std::vector<char> listed(static_cast<std::size_t>(rest_.faces().cols()), 0);
  in_pairs_.clear();
  const auto list = [&](int face) {
    if (!std::exchange(listed[static_cast<std::size_t>(face)], 1)) in_pairs_.push_back(face);
  };
  for (std::size_t face = 0; face < near_.size(); ++face) {
    if (!near_[face].empty()) list(rest_.same()[face]);
    for (const int other : near_[face]) list(other);
  }
}

void SkinPairs::prepare(const Eigen::Matrix3Xd& positions_m) {
  if (!present_.move_to(positions_m)) return;
  for (Reach& reach : reach_) reach.known = false;
  double moved_m = this->moved_m(close_at_m_);
  if (moved_m >= slack_m_) {
    // Looked at here alone, so what is near must serve for slack_m_ more.
    if (!restricted_ && this->moved_m(near_at_m_) + slack_m_ >= 0.5 * margin_m_) find_near(positions_m);
    find_close(positions_m);
    moved_m = 0.0;
  }
  for (const int face : any_close_) {
    std::vector<int>& overlaps = overlaps_[static_cast<std::size_t>(face)];
    overlaps.clear();
    for (const Close& other : close_[static_cast<std::size_t>(face)])
      if (other.clear_m <= moved_m && may_overlap(face, other.face)) overlaps.push_back(other.face);
  }
}

// Where two faces are to one another does not change where all move alike: so about the middle of all ways.
double SkinPairs::moved_m(const Eigen::Matrix3Xd& from_m) const {
  if (from_m.cols() != present_.positions_m().cols()) return std::numeric_limits<double>::infinity();
  Eigen::Array3d least_m = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), most_m = -least_m;
  for (const int node : rest_.nodes()) {
    const Eigen::Array3d way_m = present_.positions_m().col(node) - from_m.col(node);
    least_m = least_m.min(way_m);
    most_m = most_m.max(way_m);
  }
  const Eigen::Vector3d middle_m = 0.5 * (least_m + most_m);
  double largest_m2 = 0.0;
  for (const int node : rest_.nodes())
    largest_m2 = std::max(largest_m2, (present_.positions_m().col(node) - from_m.col(node) - middle_m).squaredNorm());
  return std::sqrt(largest_m2);
}

// Boxes first, side by side in memory, as most pairs need no closer look. Of faces that are in a pair.
void SkinPairs::find_close(const Eigen::Matrix3Xd& positions_m) {
  using Box = Eigen::Matrix<double, 6, 1>;  // its lower corner, and the other one with its sign turned
  close_at_m_ = positions_m;
  Eigen::Matrix<double, 6, Eigen::Dynamic> soon_m(6, rest_.faces().cols());  // boxes
  for (const int face : in_pairs_) {
    const PresentFace& at = present_[face];
    soon_m.col(face) << at.deep_low_m, -at.deep_high_m;
    soon_m.col(face).array() -= slack_m_ * (kPairMoves + present_.turns_per_m(face) * rest_.deepest_m(face));
  }
  for (const int face : any_close_) overlaps_[static_cast<std::size_t>(face)].clear();
  any_close_.clear();
  for (std::size_t face = 0; face < near_.size(); ++face) {
    close_[face].clear();
    if (near_[face].empty()) continue;
    const PresentFace& at = present_[rest_.same()[face]];
    const Box far_m = (Box() << at.high_m, -at.low_m).finished();
    for (const int other : near_[face]) {
      if ((soon_m.col(other) - far_m).maxCoeff() > 0.0) continue;
      const double clear_m = this->clear_m(rest_.same()[face], other);
      if (clear_m < slack_m_) close_[face].push_back({other, clear_m});
    }
    if (!close_[face].empty()) any_close_.push_back(static_cast<int>(face));
  }
}

bool SkinPairs::may_overlap(int face, int other) const {
  const int same = rest_.same(face);
  const PresentFace &mine = present_[same], &theirs = present_[other];
  if (apart_m(mine, theirs) > 0.0 || mine.normal.dot(theirs.normal) >= kOneWay) return false;
  const double above_m = lowest_above_m(mine, theirs);
  return above_m < kOverEdge * rest_.size_m(other) && !lies_beside(same, other, -above_m);
}

// Where nodes move, points that a face lies between move by three times as much, and its normal turns.
double SkinPairs::clear_m(int same, int other) const {
  const PresentFace &mine = present_[same], &theirs = present_[other];
  const double turns_per_m = present_.turns_per_m(other);
  const double by_boxes_m = apart_m(mine, theirs) / (kPairMoves + turns_per_m * rest_.deepest_m(other));
  const double by_normals_m = (mine.normal.dot(theirs.normal) - kOneWay) / (turns_per_m + present_.turns_per_m(same));
  const double above_m = lowest_above_m(mine, theirs) - kOverEdge * rest_.size_m(other);
  const double reach_m = (mine.high_m - theirs.low_m).cwiseMax(theirs.high_m - mine.low_m).norm();
  const double by_heights_m = above_m / (kPairMoves + turns_per_m * (reach_m + kPairMoves * slack_m_));
  return std::max({by_boxes_m, by_normals_m, by_heights_m});
}

// Farther than a point that deep behind the other face may be beside it.
bool SkinPairs::lies_beside(int mine, int other, double deepest_m) const {
  const PresentFace& theirs = present_.with_sides(other);
  const auto& around_m = present_[mine].around_m;
  Eigen::Vector3d least_m = theirs.sideways * around_m.col(0);
  for (Eigen::Index a = 1; a < around_m.cols(); ++a) least_m = least_m.cwiseMin(theirs.sideways * around_m.col(a));
  return beyond_sides(other, (least_m - theirs.farthest_m).maxCoeff(), deepest_m, rest_.deepest_m(other));
}

// What is met lies along a normal of the face, which leads beside it no farther than it tilts.
bool SkinPairs::beyond_sides(int face, double beside_m, double along_m, double reach_m) const {
  const double over_m = kOverEdge * rest_.size_m(face);
  return beside_m > over_m && beside_m > over_m + std::min(reach_m, along_m + over_m) * present_.tilt(face);
}

bool SkinPairs::out_of_reach(int face, int other) const {
  const PresentFace &mine = present_[rest_.same(face)], &theirs = present_[other];
  return (theirs.low_m - mine.high_m).maxCoeff() > rest_.deepest_m(other) ||
         (mine.low_m - theirs.high_m).maxCoeff() > rest_.deepest_m(other);
}

const std::vector<int>& SkinPairs::in_reach_of(int face) const {
  Reach& reach = reach_[static_cast<std::size_t>(face)];
  if (reach.known) return reach.others;
  reach.known = true;
  reach.others.clear();
  for (const int other : near_[static_cast<std::size_t>(face)])
    if (!out_of_reach(face, other)) reach.others.push_back(other);
  return reach.others;
}

bool SkinPairs::may_meet(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward) const {
  const PresentFace& theirs = present_[other];
  const double height_m = theirs.normal.dot(point_m), deepest_m = rest_.deepest_m(other);
  if (height_m <= theirs.lowest_m - deepest_m || height_m >= theirs.top_m + deepest_m) return false;
  // No normal of the face is farther from that of its corners than it tilts.
  const double along = theirs.normal.dot(outward), length = outward.norm();
  return along <= kAlong * length &&
         (along <= -kAgainst * length || along <= (present_.tilt(other) - kAgainst) * length);
}

// A place beyond an edge lies above the face where that tilts.
bool SkinPairs::is_behind(int other, const Eigen::Vector3d& point_m) const {
  const PresentFace& theirs = present_[other];
  if ((theirs.deep_low_m.array() > point_m.array()).any() || (theirs.deep_high_m.array() < point_m.array()).any())
    return false;
  const double above = (theirs.normal.dot(point_m) - theirs.top_m) / rest_.size_m(other);
  return above < kJustOn || (above < kJustOn + kOverEdge && above < kJustOn + kOverEdge * present_.tilt(other));
}

bool SkinPairs::may_be_inside(int face, const Eigen::Vector3d& point_m) const {
  const std::vector<int>& all = overlaps_[static_cast<std::size_t>(face)];
  return std::any_of(all.begin(), all.end(), [&](int other) { return is_behind(other, point_m); });
}

bool SkinPairs::is_inside_any(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                              const Eigen::Matrix3Xd& positions_m) const {
  const std::vector<int>& all = overlaps_[static_cast<std::size_t>(face)];
  return std::any_of(all.begin(), all.end(), [&](int other) {
    if (!is_behind(other, point_m) || !may_meet(other, point_m, outward) ||
        !meets_within(candidate(other, point_m), rest_.deepest_m(other)))
      return false;
    const std::optional<Meeting> met = meeting(other, point_m, outward, positions_m);
    return met && is_inside(*met);
  });
}

void SkinPairs::find_near(const Eigen::Matrix3Xd& positions_m) {
  near_at_m_ = positions_m;
  near_.assign(rest_.same().size(), {});
  std::vector<int> mine(static_cast<std::size_t>(rest_.faces().cols()), -1);
  for (std::size_t face = 0; face < rest_.same().size(); ++face)
    mine[static_cast<std::size_t>(rest_.same()[face])] = static_cast<int>(face);
  const auto add = [&](int face, int other) {
    const int own = mine[static_cast<std::size_t>(face)];
    if (own < 0) return;
    if (rest_.counts_kept(own, other)) near_[static_cast<std::size_t>(own)].push_back(other);
  };
  const double wider_m =
      0.5 * (margin_m_ + kDeepest * rest_.largest_size_m()) + 1e-6 * positions_m.cwiseAbs().maxCoeff();
  for (const auto& [a, b] : overlapping_faces(rest_.faces(), positions_m, wider_m)) {
    if (a == b) continue;
    add(a, b);
    add(b, a);
  }
  for (std::vector<int>& of_face : near_) {
    std::sort(of_face.begin(), of_face.end());
    of_face.erase(std::unique(of_face.begin(), of_face.end()), of_face.end());
  }
  list_faces_in_pairs();
}

// What a point finds on one face, where it is in front of it, or not deeper inside than counts.
std::optional<SkinPairs::Meeting> SkinPairs::meeting(int other, const Eigen::Vector3d& point_m,
                                                     const Eigen::Vector3d& outward,
                                                     const Eigen::Matrix3Xd& positions_m) const {
  const FacePolynomial face(nodes_of(rest_.faces(), other, positions_m));
  const std::optional<Eigen::Vector2d> local = closest_above(face, point_m, kClearly * kOverEdge * rest_.size_m(other));
  if (!local) return std::nullopt;
  const SeenPlace place(face, *local, point_m);
  if (!place.normal.allFinite() || place.normal.dot(outward) >= -kAgainst * outward.norm()) return std::nullopt;
  const double beyond_edge_m = (place.off_m - place.gap_m * place.normal).norm();
  if (std::abs(place.gap_m) > rest_.deepest_m(other) || beyond_edge_m > kOverEdge * rest_.size_m(other))
    return std::nullopt;
  return Meeting{other, place, place.off_m.norm()};
}

SkinGap SkinPairs::gap_at(const Meeting& met, const Eigen::Matrix3Xd& positions_m) const {
  const FaceNodes nodes = nodes_of(rest_.faces(), met.face, positions_m);
  const Eigen::Vector2d& local = met.place.local;
  const FaceShape shape = face_shape(nodes.cols(), local.x(), local.y());
  const Eigen::Matrix<double, 3, 2> tangents = nodes * shape.slopes.transpose();
  SkinGap gap;
  gap.gap_m = met.place.gap_m;
  gap.normal = met.place.normal;
  gap.at.face = met.face;
  gap.at.r = local.x();
  gap.at.s = local.y();
  gap.at.shape.head(nodes.cols()) = shape.values;
  gap.at.slopes.topRows(nodes.cols()) = shape.slopes.transpose();
  gap.at.above_m = gap.gap_m;
  const Eigen::Vector3d bends = (nodes * face_bends(nodes.cols())).transpose() * gap.normal;
  const Eigen::Matrix2d curvature = (Eigen::Matrix2d() << bends[0], bends[2], bends[2], bends[1]).finished();
  const Eigen::Matrix2d metric = tangents.transpose() * tangents;
  // Above a face that bends the closest place moves less, or more, than the point. Not where that has no meaning.
  Eigen::Matrix2d above = metric - gap.gap_m * curvature;
  if (above.determinant() < kLeastAbove * metric.determinant()) above = metric;
  gap.at.dual_per_m = tangents * above.inverse();
  gap.curvature_per_m = tangents * metric.inverse() * curvature * gap.at.dual_per_m.transpose();
  return gap;
}

std::shared_ptr<const PlaceAtEdge> SkinPairs::at_edge(const SkinPlace& met, const Eigen::Vector3d& point_m,
                                                      const Eigen::Matrix3Xd& positions_m) const {
  const FaceNodes nodes = nodes_of(rest_.faces(), met.face, positions_m);
  const SeenPlace place(FacePolynomial(nodes), {met.r, met.s}, point_m);
  const double beyond_m = (place.off_m - place.gap_m * place.normal).norm();
  if (!(beyond_m > kBeyondEdge * rest_.size_m(met.face))) return nullptr;
  return std::make_shared<const PlaceAtEdge>(nodes, place);
}

// By its box, by the planes that it lies between, and by those along its sides.
SkinPairs::Candidate SkinPairs::candidate(int other, const Eigen::Vector3d& point_m) const {
  const PresentFace& theirs = present_.with_sides(other);
  const double height_m = theirs.normal.dot(point_m);
  const double beside_m = (theirs.sideways * point_m - theirs.farthest_m).maxCoeff();
  return {other,
          std::max({(theirs.low_m - point_m).maxCoeff(), (point_m - theirs.high_m).maxCoeff(), height_m - theirs.top_m,
                    theirs.lowest_m - height_m, beside_m}),
          beside_m, std::max(height_m - theirs.lowest_m, theirs.top_m - height_m)};
}

bool SkinPairs::meets_within(const Candidate& candidate, double reach_m) const {
  return candidate.least_m <= reach_m && !beyond_sides(candidate.face, candidate.beside_m, candidate.along_m, reach_m);
}

// The one that may be nearest first, as then most others need no closer look.
std::optional<SkinGap> SkinPairs::meet(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                       bool outside_too, const Eigen::Matrix3Xd& positions_m) const {
  if (!outside_too && !is_inside_any(face, point_m, outward, positions_m)) return std::nullopt;
  candidates_.clear();
  for (const int other : in_reach_of(face)) {
    if (!may_meet(other, point_m, outward)) continue;
    const Candidate found = candidate(other, point_m);
    if (meets_within(found, rest_.deepest_m(other))) candidates_.push_back(found);
  }
  const auto nearest = std::min_element(candidates_.begin(), candidates_.end(),
                                        [](const Candidate& a, const Candidate& b) { return a.least_m < b.least_m; });
  if (nearest == candidates_.end()) return std::nullopt;
  std::iter_swap(candidates_.begin(), nearest);
  std::optional<Meeting> best;
  for (const Candidate& other : candidates_) {
    if (best && !meets_within(other, std::abs(best->place.gap_m))) continue;
    const std::optional<Meeting> met = meeting(other.face, point_m, outward, positions_m);
    if (met && (!best || std::abs(met->place.gap_m) < std::abs(best->place.gap_m))) best = met;
  }
  if (!best || (!outside_too && !is_inside(*best))) return std::nullopt;
  if (is_occluded(face, *best, point_m, outward, positions_m)) return std::nullopt;
  return gap_at(*best, positions_m);
}

bool SkinPairs::is_inside(const Meeting& met) const { return met.place.gap_m <= kJustOn * rest_.size_m(met.face); }

// How deep it is behind a face says something only where it has come through that.
bool SkinPairs::is_occluded(int face, const Meeting& behind, const Eigen::Vector3d& point_m,
                            const Eigen::Vector3d& outward, const Eigen::Matrix3Xd& positions_m) const {
  if (behind.place.gap_m >= -kHeldOver * rest_.size_m(behind.face)) return false;
  const std::vector<int>& others = in_reach_of(face);
  return std::any_of(others.begin(), others.end(), [&](int other) {
    return other != behind.face && body_of(other) == body_of(behind.face) &&
           is_outside(other, behind, point_m, outward, positions_m);
  });
}

// Where the closest place of both is on an edge that they share, both together decide.
bool SkinPairs::is_outside(int other, const Meeting& behind, const Eigen::Vector3d& point_m,
                           const Eigen::Vector3d& outward, const Eigen::Matrix3Xd& positions_m) const {
  if (candidate(other, point_m).least_m > behind.way_m) return false;
  const FacePolynomial skin(nodes_of(rest_.faces(), other, positions_m));
  const SeenPlace place(skin, closest(skin, point_m), point_m);
  const double way_m = place.off_m.norm();
  if (way_m > (1.0 + kSameWay) * behind.way_m) return false;
  const double along = place.normal.dot(outward) / outward.norm();
  const bool on_shared_edge = way_m > (1.0 - kSameWay) * behind.way_m;
  const bool in_front = place.gap_m > (on_shared_edge ? -behind.place.gap_m : 0.0);
  if (in_front && along < -kAgainst) return true;
  const bool beside = along >= -kAgainst && along < kAlong && way_m < kMuchNearer * behind.way_m;
  return behind.place.gap_m < -kDeepBehind * rest_.size_m(behind.face) && (in_front || beside);
}

std::optional<SkinGap> SkinPairs::meet_again(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                             const Eigen::Matrix3Xd& positions_m) const {
  const FacePolynomial face(nodes_of(rest_.faces(), other, positions_m));
  const std::optional<SeenPlace> place = closest_beyond(face, point_m, closest(face, point_m));
  if (!place || place->normal.dot(outward) >= 0.0 || std::abs(place->gap_m) > rest_.deepest_m(other))
    return std::nullopt;
  return gap_at({other, *place, place->off_m.norm()}, positions_m);
}

std::optional<SkinAnchor> SkinPairs::anchor(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                            const Eigen::Matrix3Xd& positions_m) const {
  std::optional<SkinAnchor> best;
  double best_m = 0.0;
  for (const int other : near_[static_cast<std::size_t>(face)]) {
    const double reach_m = best ? best_m : rest_.size_m(other);
    const PresentFace& theirs = present_[other];
    if ((point_m - theirs.low_m).minCoeff() < -reach_m || (theirs.high_m - point_m).minCoeff() < -reach_m) continue;
    if (theirs.normal.dot(outward) > -kAgainst * outward.norm()) continue;
    const auto [anchor, off_m] = anchor_on(other, point_m, positions_m);
    if (off_m > reach_m) continue;
    best_m = off_m;
    best = anchor;
  }
  return best;
}

std::pair<SkinAnchor, double> SkinPairs::anchor_on(int other, const Eigen::Vector3d& point_m,
                                                   const Eigen::Matrix3Xd& positions_m) const {
  const FaceNodes nodes = nodes_of(rest_.faces(), other, positions_m);
  const Eigen::Vector2d local = closest(FacePolynomial(nodes), point_m);
  const FaceShape shape = face_shape(nodes.cols(), local.x(), local.y());
  const Eigen::Vector3d off_m = point_m - nodes * shape.values;
  const Eigen::Matrix<double, 3, 2> tangents = nodes * shape.slopes.transpose();
  const Eigen::Vector2d there =
      local + Eigen::Matrix2d(tangents.transpose() * tangents).inverse() * (tangents.transpose() * off_m);
  return {{other, there.x(), there.y()}, off_m.norm()};
}

Eigen::Vector3d SkinPairs::at(int face, double r, double s, const Eigen::Matrix3Xd& positions_m) const {
  return nodes_of(rest_.faces(), face, positions_m) * face_shape(rest_.faces().rows(), r, s).values;
}

std::vector<int> SkinPairs::nodes(const FacePair& pair) const {
  const auto own = rest_.faces().col(rest_.same(pair.first)), other = rest_.faces().col(pair.second);
  std::vector<int> both(own.begin(), own.end());
  both.insert(both.end(), other.begin(), other.end());
  return both;
}

}  // namespace soft_robot_lab
