// SPDX-License-Identifier: BSD-3-Clause
// `fibres`: windings, rings, straight threads and sheets in the silicone.
#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Geometry>

#include "sections.h"
#include "settings/point_text.h"
#include "settings/read_name.h"
#include "settings/read_points.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr int kPiecesATurn = 64;  // straight ones: 0.1 % of the radius beside the circle
constexpr double kMostTurns = 2000.0;
constexpr double kSheetSpacing =
    0.125;  // of an element's edge: where only one or two threads cross it they are no sheet

// How far a winding is from its axis: evenly, or as far as a surface and a little more.
class Mandrel {
 public:
  Mandrel(const YamlNode& node, const Body& body) : mesh_(body.mesh()), start_m_(node.vector3("start_m")) {
    const Eigen::Vector3d way_m = node.vector3("end_m") - start_m_;
    length_m_ = way_m.norm();
    if (!(length_m_ > 0.0)) node.child("end_m").fail("is where start_m is");
    axis_ = way_m / length_m_;
    across_ = axis_.unitOrthogonal();
    if (node.has("radius_m") == node.has("around")) node.fail("must have one of radius_m, around");
    if (node.has("radius_m")) {
      radius_m_ = node.number("radius_m", AllowedRange::positive());
    } else {
      take_surface(node);
    }
  }

  // At an angle about the axis and a place along it.
  Eigen::Vector3d point_m(double angle_rad, double along_m) const {
    const Eigen::Vector3d out = Eigen::AngleAxisd(angle_rad, axis_) * across_;
    const Eigen::Vector3d center_m = start_m_ + along_m * axis_;
    return center_m + out * (faces_.empty() ? radius_m_ : surface_radius_m(center_m, out) + offset_m_);
  }

  double length_m() const { return length_m_; }

  double mean_radius_m() const {
    if (faces_.empty()) return radius_m_;
    constexpr int kSamples = 64;
    double sum_m = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      const double along_m = (0.1 + 0.8 * i / kSamples) * length_m_;
      sum_m += (point_m(2.0 * M_PI * i / 8.0, along_m) - start_m_ - along_m * axis_).norm();
    }
    return sum_m / kSamples;
  }

  std::vector<Eigen::Vector3d> ring(double along_m) const {
    std::vector<Eigen::Vector3d> points_m;
    for (int i = 0; i < kPiecesATurn; ++i) points_m.push_back(point_m(2.0 * M_PI * i / kPiecesATurn, along_m));
    points_m.push_back(points_m.front());
    return points_m;
  }

  // From the start to the end of the axis; a negative pitch turns the other way.
  std::vector<Eigen::Vector3d> helix(double pitch_m, double phase_rad) const {
    const double turns = length_m_ / std::abs(pitch_m);
    const int pieces = std::max(2, static_cast<int>(std::ceil(kPiecesATurn * turns)));
    std::vector<Eigen::Vector3d> points_m;
    for (int i = 0; i <= pieces; ++i) {
      const double along_m = length_m_ * i / pieces;
      points_m.push_back(point_m(phase_rad + 2.0 * M_PI * along_m / pitch_m, along_m));
    }
    return points_m;
  }

 private:
  void take_surface(const YamlNode& node) {
    surface_ = node.text("around");
    around_ = node.child("around");
    offset_m_ = node.number("offset_m");
    const auto found = std::find(mesh_.surface_names.begin(), mesh_.surface_names.end(), surface_);
    if (found == mesh_.surface_names.end())
      around_->fail("unknown surface '" + surface_ +
                    "'; known: " + (mesh_.surface_names.empty() ? "none" : join(mesh_.surface_names)));
    const int index = static_cast<int>(found - mesh_.surface_names.begin());
    for (Eigen::Index face = 0; face < mesh_.faces.cols(); ++face)
      if (mesh_.face_surface[static_cast<std::size_t>(face)] == index) faces_.push_back(static_cast<int>(face));
  }

  // Where a line from the axis outwards meets the surface last (Moeller and Trumbore 1997).
  double surface_radius_m(const Eigen::Vector3d& from_m, const Eigen::Vector3d& way) const {
    constexpr double kBeside = 1e-6;
    double farthest_m = -1.0;
    for (const int face : faces_) {
      const Eigen::Vector3d a = mesh_.nodes_m.col(mesh_.faces(0, face));
      const Eigen::Vector3d first = mesh_.nodes_m.col(mesh_.faces(1, face)) - a,
                            second = mesh_.nodes_m.col(mesh_.faces(2, face)) - a;
      const Eigen::Vector3d p = way.cross(second);
      const double determinant = first.dot(p);
      if (determinant == 0.0) continue;
      const Eigen::Vector3d to = from_m - a, q = to.cross(first);
      const double u = to.dot(p) / determinant, v = way.dot(q) / determinant;
      if (u < -kBeside || v < -kBeside || u + v > 1.0 + kBeside) continue;
      farthest_m = std::max(farthest_m, second.dot(q) / determinant);
    }
    if (!(farthest_m > 0.0))
      around_->fail("surface '" + surface_ + "' does not surround the axis at " + point_text(from_m) +
                    "; let the winding start and end where it does");
    return farthest_m;
  }

  const TetMesh& mesh_;
  const Eigen::Vector3d start_m_;
  Eigen::Vector3d axis_, across_;
  double length_m_ = 0.0, radius_m_ = 0.0, offset_m_ = 0.0;
  std::vector<int> faces_;  // of the surface that it is wound around
  std::string surface_;
  std::optional<YamlNode> around_;
};

void check_turns(const YamlNode& node, double turns) {
  if (turns <= kMostTurns) return;
  node.fail(std::to_string(static_cast<long>(turns)) + " turns, at most " +
            std::to_string(static_cast<long>(kMostTurns)));
}

using Lines = std::vector<std::vector<Eigen::Vector3d>>;

Lines read_winding(const YamlNode& node, const Body& body) {
  const Mandrel mandrel(node, body);
  if (node.has("pitch_m") == node.has("angle_deg")) node.fail("must have one of pitch_m, angle_deg");
  const double pitch_m = node.has("pitch_m")
                             ? node.number("pitch_m", AllowedRange::positive())
                             : 2.0 * M_PI * mandrel.mean_radius_m() /
                                   std::tan(M_PI / 180.0 * node.number("angle_deg", {0.0, 90.0, true, true}));
  const int threads = node.integer_or("threads", 1, 1, 1000);
  const bool crossed = node.boolean_or("crossed", false);
  check_turns(node.child(node.has("pitch_m") ? "pitch_m" : "angle_deg"),
              threads * (crossed ? 2.0 : 1.0) * mandrel.length_m() / pitch_m);
  Lines lines;
  for (int thread = 0; thread < threads; ++thread) {
    const double phase_rad = 2.0 * M_PI * thread / threads;
    lines.push_back(mandrel.helix(pitch_m, phase_rad));
    if (crossed) lines.push_back(mandrel.helix(-pitch_m, phase_rad));
  }
  return lines;
}

Lines read_rings(const YamlNode& node, const Body& body) {
  const Mandrel mandrel(node, body);
  const double spacing_m = node.number("spacing_m", AllowedRange::positive());
  check_turns(node.child("spacing_m"), mandrel.length_m() / spacing_m);
  Lines lines;
  const int count = static_cast<int>(std::floor(mandrel.length_m() / spacing_m * (1.0 + 1e-9)));
  for (int i = 0; i <= count; ++i) lines.push_back(mandrel.ring(std::min(i * spacing_m, mandrel.length_m())));
  return lines;
}

// Straight threads a spacing apart over a rectangle, that go `angle_rad` from its first side.
Lines threads_over(const Eigen::Vector2d& size_m, double angle_rad, double spacing_m, const Eigen::Vector3d& corner_m,
                   const Eigen::Matrix<double, 3, 2>& axes) {
  const Eigen::Vector2d way(std::cos(angle_rad), std::sin(angle_rad)), across(-way.y(), way.x());
  const Eigen::Vector2d middle_m = 0.5 * size_m;
  const int count = static_cast<int>(std::ceil(size_m.norm() / spacing_m));
  Lines lines;
  for (int i = -count; i < count; ++i) {
    const Eigen::Vector2d at_m = middle_m + (i + 0.5) * spacing_m * across;
    double from_m = -size_m.norm(), to_m = size_m.norm();
    for (int axis = 0; axis < 2; ++axis) {
      if (std::abs(way[axis]) < 1e-9) {
        if (at_m[axis] < 0.0 || at_m[axis] > size_m[axis]) to_m = from_m;
        continue;
      }
      const double first_m = -at_m[axis] / way[axis], second_m = (size_m[axis] - at_m[axis]) / way[axis];
      from_m = std::max(from_m, std::min(first_m, second_m));
      to_m = std::min(to_m, std::max(first_m, second_m));
    }
    if (to_m - from_m < 1e-6 * size_m.norm()) continue;
    lines.push_back({corner_m + axes * (at_m + from_m * way), corner_m + axes * (at_m + to_m * way)});
  }
  return lines;
}

double element_edge_m(const TetMesh& mesh) { return std::cbrt(6.0 * std::sqrt(2.0) * volume(mesh) / mesh.tet_count()); }

double length_of(const Lines& lines) {
  double sum_m = 0.0;
  for (const auto& line : lines) sum_m += (line.back() - line.front()).norm();
  return sum_m;
}

// Threads that go three ways, 60 degrees apart, are an even membrane with a Poisson's ratio of 1/3 and a modulus times
// thickness of E A over their spacing. Under tension some of them push, so all may.
std::vector<Fibre> read_sheet(const YamlNode& item, const Body& body) {
  const YamlNode node = item.child("sheet");
  if (item.boolean_or("only_tension", false))
    item.child("only_tension").fail("must be false for a sheet: without push its threads are no even membrane");
  const std::vector<Eigen::Vector3d> corners_m = read_points(node, "corners_m");
  if (corners_m.size() != 3) node.child("corners_m").fail("must be three corners of a rectangle, one after the other");
  const Eigen::Vector3d first_m = corners_m[0] - corners_m[1], second_m = corners_m[2] - corners_m[1];
  const Eigen::Vector2d size_m(first_m.norm(), second_m.norm());
  if (std::abs(first_m.dot(second_m)) > 1e-6 * size_m.prod())
    node.child("corners_m").fail("has no right angle at its second corner");
  Eigen::Matrix<double, 3, 2> axes;
  axes << first_m / size_m.x(), second_m / size_m.y();
  const double stiffness_n_m =
      item.number("modulus_pa", AllowedRange::positive()) * node.number("thickness_m", AllowedRange::positive());
  const double spacing_m =
      node.number_or("spacing_m", std::min(kSheetSpacing * element_edge_m(body.mesh()), 0.25 * size_m.minCoeff()),
                     AllowedRange::positive());
  check_turns(node.has("spacing_m") ? node.child("spacing_m") : node, size_m.maxCoeff() / spacing_m);
  std::vector<Fibre> ways;
  for (int way = 0; way < 3; ++way) {
    Fibre fibre{read_name(item), threads_over(size_m, way * M_PI / 3.0, spacing_m, corners_m[1], axes), 0.0, false};
    if (fibre.lines_m.empty()) node.child("spacing_m").fail("is wider than the sheet");
    fibre.axial_stiffness_n = stiffness_n_m * size_m.prod() / length_of(fibre.lines_m);
    ways.push_back(std::move(fibre));
  }
  return ways;
}

double read_stiffness_n(const YamlNode& node) {
  if (node.has("axial_stiffness_n") == node.has("modulus_pa"))
    node.fail("must have one of axial_stiffness_n, modulus_pa (with diameter_m)");
  if (node.has("axial_stiffness_n")) return node.number("axial_stiffness_n", AllowedRange::positive());
  const double diameter_m = node.number("diameter_m", AllowedRange::positive());
  return node.number("modulus_pa", AllowedRange::positive()) * M_PI / 4.0 * diameter_m * diameter_m;
}

std::vector<Fibre> read_fibre(const YamlNode& node, const Body& body) {
  const std::vector<std::string> kinds{"winding", "rings", "points_m", "sheet"};
  if (node.has(kinds[0]) + node.has(kinds[1]) + node.has(kinds[2]) + node.has(kinds[3]) != 1)
    node.fail("must have one of " + join(kinds));
  if (node.has("sheet")) return read_sheet(node, body);
  Fibre fibre;
  fibre.name = read_name(node);
  fibre.axial_stiffness_n = read_stiffness_n(node);
  fibre.only_tension = node.boolean_or("only_tension", true);
  if (node.has("winding")) fibre.lines_m = read_winding(node.child("winding"), body);
  if (node.has("rings")) fibre.lines_m = read_rings(node.child("rings"), body);
  if (node.has("points_m")) fibre.lines_m = {read_points(node, "points_m")};
  return {fibre};
}

}  // namespace

void read_fibres(const YamlNode& scene, Body& body) {
  std::set<std::string> names;
  for (const YamlNode& item : scene.optional_sequence("fibres")) {
    const std::vector<Fibre> fibres = read_fibre(item, body);
    if (!names.insert(fibres.front().name).second) item.fail("two fibres are named '" + fibres.front().name + "'");
    for (const Fibre& fibre : fibres) in_section(item, [&] { body.add_fibre(fibre); });
  }
}

}  // namespace soft_robot_lab
