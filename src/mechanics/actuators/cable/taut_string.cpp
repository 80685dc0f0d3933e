// SPDX-License-Identifier: BSD-3-Clause
#include "taut_string.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/body/gap.h"

namespace soft_robot_lab {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr double kPiece = 0.1;            // of a piece of the chain, over the smallest radius
constexpr int kFewest = 24, kMost = 400;  // joints
constexpr double kStride = 0.25;          // that a joint moves in an iteration, over the smallest radius
constexpr int kIterations = 400, kStrides = 100;
constexpr std::size_t kKept = 16;                     // answers of a thread
constexpr double kTouching = 1e-9, kSettled = 1e-12;  // over the length

struct RadiusOf {
  double operator()(const Plane&) const { return std::numeric_limits<double>::infinity(); }
  double operator()(const Sphere& shape) const { return shape.radius_m; }
  double operator()(const Capsule& shape) const { return shape.radius_m; }
  double operator()(const Cylinder& shape) const { return shape.radius_m; }  // mostly one is met on its side
  double operator()(const RoundedBox& shape) const { return shape.rounding_m; }
  double operator()(const MeshShape& /*no cable goes around one*/) const {
    return std::numeric_limits<double>::infinity();
  }
};

double angle_of(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

Vector3d not_a_point() { return Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()); }

}  // namespace

// Joints x_i of the chain make half the sum of |x_i+1 - x_i|^2 least, outside: a spring from joint to joint, which
// spaces them evenly, so that the sum is the square of the length over the number of pieces. With the press p >= 0 and
// the outward normal n of each joint that touches
//   2 x_i - x_i-1 - x_i+1 = p_i n_i
// An active set says which do; Newton's method solves for joints and presses, by elimination from joint to joint.
class TautString::Tightening {
 public:
  Tightening(const TautString& string, const Way& way)
      : string_(string), way_(way), count_(way.cols() - 2), press_m_(Eigen::VectorXd::Zero(count_)) {
    gaps_.resize(static_cast<std::size_t>(count_));
    touches_.resize(gaps_.size());
    inverses_.resize(gaps_.size());
    look();
    const double near_m = kTouching * length_m();
    for (Eigen::Index i = 0; i < count_; ++i)
      if (gap(i).gap_m < near_m) press_m_[i] = std::max(0.0, gap(i).normal.dot(bend_m(i)));
  }

  const Way& way() const { return way_; }
  bool presses(Eigen::Index joint) const { return press_m_[joint] > 0.0; }

  // False where it does not settle. At first without what turns with the obstacle, which may make a saddle attract.
  bool settle() {
    int calm = 0;
    for (int i = 0; i < kIterations; ++i) {
      const bool same = choose();
      eliminate(calm > 2);
      const double moved_m = step();
      calm = same ? calm + 1 : 0;
      if (same && moved_m < kSettled * length_m()) return true;
      look();
    }
    return false;
  }

  // Motion of all joints with the ends: 3 x 6 each, the ends' own with them.
  std::vector<Eigen::Matrix<double, 3, 6>> motions() {
    choose();
    eliminate(true);
    std::vector<Eigen::Matrix<double, 4, 6>> right(gaps_.size(), Eigen::Matrix<double, 4, 6>::Zero());
    right.front().topLeftCorner<3, 3>() += Matrix3d::Identity();
    right.back().topRightCorner<3, 3>() += Matrix3d::Identity();
    solve(right);
    std::vector<Eigen::Matrix<double, 3, 6>> all(gaps_.size() + 2, Eigen::Matrix<double, 3, 6>::Zero());
    all.front().leftCols<3>().setIdentity();
    for (std::size_t i = 0; i < right.size(); ++i) all[i + 1] = right[i].topRows<3>();
    all.back().rightCols<3>().setIdentity();
    return all;
  }

 private:
  double length_m() const { return (way_.rightCols(count_ + 1) - way_.leftCols(count_ + 1)).colwise().norm().sum(); }
  const Gap& gap(Eigen::Index joint) const { return gaps_[static_cast<std::size_t>(joint)]; }
  Vector3d bend_m(Eigen::Index joint) const {
    return 2.0 * way_.col(joint + 1) - way_.col(joint) - way_.col(joint + 2);
  }

  // To the nearest obstacle, of each joint.
  void look() {
    for (Eigen::Index i = 0; i < count_; ++i) {
      Gap& nearest = gaps_[static_cast<std::size_t>(i)];
      nearest = gap_to(string_.obstacles_.front(), way_.col(i + 1));
      for (std::size_t k = 1; k < string_.obstacles_.size(); ++k) {
        const Gap other = gap_to(string_.obstacles_[k], way_.col(i + 1));
        if (other.gap_m < nearest.gap_m) nearest = other;
      }
    }
  }

  bool choose() {  // whether as before
    bool same = true;
    for (Eigen::Index i = 0; i < count_; ++i) {
      const bool touches = press_m_[i] - gap(i).gap_m > 0.0;
      same = same && touches == touches_[static_cast<std::size_t>(i)];
      touches_[static_cast<std::size_t>(i)] = touches;
    }
    return same;
  }

  void eliminate(bool turning) {
    for (std::size_t i = 0; i < gaps_.size(); ++i) {
      Matrix4d block = Matrix4d::Zero();
      block.topLeftCorner<3, 3>() = 2.0 * Matrix3d::Identity();
      block(3, 3) = 1.0;
      if (touches_[i]) {
        if (turning) block.topLeftCorner<3, 3>() -= press_m_[static_cast<Eigen::Index>(i)] * gaps_[i].hessian;
        block.topRightCorner<3, 1>() = -gaps_[i].normal;
        block.bottomLeftCorner<1, 3>() = -gaps_[i].normal.transpose();
        block(3, 3) = 0.0;
      }
      if (i > 0) block.topLeftCorner<3, 3>() -= inverses_[i - 1].topLeftCorner<3, 3>();
      inverses_[i] = block.inverse();
    }
  }

  template <class Column>
  void solve(std::vector<Column>& right) const {
    for (std::size_t i = 1; i < right.size(); ++i)
      right[i].template topRows<3>() += inverses_[i - 1].topRows<3>() * right[i - 1];
    for (std::size_t i = right.size(); i-- > 0;) {
      if (i + 1 < right.size()) right[i].template topRows<3>() += right[i + 1].template topRows<3>();
      right[i] = (inverses_[i] * right[i]).eval();
    }
  }

  double step() {
    std::vector<Eigen::Vector4d> right(gaps_.size());
    for (std::size_t i = 0; i < right.size(); ++i) {
      right[i].head<3>() = -bend_m(static_cast<Eigen::Index>(i));
      right[i][3] = touches_[i] ? gaps_[i].gap_m : 0.0;
    }
    solve(right);
    double most_m = 0.0;
    for (const Eigen::Vector4d& one : right) most_m = std::max(most_m, one.head<3>().norm());
    const double share = std::min(1.0, kStride * string_.smallest_m_ / std::max(most_m, 1e-300));
    for (std::size_t i = 0; i < right.size(); ++i) {
      way_.col(static_cast<Eigen::Index>(i) + 1) += share * right[i].head<3>();
      press_m_[static_cast<Eigen::Index>(i)] = touches_[i] ? right[i][3] : 0.0;
    }
    return most_m;
  }

  const TautString& string_;
  Way way_;
  Eigen::Index count_;
  Eigen::VectorXd press_m_;
  std::vector<Gap> gaps_;
  std::vector<char> touches_;
  std::vector<Matrix4d> inverses_;  // of what is left of each joint's block
};

TautString::TautString(std::vector<ObstacleShape> obstacles, std::vector<Vector3d> led_over_m, double length_m)
    : obstacles_(std::move(obstacles)),
      led_over_m_(std::move(led_over_m)),
      smallest_m_(std::numeric_limits<double>::infinity()) {
  static std::atomic<long> made{0};
  id_ = ++made;
  for (const ObstacleShape& shape : obstacles_) smallest_m_ = std::min(smallest_m_, std::visit(RadiusOf{}, shape));
  joints_ = 2 + std::clamp(static_cast<int>(std::ceil(length_m / (kPiece * smallest_m_))), kFewest, kMost);
}

TautString::Way TautString::led(const Vector3d& first_m, const Vector3d& last_m) const {
  std::vector<Vector3d> corners_m{first_m};
  corners_m.insert(corners_m.end(), led_over_m_.begin(), led_over_m_.end());
  corners_m.push_back(last_m);
  std::vector<double> until{0.0};
  for (std::size_t i = 1; i < corners_m.size(); ++i)
    until.push_back(until.back() + (corners_m[i] - corners_m[i - 1]).norm());
  Way way(3, joints_);
  std::size_t leg = 1;
  for (Eigen::Index joint = 0; joint < joints_; ++joint) {
    const double at = until.back() * static_cast<double>(joint) / static_cast<double>(joints_ - 1);
    while (leg + 1 < until.size() && until[leg] < at) ++leg;
    const double share = (at - until[leg - 1]) / std::max(until[leg] - until[leg - 1], 1e-300);
    way.col(joint) = corners_m[leg - 1] + share * (corners_m[leg] - corners_m[leg - 1]);
  }
  way.col(joints_ - 1) = last_m;
  return way;
}

bool TautString::free(const Way& way) const {
  for (Eigen::Index joint = 1; joint + 1 < joints_; ++joint)
    for (const ObstacleShape& shape : obstacles_)
      if (gap_to(shape, way.col(joint)).gap_m < 0.0) return false;
  return true;
}

// It is drawn straight until it meets something.
TautString::Way TautString::tight(const Vector3d& first_m, const Vector3d& last_m) const {
  Way way = led(first_m, last_m), straight = way;
  for (Eigen::Index joint = 1; joint + 1 < joints_; ++joint)
    straight.col(joint) = first_m + static_cast<double>(joint) / static_cast<double>(joints_ - 1) * (last_m - first_m);
  const Way led_way = way;
  const double most_m = (straight - way).colwise().norm().maxCoeff();
  if (!std::isfinite(most_m)) return not_a_point().replicate(1, joints_);
  const int strides = std::clamp(static_cast<int>(std::ceil(most_m / (kStride * smallest_m_))), 1, kStrides);
  int k = 0;
  while (k <= strides && free(way)) {
    ++k;
    way = led_way + std::min(1.0, static_cast<double>(k) / strides) * (straight - led_way);
  }
  if (k > strides) return straight;
  if (k > 0) way = led_way + static_cast<double>(k - 1) / strides * (straight - led_way);
  Tightening tightening(*this, way);
  if (!tightening.settle()) return not_a_point().replicate(1, joints_);
  return tightening.way();
}

std::shared_ptr<const TautString::Shape> TautString::between(const Vector3d& first_m, const Vector3d& last_m) const {
  struct Answer {
    long id = 0;
    Vector3d first_m, last_m;
    std::shared_ptr<const Shape> shape;
  };
  thread_local std::array<Answer, kKept> answers;
  Answer& kept = answers[static_cast<std::size_t>(id_) % kKept];
  if (kept.id != id_ || kept.first_m != first_m || kept.last_m != last_m)
    kept = {id_, first_m, last_m, std::make_shared<const Shape>(shape(tight(first_m, last_m)))};
  return kept.shape;
}

TautString::Shape TautString::shape(const Way& way) const {
  Tightening at(*this, way);
  const std::vector<Eigen::Matrix<double, 3, 6>> motions = at.motions();
  const auto pieces = static_cast<double>(joints_ - 1);
  const Eigen::Index last = joints_ - 1;
  Shape shape{way, 0.0, {}, {}, {}, 0.0, {}};
  shape.length_m = std::sqrt(pieces) * (way.rightCols(last) - way.leftCols(last)).norm();
  shape.first = pieces * (way.col(0) - way.col(1)) / shape.length_m;
  shape.last = pieces * (way.col(last) - way.col(last - 1)) / shape.length_m;
  Eigen::Matrix<double, 6, 1> gradient;
  gradient << shape.first, shape.last;
  shape.hessian.topRows<3>() = motions.front() - motions[1];
  shape.hessian.bottomRows<3>() = motions.back() - motions[static_cast<std::size_t>(last) - 1];
  shape.hessian = (pieces * shape.hessian - gradient * gradient.transpose()).eval() / shape.length_m;
  shape.turned_gradient.setZero();
  for (Eigen::Index i = 1; i < last; ++i) {
    if (!at.presses(i - 1)) continue;
    const Vector3d before = way.col(i) - way.col(i - 1), after = way.col(i + 1) - way.col(i);
    const Vector3d a = before.normalized(), b = after.normalized();
    const double sine = a.cross(b).norm(), cosine = a.dot(b);
    shape.turned_rad += angle_of(a, b);
    if (sine < 1e-9) continue;
    // d angle = -(b - a cos) / sin . da - (a - b cos) / sin . db for unit vectors a and b.
    const auto k = static_cast<std::size_t>(i);
    shape.turned_gradient -= (motions[k] - motions[k - 1]).transpose() * (b - a * cosine) / (sine * before.norm());
    shape.turned_gradient -= (motions[k + 1] - motions[k]).transpose() * (a - b * cosine) / (sine * after.norm());
  }
  return shape;
}

double TautString::Shape::share_at(const Vector3d& position_m) const {
  double nearest_m = std::numeric_limits<double>::infinity(), share = 0.0;
  const Eigen::Index pieces = way_m.cols() - 1;
  for (Eigen::Index i = 0; i < pieces; ++i) {
    const Vector3d along = way_m.col(i + 1) - way_m.col(i), off = position_m - way_m.col(i);
    const double at = std::clamp(along.dot(off) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    const double distance_m = (off - at * along).norm();
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    share = (static_cast<double>(i) + at) / static_cast<double>(pieces);
  }
  return share;
}

}  // namespace soft_robot_lab
