// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_skin.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace soft_robot_lab {
namespace {

template <class T>
void sort_out(std::vector<T>& all) {
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

// Of each face of the mesh, those that share an edge with it, and itself.
std::vector<std::vector<int>> faces_around(const Eigen::MatrixXi& faces) {
  std::map<std::pair<int, int>, std::vector<int>> at_edge;
  const auto edge = [&](int face, int side) { return std::minmax(faces(side, face), faces((side + 1) % 3, face)); };
  for (int face = 0; face < faces.cols(); ++face)
    for (int side = 0; side < 3; ++side) at_edge[edge(face, side)].push_back(face);
  std::vector<std::vector<int>> around(static_cast<std::size_t>(faces.cols()));
  for (int face = 0; face < faces.cols(); ++face) {
    std::vector<int>& all = around[static_cast<std::size_t>(face)];
    for (int side = 0; side < 3; ++side) {
      const std::vector<int>& here = at_edge[edge(face, side)];
      all.insert(all.end(), here.begin(), here.end());
    }
    sort_out(all);
  }
  return around;
}

}  // namespace

std::vector<FacePair> with_neighbours(const std::vector<FacePair>& pairs, const Body& body) {
  const ContactPoints points(body, PointSpread::dense);
  const std::vector<std::vector<int>> around = faces_around(body.mesh().faces);
  std::vector<int> of_points(around.size(), -1);
  for (int face = 0; face < points.face_count(); ++face)
    of_points[static_cast<std::size_t>(points.mesh_faces()[static_cast<std::size_t>(face)])] = face;
  std::set<FacePair> all;
  for (const auto& [face, other] : pairs) {
    const int same = points.mesh_faces()[static_cast<std::size_t>(face)];
    for (const int mine : around[static_cast<std::size_t>(same)]) {
      const int own = of_points[static_cast<std::size_t>(mine)];
      for (const int theirs : around[static_cast<std::size_t>(other)])
        if (own >= 0) all.emplace(own, theirs);
    }
  }
  return {all.begin(), all.end()};
}

ReducedSkin::ReducedSkin(const Body& body, const Eigen::MatrixXd& modes, const std::vector<FacePair>& pairs)
    : pairs_(pairs), skin_(body, 0, 0), positions_m_(body.mesh().nodes_m) {
  skin_.restrict_to(pairs);
  const ContactPoints& points = skin_.points();
  std::vector<int> faces;
  for (const FacePair& pair : pairs) {
    faces.push_back(pair.first);
    const std::vector<int> both = skin_.pairs().nodes(pair);
    nodes_.insert(nodes_.end(), both.begin(), both.end());
  }
  sort_out(faces);
  sort_out(nodes_);
  for (const int face : faces) {
    faces_.push_back({face, places()});
    for (int point = points.first_point(face); point < points.first_point(face + 1); ++point) points_.push_back(point);
  }
  row_of_.assign(static_cast<std::size_t>(positions_m_.cols()), -1);
  rest_m_.resize(3 * static_cast<Eigen::Index>(nodes_.size()));
  modes_.resize(rest_m_.size(), modes.cols());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    row_of_[static_cast<std::size_t>(nodes_[i])] = static_cast<int>(row);
    rest_m_.segment<3>(row) = positions_m_.col(nodes_[i]);
    modes_.middleRows<3>(row) = modes.middleRows<3>(3 * nodes_[i]);
  }
}

std::vector<ReducedSkin::Touch> ReducedSkin::at(const Eigen::VectorXd& q, const Eigen::VectorXd& pushes_n) {
  std::vector<Touch> touches;
  if (faces_.empty()) return touches;
  const Eigen::VectorXd places_m = rest_m_ + modes_ * q;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    positions_m_.col(nodes_[i]) = places_m.segment<3>(static_cast<Eigen::Index>(3 * i));
  skin_.prepare(positions_m_);
  const ContactPoints& points = skin_.points();
  for (const auto& [face, first] : faces_) {
    const int from = points.first_point(face), count = points.first_point(face + 1) - from;
    if (!skin_.pairs().may_be_inside(face) && pushes_n.segment(first, count).isZero(0.0)) continue;
    for (int i = 0; i < count; ++i) {
      ContactTouch found;
      const double pressure_pa = pushes_n[first + i] / points.weight_m2(from + i);
      if (skin_.find_touch(from + i, pressure_pa, positions_m_, found) && found.on_skin())
        touches.push_back(touch_of(first + i, found));
    }
  }
  return touches;
}

ReducedSkin::Touch ReducedSkin::touch_of(Eigen::Index place, const ContactTouch& found) const {
  const ContactPoints& points = skin_.points();
  const int point = points_[static_cast<std::size_t>(place)], face = points.face_of(point);
  Touch touch{place, found, Eigen::Matrix3Xd::Zero(3, modes_.cols()), {}, {}};
  for (int a = 0; a < points.nodes_per_face(); ++a) {
    touch.relative += points.shape(point)[a] * motion_of(points.node(face, a));
    touch.relative -= found.met.shape[a] * motion_of(skin_.pairs().node(found.met.face, a));
  }
  touch.gradient = touch.relative.transpose() * -found.normal;
  touch.law.offset = -found.gap_m;
  touch.law.compliance = skin_.law(found).compliance_m_pa / points.weight_m2(point);
  touch.law.min_multiplier = 0.0;
  return touch;
}

Eigen::MatrixXd ReducedSkin::hessian(const std::vector<Touch>& touches) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(modes_.cols(), modes_.cols());
  for (const Touch& touch : touches) {
    if (touch.found.pressure_pa == 0.0 || far_from_law(skin_, touch.found)) continue;
    Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(2, modes_.cols());
    for (int a = 0; a < skin_.points().nodes_per_face(); ++a)
      turn += touch.found.met.slopes.row(a).transpose() *
              (touch.found.normal.transpose() * motion_of(skin_.pairs().node(touch.found.met.face, a)));
    const Eigen::MatrixXd local = touch.found.met.dual_per_m.transpose() * touch.relative;
    const int point = points_[static_cast<std::size_t>(touch.place)];
    sum += touch.found.pressure_pa * skin_.points().weight_m2(point) *
           (hessian_of_turn(touch.found, turn, local) + touch.relative.transpose() * touch.found.bend * touch.relative);
  }
  return sum;
}

void ReducedSkin::add_pressures(const Eigen::VectorXd& pushes_n, Eigen::VectorXd& pressures_pa) const {
  const Eigen::Index first = pressures_pa.size() - skin_.points().count();  // after those of obstacles
  if (first < 0) return;
  for (Eigen::Index place = 0; place < places(); ++place) {
    const int point = points_[static_cast<std::size_t>(place)];
    pressures_pa[first + point] = pushes_n[place] / skin_.points().weight_m2(point);
  }
}

}  // namespace soft_robot_lab
