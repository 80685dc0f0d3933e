// SPDX-License-Identifier: BSD-3-Clause
#include "point_sums.h"

#include <algorithm>
#include <utility>

#include "mechanics/linear_algebra/batches.h"
#include "mechanics/material/material_law.h"

namespace soft_robot_lab {
namespace {

using Index = Eigen::Index;

struct Flat {
  Batch m[9];
};

inline Flat deformation(const Batch* d, const double* q, Index modes) {
  Flat f{};
  f.m[0] = f.m[4] = f.m[8] = splat(1.0);
  for (Index i = 0; i < modes; ++i)
    for (int c = 0; c < 9; ++c) f.m[c] += splat(q[i]) * d[9 * i + c];
  return f;
}

inline Flat cross(const Flat& a, const Flat& b) {
  Flat r;
  for (int c = 0; c < 3; ++c) {
    const Batch *const au = a.m + 3 * ((c + 1) % 3), *const av = a.m + 3 * ((c + 2) % 3);
    const Batch *const bu = b.m + 3 * ((c + 1) % 3), *const bv = b.m + 3 * ((c + 2) % 3);
    for (int k = 0; k < 3; ++k) {
      const int x = (k + 1) % 3, y = (k + 2) % 3;
      r.m[3 * c + k] = au[x] * bv[y] - au[y] * bv[x] + bu[x] * av[y] - bu[y] * av[x];
    }
  }
  return r;
}

inline Batch dot3(const Batch* a, const Batch* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Batch dot(const Flat& a, const Batch* b) {
  Batch sum = a.m[0] * b[0];
  for (int c = 1; c < 9; ++c) sum += a.m[c] * b[c];
  return sum;
}

inline Flat cofactors(const Flat& f) {
  Flat r = cross(f, f);
  for (Batch& entry : r.m) entry *= splat(0.5);
  return r;
}

inline Batch growth(const Flat& f, const Flat& cofactor) {
  return f.m[0] * cofactor.m[0] + f.m[1] * cofactor.m[1] + f.m[2] * cofactor.m[2] - splat(1.0);
}

inline double total(const Batch& b) { return (b[0] + b[1]) + (b[2] + b[3]); }

inline Flat scaled(const Flat& a, const Batch& scale) {
  Flat r;
  for (int c = 0; c < 9; ++c) r.m[c] = scale * a.m[c];
  return r;
}

// A B and A' B.
inline Flat product(const Flat& a, const Flat& b) {
  Flat r;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i)
      r.m[3 * c + i] = a.m[i] * b.m[3 * c] + a.m[3 + i] * b.m[3 * c + 1] + a.m[6 + i] * b.m[3 * c + 2];
  return r;
}
inline Flat transposed_product(const Flat& a, const Flat& b) {
  Flat r;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i) r.m[3 * c + i] = dot3(a.m + 3 * i, b.m + 3 * c);
  return r;
}

struct Remainder {
  Batch energy;
  Flat stress;  // by F
};

inline Remainder remainder(const NeoHookean& law, const Flat& f) {
  const Flat cofactor = cofactors(f);
  const Batch grown = growth(f, cofactor), pull = law.mu * grown;
  return {splat(0.5) * pull * grown, scaled(cofactor, pull)};
}

// phi and what follows from it.
struct RivlinAt {
  Flat cofactor;
  Batch grown, i1, phi, beyond, curvature;  // J - 1; I1; phi; 2 Y'(phi) - 2 c1; Y''(phi)

  RivlinAt(const Rivlin& law, const Flat& f) : cofactor(cofactors(f)), grown(growth(f, cofactor)), i1(dot(f, f.m)) {
    const Batch two = splat(2.0);
    phi = i1 - splat(3.0) - two * grown + grown * grown;
    beyond = two * phi * (two * law.c2 + splat(3.0) * law.c3 * phi);
    curvature = two * law.c2 + splat(6.0) * law.c3 * phi;
  }
  Batch slope(const Rivlin& law) const { return splat(2.0) * law.c10 + beyond; }  // 2 Y'(phi)
};

inline bool has_invariant(const Rivlin& law) {
  for (int lane = 0; lane < kLanes; ++lane)
    if (law.c01[lane] != 0.0) return true;
  return false;
}

inline Remainder remainder(const Rivlin& law, const Flat& f) {
  const RivlinAt at(law, f);
  const Batch two = splat(2.0), twice = two * law.c01;
  Remainder result;
  result.energy = law.c10 * at.grown * at.grown + at.phi * at.phi * (law.c2 + law.c3 * at.phi);
  const Batch along_f = at.beyond, along_cofactor = at.slope(law) * at.grown - at.beyond;
  for (int c = 0; c < 9; ++c) result.stress.m[c] = along_f * f.m[c] + along_cofactor * at.cofactor.m[c];
  if (!has_invariant(law)) return result;
  result.energy += law.c01 * (dot(at.cofactor, at.cofactor.m) - at.i1 - two * at.grown);
  const Flat stretched = product(f, transposed_product(f, f));
  for (int c = 0; c < 9; ++c)
    result.stress.m[c] += twice * ((at.i1 - splat(1.0)) * f.m[c] - at.cofactor.m[c] - stretched.m[c]);
  return result;
}

// d2/dF2 along one direction.
class NeoHookeanSlope {
 public:
  NeoHookeanSlope(const NeoHookean& law, const Flat& f) : f_(f), cofactor_(cofactors(f)), mu_(law.mu) {
    pull_ = mu_ * growth(f_, cofactor_);
  }
  Flat along(const Flat& a) const {
    const Flat turned = cross(f_, a);
    const Batch grows = mu_ * dot(cofactor_, a.m);
    Flat column;
    for (int c = 0; c < 9; ++c) column.m[c] = grows * cofactor_.m[c] + pull_ * turned.m[c];
    return column;
  }

 private:
  const Flat f_, cofactor_;
  Batch mu_, pull_;
};

class RivlinSlope {
 public:
  RivlinSlope(const Rivlin& law, const Flat& f) : law_(law), f_(f), at_(law, f), invariant_(has_invariant(law)) {
    if (invariant_) squared_ = transposed_product(f, f);
  }
  // With n = d phi/dF = 2 F + 2 (J - 2) cof F:
  //   Y'' (n : A) n + (2 Y' - 2 c1) (A - F x A) + 2 Y' ((cof F : A) cof F + (J - 1) F x A)
  //   + 2 c01 (2 (F : A) F + (I1 - 1) A - A C - F (A'F + F'A) - F x A)
  Flat along(const Flat& a) const {
    const Flat turned = cross(f_, a);
    const Batch two = splat(2.0), slope = at_.slope(law_);
    const Batch of_f = dot(f_, a.m), of_cofactor = dot(at_.cofactor, a.m);
    const Batch less = at_.grown - splat(1.0), grows = at_.curvature * (two * of_f + two * less * of_cofactor);
    const Batch along_f = two * grows, along_cofactor = two * less * grows + slope * of_cofactor;
    const Batch along_turned = slope * at_.grown - at_.beyond;
    Flat column;
    for (int c = 0; c < 9; ++c)
      column.m[c] =
          along_f * f_.m[c] + along_cofactor * at_.cofactor.m[c] + at_.beyond * a.m[c] + along_turned * turned.m[c];
    if (!invariant_) return column;
    Flat both = transposed_product(f_, a);
    const Flat one_way = both;
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < 3; ++i) both.m[3 * c + i] += one_way.m[3 * i + c];
    const Flat stretched = product(f_, both), across = product(a, squared_);
    for (int c = 0; c < 9; ++c)
      column.m[c] +=
          two * law_.c01 *
          (two * of_f * f_.m[c] + (at_.i1 - splat(1.0)) * a.m[c] - across.m[c] - stretched.m[c] - turned.m[c]);
    return column;
  }

 private:
  const Rivlin& law_;
  const Flat f_;
  const RivlinAt at_;
  const bool invariant_;
  Flat squared_{};  // C = F'F
};

// Adds the forces of a group, lanes apart; returns its energy.
template <class Law>
inline double add_group_force(const Law& law, const Batch* d, const Batch& weight, const double* q, Index modes,
                              Batch* force) {
  const Remainder at = remainder(law, deformation(d, q, modes));
  const Flat stress = scaled(at.stress, weight);
  for (Index i = 0; i < modes; ++i) force[i] += dot(stress, d + 9 * i);
  return total(weight * at.energy);
}

// Its lower triangle, lanes apart.
template <class Slope, class Law>
inline void add_group_hessian(const Law& law, const Batch* d, const Batch& weight, const double* q, Index modes,
                              Batch* triangle) {
  const Slope slope(law, deformation(d, q, modes));
  for (Index i = 0; i < modes; ++i) {
    Flat of;
    for (int c = 0; c < 9; ++c) of.m[c] = d[9 * i + c];
    const Flat column = scaled(slope.along(of), weight);
    for (Index j = 0; j <= i; ++j) *triangle++ += dot(column, d + 9 * j);
  }
}

SOFT_ROBOT_LAB_CLONES double group_force(const NeoHookean& law, const Batch* d, const Batch& weight, const double* q,
                                         Index modes, Batch* force) {
  return add_group_force(law, d, weight, q, modes, force);
}
SOFT_ROBOT_LAB_CLONES double group_force(const Rivlin& law, const Batch* d, const Batch& weight, const double* q,
                                         Index modes, Batch* force) {
  return add_group_force(law, d, weight, q, modes, force);
}
SOFT_ROBOT_LAB_CLONES void group_hessian(const NeoHookean& law, const Batch* d, const Batch& weight, const double* q,
                                         Index modes, Batch* triangle) {
  add_group_hessian<NeoHookeanSlope>(law, d, weight, q, modes, triangle);
}
SOFT_ROBOT_LAB_CLONES void group_hessian(const Rivlin& law, const Batch* d, const Batch& weight, const double* q,
                                         Index modes, Batch* triangle) {
  add_group_hessian<RivlinSlope>(law, d, weight, q, modes, triangle);
}

template <class Law>
LawList<Law> laws_of(const std::vector<RestPoint>& points, const Body& body) {
  LawList<Law> laws((points.size() + kLanes - 1) / kLanes);
  for (std::size_t p = 0; p < points.size(); ++p)
    set_lane(body.material_of(points[p].element), static_cast<int>(p % kLanes), laws[p / kLanes]);
  return laws;
}

MaterialLaws laws_at(const std::vector<RestPoint>& points, const Body& body) {
  const auto neo_hookean = [&](const RestPoint& point) {
    return is_neo_hookean(body.material_of(point.element).model);
  };
  if (std::all_of(points.begin(), points.end(), neo_hookean)) return laws_of<NeoHookean>(points, body);
  return laws_of<Rivlin>(points, body);
}

}  // namespace

struct PointSums::Groups {
  Batches gradients;  // per group and mode: 9, a matrix column after column
  Batches weights;    // per group, zero where a lane is empty
  MaterialLaws laws;  // per group
  std::size_t points;
};

PointSums::PointSums(const std::vector<RestPoint>& points, const Body& body)
    : modes_(points.empty() ? 0 : points.front().gradient.cols()) {
  const std::size_t count = (points.size() + kLanes - 1) / kLanes, entries = 9 * static_cast<std::size_t>(modes_);
  Groups groups{Batches(count * entries, Batch{}), Batches(count, Batch{}), laws_at(points, body), points.size()};
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::size_t group = p / kLanes, lane = p % kLanes;
    groups.weights[group][lane] = points[p].weight_m3;
    for (std::size_t i = 0; i < entries; ++i)
      groups.gradients[group * entries + i][lane] = points[p].gradient.data()[i];
  }
  groups_ = std::make_shared<const Groups>(std::move(groups));
}

double PointSums::add_force(const Eigen::VectorXd& q, Eigen::VectorXd& force) const {
  Batches sums(static_cast<std::size_t>(modes_), Batch{});
  double energy_j = 0.0;
  const auto add = [&](const auto& laws) {
    const Batch* d = groups_->gradients.data();
    for (std::size_t group = 0; group < laws.size(); ++group, d += 9 * modes_)
      energy_j += group_force(laws[group], d, groups_->weights[group], q.data(), modes_, sums.data());
  };
  std::visit(add, groups_->laws);
  for (Index i = 0; i < modes_; ++i) force[i] += total(sums[static_cast<std::size_t>(i)]);
  return energy_j;
}

void PointSums::add_hessian(const Eigen::VectorXd& q, Eigen::MatrixXd& hessian) const {
  const auto modes = static_cast<std::size_t>(modes_);
  Batches triangle(modes * (modes + 1) / 2, Batch{});
  const auto add = [&](const auto& laws) {
    const Batch* d = groups_->gradients.data();
    for (std::size_t group = 0; group < laws.size(); ++group, d += 9 * modes_)
      group_hessian(laws[group], d, groups_->weights[group], q.data(), modes_, triangle.data());
  };
  std::visit(add, groups_->laws);
  const Batch* entry = triangle.data();
  for (Index i = 0; i < modes_; ++i)
    for (Index j = 0; j <= i; ++j, ++entry) {
      const double sum = total(*entry);
      hessian(i, j) += sum;
      if (i != j) hessian(j, i) += sum;
    }
}

Eigen::MatrixXd PointSums::forces(const Eigen::VectorXd& q) const {
  Eigen::MatrixXd all(modes_, static_cast<Index>(groups_->points));
  Batches of_group(static_cast<std::size_t>(modes_));
  const auto find = [&](const auto& laws) {
    const Batch* d = groups_->gradients.data();
    for (std::size_t group = 0; group < laws.size(); ++group, d += 9 * modes_) {
      std::fill(of_group.begin(), of_group.end(), Batch{});
      group_force(laws[group], d, groups_->weights[group], q.data(), modes_, of_group.data());
      for (std::size_t lane = 0; lane < kLanes && group * kLanes + lane < groups_->points; ++lane)
        for (Index i = 0; i < modes_; ++i)
          all(i, static_cast<Index>(group * kLanes + lane)) = of_group[static_cast<std::size_t>(i)][lane];
    }
  };
  std::visit(find, groups_->laws);
  return all;
}

}  // namespace soft_robot_lab
