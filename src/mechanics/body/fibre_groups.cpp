// SPDX-License-Identifier: BSD-3-Clause
#include "fibre_groups.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/mesh/element_crossings.h"
#include "mechanics/mesh/shape_functions.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

constexpr double kOutside = 0.1;     // of an element's edge: how far a thread may lie beside the body
constexpr double kShortest = 1e-9;   // of a piece, in shares of it
constexpr double kSameWay = 0.7;     // cosine between threads that have one mean stretch
constexpr double kStiffest_n = 1e5;  // a steel wire of 0.8 mm
constexpr std::size_t kMostPieces = 200000;

// A line's way through an element.
struct Cut {
  int tet;
  Eigen::Vector3d from, to;  // in reference coordinates
};

class LineCutter {
 public:
  explicit LineCutter(const TetMesh& mesh) {
    for (int tet = 0; tet < mesh.tet_count(); ++tet) {
      const TetCorners corners = corners_of(mesh, tet);
      Element element;
      element.slack_m = kOutside * edge_m(mesh, tet);
      for (int i = 0; i < 4; ++i) element.box.extend(corners.col(i));
      element.box.min().array() -= element.slack_m;
      element.box.max().array() += element.slack_m;
      Eigen::Matrix3d edges;
      for (int i = 0; i < 3; ++i) edges.col(i) = corners.col(i + 1) - corners.col(0);
      element.corner = corners.col(0);
      element.inverse = edges.inverse();
      element.slopes << -element.inverse.colwise().sum(), element.inverse;
      elements_.push_back(element);
    }
  }

  // Adds a straight piece; false where it leaves the body, at `left_m`.
  bool cut(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, std::vector<Cut>& cuts,
           Eigen::Vector3d& left_m) const {
    const Eigen::AlignedBox3d box(from_m.cwiseMin(to_m), from_m.cwiseMax(to_m));
    std::vector<int> near;
    for (std::size_t tet = 0; tet < elements_.size(); ++tet)
      if (elements_[tet].box.intersects(box)) near.push_back(static_cast<int>(tet));
    const auto at = [&](double share) -> Eigen::Vector3d { return from_m + share * (to_m - from_m); };
    const std::vector<double> borders = borders_of(near, from_m, to_m);
    for (std::size_t i = 1; i < borders.size(); ++i) {
      if (borders[i] - borders[i - 1] < kShortest) continue;
      const Eigen::Vector3d middle_m = at(0.5 * (borders[i - 1] + borders[i]));
      int nearest = -1;
      double least_m = 0.0;
      for (const int tet : near) {
        const double outside_m = elements_[static_cast<std::size_t>(tet)].outside_m(middle_m);
        if (nearest < 0 || outside_m < least_m) std::tie(nearest, least_m) = std::make_pair(tet, outside_m);
      }
      if (nearest < 0 || least_m > elements_[static_cast<std::size_t>(nearest)].slack_m) {
        left_m = middle_m;
        return false;
      }
      const Element& element = elements_[static_cast<std::size_t>(nearest)];
      cuts.push_back({nearest, element.local(at(borders[i - 1])), element.local(at(borders[i]))});
    }
    return true;
  }

 private:
  struct Element {
    Eigen::AlignedBox3d box;
    double slack_m = 0.0;
    Eigen::Vector3d corner;
    Eigen::Matrix3d inverse;
    Eigen::Matrix<double, 4, 3> slopes;  // of the barycentric coordinates

    Eigen::Vector3d local(const Eigen::Vector3d& point_m) const { return inverse * (point_m - corner); }
    Eigen::Vector4d barycentric(const Eigen::Vector3d& point_m) const {
      const Eigen::Vector3d inner = local(point_m);
      return {1.0 - inner.sum(), inner.x(), inner.y(), inner.z()};
    }
    // Below 0 inside.
    double outside_m(const Eigen::Vector3d& point_m) const {
      return (-barycentric(point_m).array() / slopes.rowwise().norm().array()).maxCoeff();
    }
  };

  // Shares of the piece at which it passes a plane of an element's side.
  std::vector<double> borders_of(const std::vector<int>& near, const Eigen::Vector3d& from_m,
                                 const Eigen::Vector3d& to_m) const {
    std::vector<double> borders{0.0, 1.0};
    for (const int tet : near) {
      const Eigen::Vector4d start = elements_[static_cast<std::size_t>(tet)].barycentric(from_m);
      const Eigen::Vector4d change = elements_[static_cast<std::size_t>(tet)].barycentric(to_m) - start;
      double from = 0.0, to = 1.0;
      for (int i = 0; i < 4; ++i) {
        if (std::abs(change[i]) < 1e-12) {
          if (start[i] < 0.0) to = -1.0;
          continue;
        }
        const double share = -start[i] / change[i];
        (change[i] > 0.0 ? from : to) = change[i] > 0.0 ? std::max(from, share) : std::min(to, share);
      }
      if (to - from < kShortest) continue;
      borders.push_back(from);
      borders.push_back(to);
    }
    std::sort(borders.begin(), borders.end());
    return borders;
  }

  std::vector<Element> elements_;
};

// Joins threads of one element that go the same way.
class Grouping {
 public:
  Grouping(const TetMesh& mesh, int fibre) : mesh_(mesh), fibre_(fibre) {}

  void add(const Cut& cut) {
    const int nodes = static_cast<int>(mesh_.tets.rows());
    const Eigen::VectorXd weights = shape_functions(nodes, cut.to).values - shape_functions(nodes, cut.from).values;
    const Eigen::Vector3d chord_m = mesh_.nodes_m(Eigen::all, mesh_.tets.col(cut.tet)) * weights;
    const double length_m = chord_m.norm();
    if (!(length_m > 0.0)) return;
    std::vector<Group>& here = of_element_[cut.tet];
    auto group = std::find_if(here.begin(), here.end(), [&](const Group& other) {
      return std::abs(other.way.dot(chord_m)) > kSameWay * length_m;
    });
    if (group == here.end()) group = here.insert(here.end(), Group{chord_m / length_m, {}, 0.0});
    group->weights.push_back(weights);
    group->length_m += length_m;
  }

  std::vector<FibreGroup> groups() const {
    std::vector<FibreGroup> all;
    for (const auto& [tet, here] : of_element_)
      for (const Group& group : here) {
        FibreGroup made{fibre_, tet, Eigen::MatrixXd(mesh_.tets.rows(), group.weights.size()), group.length_m};
        for (std::size_t k = 0; k < group.weights.size(); ++k)
          made.weights.col(static_cast<Eigen::Index>(k)) = group.weights[k];
        all.push_back(std::move(made));
      }
    return all;
  }

 private:
  struct Group {
    Eigen::Vector3d way;
    std::vector<Eigen::VectorXd> weights;
    double length_m;
  };

  const TetMesh& mesh_;
  const int fibre_;
  std::map<int, std::vector<Group>> of_element_;
};

void check(const TetMesh& mesh, const Fibre& fibre) {
  const std::string whose = "fibre '" + fibre.name + "': ";
  if (!mesh.quadratic())
    throw std::invalid_argument(whose + "in linear elements it locks; set body.element: quadratic");
  if (!(fibre.axial_stiffness_n > 0.0 && fibre.axial_stiffness_n <= kStiffest_n)) {
    std::ostringstream message;
    message << whose << "an axial stiffness of " << fibre.axial_stiffness_n << " N is out of range (0, " << kStiffest_n
            << "]";
    throw std::invalid_argument(message.str());
  }
  std::size_t pieces = 0;
  for (const auto& line : fibre.lines_m) {
    if (line.size() < 2) throw std::invalid_argument(whose + "a line needs at least two points");
    for (const Eigen::Vector3d& point_m : line)
      if (!point_m.allFinite()) throw std::invalid_argument(whose + "a point is not finite");
    pieces += line.size() - 1;
  }
  if (pieces == 0) throw std::invalid_argument(whose + "it has no line");
  if (pieces > kMostPieces)
    throw std::invalid_argument(whose + std::to_string(pieces) + " straight pieces, at most " +
                                std::to_string(kMostPieces) + "; wind it with a larger pitch");
}

}  // namespace

std::vector<FibreGroup> fibre_groups(const TetMesh& mesh, const Fibre& fibre, int index) {
  check(mesh, fibre);
  const LineCutter cutter(mesh);
  Grouping grouping(mesh, index);
  std::vector<Cut> cuts;
  for (const auto& line : fibre.lines_m) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      cuts.clear();
      Eigen::Vector3d left_m;
      if (!cutter.cut(line[i - 1], line[i], cuts, left_m))
        throw std::invalid_argument("fibre '" + fibre.name + "' leaves the body at " + point_text(left_m) +
                                    "; move it inside");
      for (const Cut& cut : cuts) grouping.add(cut);
    }
  }
  return grouping.groups();
}

}  // namespace soft_robot_lab
