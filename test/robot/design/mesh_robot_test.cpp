// SPDX-License-Identifier: BSD-3-Clause
// The real mesher: every kind of solid against closed forms, named surfaces, refinement, files.
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "robot/design/mesh_quality.h"
#include "soft_robot_lab/robot/design/mesher.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

Solid solid_of(const std::string& yaml) { return read_solid(YamlNode::parse(yaml, "solid")); }

constexpr double kPi = 3.14159265358979323846;

// Sources are joined to it, results stay until the next run of this test.
class MeshRobot : public testing::Test {
 protected:
  MeshRobot() {
    fs::remove_all(options_.cache_folder);
    options_.program = SOFT_ROBOT_LAB_MESHER;
  }

  std::string file_of(const MeshRequest& request) { return mesh_file_for(request, options_); }

  TetMesh mesh_of(const std::string& solid, double element_size_m, bool quadratic = true) {
    MeshRequest request;
    request.solid = solid_of(solid);
    request.element_size_m = element_size_m;
    request.quadratic = quadratic;
    TetMesh mesh = read_msh(file_of(request));
    check_mesh(mesh);
    EXPECT_EQ(mesh.quadratic(), quadratic);
    return mesh;
  }

  std::string refusal(const std::string& solid, double element_size_m = 0.01) {
    try {
      mesh_of(solid, element_size_m);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path write(const std::string& name, const std::string& text) {
    const fs::path path = fs::path(testing::TempDir()) / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  TetMesh convert(const fs::path& file, double unit_m = 1.0) {
    MeshRequest request;
    request.mesh_file = file;
    request.mesh_unit_m = unit_m;
    TetMesh mesh = read_msh(file_of(request));
    check_mesh(mesh);
    return mesh;
  }

  std::string refusal_of_file(const fs::path& file, double unit_m = 1.0) {
    try {
      convert(file, unit_m);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  }

  MesherOptions options_{"", fs::path(testing::TempDir()) / "mesh_robot_test", 100.0};
};

// Area of the faces of a surface (-1: those without a name); curved faces are cut into small flat triangles.
double area(const TetMesh& mesh, int surface) {
  constexpr int n = 12;
  double sum = 0;
  for (int face = 0; face < mesh.faces.cols(); ++face) {
    if (mesh.face_surface[static_cast<size_t>(face)] != surface) continue;
    const auto at = [&](int i, int j) -> Eigen::Vector3d {
      const double b = double(i) / n, c = double(j) / n, a = 1 - b - c;
      const auto x = [&](int node) { return mesh.nodes_m.col(mesh.faces(node, face)); };
      if (!mesh.quadratic()) return a * x(0) + b * x(1) + c * x(2);
      return a * (2 * a - 1) * x(0) + b * (2 * b - 1) * x(1) + c * (2 * c - 1) * x(2) + 4 * a * b * x(3) +
             4 * b * c * x(4) + 4 * c * a * x(5);
    };
    const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
      sum += (q - p).cross(r - p).norm() / 2;
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return sum;
}

double area(const TetMesh& mesh, const std::string& name) {
  const auto found = std::find(mesh.surface_names.begin(), mesh.surface_names.end(), name);
  if (found == mesh.surface_names.end()) throw std::invalid_argument("no surface " + name);
  return area(mesh, static_cast<int>(found - mesh.surface_names.begin()));
}

void expect_relative(double value, double expected, double tolerance) {
  EXPECT_NEAR(value / expected, 1.0, tolerance) << value << " instead of " << expected;
}

constexpr const char* kBeam = "{box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0, 0]}}";
constexpr const char* kCavity = "{box: {size_m: [0.08, 0.01, 0.01], center_m: [0.05, 0, 0]}, name: cavity}";

TEST_F(MeshRobot, MakesABoxWithExactCorners) {
  const TetMesh mesh = mesh_of(kBeam, 0.01);
  expect_relative(volume(mesh), 4e-5, 1e-12);
  EXPECT_EQ(mesh.nodes_m.rowwise().minCoeff(), Eigen::Vector3d(0, -0.01, -0.01));
  EXPECT_EQ(mesh.nodes_m.rowwise().maxCoeff(), Eigen::Vector3d(0.1, 0.01, 0.01));
  EXPECT_TRUE(mesh.surface_names.empty());
  EXPECT_GT(measure_quality(mesh.nodes_m, mesh.tets).min, 0.15);
  const TetMesh linear = mesh_of(kBeam, 0.01, false);
  expect_relative(volume(linear), 4e-5, 1e-12);
  EXPECT_EQ(linear.tet_count(), mesh.tet_count());
}

TEST_F(MeshRobot, FollowsRoundSurfaces) {
  const TetMesh ball = mesh_of("{sphere: {radius_m: 0.02, center_m: [0, 0, 0.1]}, name: skin}", 0.01);
  expect_relative(volume(ball), 4.0 / 3.0 * kPi * 8e-6, 2e-3);
  expect_relative(area(ball, "skin"), 4 * kPi * 4e-4, 2e-3);
  EXPECT_EQ(ball.surface_names, std::vector<std::string>{"skin"});

  const double length = std::sqrt(0.05 * 0.05 + 0.03 * 0.03);
  const std::string axis = "start_m: [0, 0, 0.01], end_m: [0.05, 0, 0.04]";
  expect_relative(volume(mesh_of("{cylinder: {" + axis + ", radius_m: 0.02}}", 0.01)), kPi * 4e-4 * length, 2e-3);
  expect_relative(volume(mesh_of("{cone: {" + axis + ", radius_m: 0.02, end_radius_m: 0.01}}", 0.01)),
                  kPi / 3 * length * (4e-4 + 2e-4 + 1e-4), 2e-3);
  expect_relative(volume(mesh_of("{cone: {" + axis + ", radius_m: 0.02, end_radius_m: 0}}", 0.01)),
                  kPi / 3 * length * 4e-4, 2e-3);
  expect_relative(volume(mesh_of("{cone: {" + axis + ", radius_m: 0.01, end_radius_m: 0.01}}", 0.01)),
                  kPi * length * 1e-4, 2e-3);
}

TEST_F(MeshRobot, MakesValidElementsOfBallsThatAreSmallerThanAnElement) {
  const TetMesh mesh = mesh_of("{sphere: {radius_m: 0.01, center_m: [0, 0, 0]}}", 0.1);
  expect_relative(volume(mesh), 4.0 / 3.0 * kPi * 1e-6, 0.05);
}

TEST_F(MeshRobot, ExtrudesPolygonsOfEitherSense) {
  const double expected = 3 * 0.01 * 0.01 * 0.03;
  for (const char* corners : {"[0, 0], [0.02, 0], [0.02, 0.01], [0.01, 0.01], [0.01, 0.02], [0, 0.02]",
                              "[0, 0.02], [0.01, 0.02], [0.01, 0.01], [0.02, 0.01], [0.02, 0], [0, 0]"}) {
    const TetMesh mesh = mesh_of(std::string("{extrude: {polygon_m: [") + corners + "], z_m: [-0.01, 0.02]}}", 0.01);
    expect_relative(volume(mesh), expected, 1e-12);
    EXPECT_EQ(mesh.nodes_m.row(2).minCoeff(), -0.01);
    EXPECT_EQ(mesh.nodes_m.row(2).maxCoeff(), 0.02);
  }
}

// Pappus: a profile whose centroid lies on the curve sweeps its area times the curve's length.
TEST_F(MeshRobot, SweepsAlongASpline) {
  const std::string curve = "{sweep: {spline_m: [[0, 0, 0], [0.05, 0, 0], [0.05, 0.05, 0]], ";
  double length = 0;  // of the parabola between these control points
  constexpr int steps = 1000;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps;
    length += 0.1 * std::hypot(1 - t, t) / steps;
  }
  expect_relative(volume(mesh_of(curve + "radius_m: 0.005}}", 0.005)), kPi * 25e-6 * length, 2e-3);
  const TetMesh bar = mesh_of(
      curve + "polygon_m: [[-0.002, -0.005], [0.002, -0.005], [0.002, 0.005], [-0.002, 0.005]], x_axis: [0, 0, 1]}}",
      0.005);
  expect_relative(volume(bar), 0.004 * 0.01 * length, 2e-3);
  EXPECT_NEAR(bar.nodes_m.row(2).maxCoeff(), 0.002, 1e-6) << "x of the profile runs along x_axis";
  EXPECT_NEAR(bar.nodes_m.row(2).minCoeff(), -0.002, 1e-6);
}

TEST_F(MeshRobot, RoundsEdges) {
  const std::string block =
      "{fillet: {solid: {box: {size_m: [0.03, 0.02, 0.02], center_m: [0, 0, 0]}}, radius_m: 0.004";
  // All twelve: prisms, quarter cylinders and a ball.
  const double a = 0.022, b = 0.012, r = 0.004;
  expect_relative(volume(mesh_of(block + "}}", 0.006)),
                  a * b * b + 2 * r * (2 * a * b + b * b) + kPi * r * r * (a + 2 * b) + 4.0 / 3.0 * kPi * r * r * r,
                  2e-3);
  const std::string one = ", edges_in: {min_m: [-1, 0.009, 0.009], max_m: [1, 1, 1]}}}";
  expect_relative(volume(mesh_of(block + one, 0.006)), 12e-6 - (1 - kPi / 4) * r * r * 0.03, 5e-4);
  // A cylinder's seam is no edge. Centroid of what is taken away: 0.2234 r from the corner.
  const std::string tin = "{fillet: {solid: {cylinder: {start_m: [0, 0, 0], end_m: [0, 0, 0.02], radius_m: 0.01}}, ";
  const double away = 2 * (1 - kPi / 4) * r * r * 2 * kPi * (0.01 - r * (10 - 3 * kPi) / (12 - 3 * kPi));
  expect_relative(volume(mesh_of(tin + "radius_m: 0.004}}", 0.004)), kPi * 2e-6 - away, 2e-3);
  EXPECT_NE(refusal(tin + "radius_m: 0.03}}").find("cannot round these 2 edges by radius_m 0.03"), std::string::npos)
      << refusal(tin + "radius_m: 0.03}}");
  for (const std::string radius :
       {"0.01", "0.0102", "0.011", "0.012", "0.018"}) {  // half of the shortest edge, and more
    const std::string refused = refusal(block.substr(0, block.rfind(' ')) + " " + radius + "}}");
    EXPECT_NE(refused.find("take a smaller"), std::string::npos) << radius << ": " << refused;
  }
  EXPECT_EQ(refusal(tin + "radius_m: 0.001, edges_in: {min_m: [1, 1, 1], max_m: [2, 2, 2]}}}"),
            "fillet: no edge lies in edges_in");
}

TEST_F(MeshRobot, CombinesSolids) {
  const std::string left = "{box: {size_m: [0.04, 0.02, 0.02], center_m: [0, 0, 0]}}";
  const std::string right = "{box: {size_m: [0.04, 0.02, 0.02], center_m: [0.03, 0, 0]}}";
  expect_relative(volume(mesh_of("{union: [" + left + ", " + right + "]}", 0.01)), 0.07 * 4e-4, 1e-12);
  expect_relative(volume(mesh_of("{intersection: [" + left + ", " + right + "]}", 0.01)), 0.01 * 4e-4, 1e-12);
  expect_relative(volume(mesh_of("{difference: [" + left + ", " + right + "]}", 0.01)), 0.03 * 4e-4, 1e-12);
  const std::string touching = "{box: {size_m: [0.04, 0.02, 0.02], center_m: [0.04, 0, 0]}}";
  expect_relative(volume(mesh_of("{union: [" + left + ", " + touching + "]}", 0.01)), 0.08 * 4e-4, 1e-12);
  const std::string lens =
      "{intersection: [{sphere: {radius_m: 0.02, center_m: [0, 0, 0]}, name: a}, "
      "{sphere: {radius_m: 0.02, center_m: [0.02, 0, 0]}, name: b}]}";
  const TetMesh mesh = mesh_of(lens, 0.005);  // two caps of height h = r / 2: pi h^2 (3 r - h) / 3 and 2 pi r h
  expect_relative(volume(mesh), 2 * kPi * 1e-4 * (0.06 - 0.01) / 3, 3e-3);
  expect_relative(area(mesh, "a"), 2 * kPi * 0.02 * 0.01, 3e-3);
  expect_relative(area(mesh, "b"), 2 * kPi * 0.02 * 0.01, 3e-3);
}

TEST_F(MeshRobot, MovesSolidsAndTheirNames) {
  const auto box_of = [&](const std::string& how) {
    const TetMesh mesh = mesh_of(how, 0.01);
    Eigen::Matrix<double, 3, 2> box;
    box << mesh.nodes_m.rowwise().minCoeff(), mesh.nodes_m.rowwise().maxCoeff();
    EXPECT_EQ(mesh.surface_names, std::vector<std::string>{"part"});
    return box;
  };
  const auto expect_box = [&](const std::string& how, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const auto box = box_of(how);
    EXPECT_LT((box.col(0) - low).norm() + (box.col(1) - high).norm(), 1e-9) << how << "\n" << box;
  };
  const std::string part = "{solid: {box: {size_m: [0.04, 0.02, 0.01], center_m: [0.02, 0, 0]}, name: part}, ";
  expect_box("{rotate: " + part + "axis: [0, 0, 2], angle_deg: 90}}", {-0.01, 0, -0.005}, {0.01, 0.04, 0.005});
  expect_box("{rotate: " + part + "axis: [0, 0, 1], angle_deg: 90, center_m: [0.04, 0, 0]}}", {0.03, -0.04, -0.005},
             {0.05, 0, 0.005});
  expect_box("{translate: " + part + "by_m: [0.01, 0.02, 0.03]}}", {0.01, 0.01, 0.025}, {0.05, 0.03, 0.035});
  expect_box("{scale: " + part + "factor: 0.5, center_m: [0.04, 0, 0]}}", {0.02, -0.005, -0.0025},
             {0.04, 0.005, 0.0025});
  expect_box("{mirror: " + part + "normal: [2, 0, 0], center_m: [-0.01, 0, 0]}}", {-0.06, -0.01, -0.005},
             {-0.02, 0.01, 0.005});
  expect_box("{array: " + part + "count: 3, by_m: [0.03, 0, 0]}}", {0, -0.01, -0.005}, {0.1, 0.01, 0.005});
}

TEST_F(MeshRobot, TurnsEachCopyOfAnArrayOnceMore) {
  // Four bars around the z axis: a cross of 80 x 20 mm each way.
  const TetMesh cross = mesh_of(
      "{array: {solid: {box: {size_m: [0.04, 0.02, 0.01], center_m: [0.02, 0, 0]}}, count: 4, axis: [0, 0, 1], "
      "angle_deg: 90}}",
      0.01);
  expect_relative(volume(cross), (2 * 0.08 * 0.02 - 0.02 * 0.02) * 0.01, 1e-9);
}

TEST_F(MeshRobot, NamesTheCavityOfADifference) {
  const TetMesh mesh = mesh_of(std::string("{difference: [") + kBeam + ", " + kCavity + "]}", 0.01);
  expect_relative(volume(mesh), 4e-5 - 8e-6, 1e-12);
  EXPECT_EQ(mesh.surface_names, std::vector<std::string>{"cavity"});
  expect_relative(area(mesh, "cavity"), 2 * 0.01 * 0.01 + 4 * 0.08 * 0.01, 1e-9);
  expect_relative(area(mesh, -1), 2 * 0.02 * 0.02 + 4 * 0.1 * 0.02, 1e-9);
}

TEST_F(MeshRobot, NamesOnlyThePartOfASurfaceThatBoundsTheBody) {
  // Two coplanar boxes overlap by 0.01 m; the right one's end inside the left one is no surface of the body.
  const std::string solid =
      "{union: [{box: {size_m: [0.04, 0.02, 0.02], center_m: [0, 0, 0]}}, "
      "{box: {size_m: [0.04, 0.02, 0.02], center_m: [0.03, 0, 0]}, name: right}]}";
  const TetMesh mesh = mesh_of(solid, 0.01);
  expect_relative(volume(mesh), 0.07 * 4e-4, 1e-12);
  expect_relative(area(mesh, "right"), 4 * 0.04 * 0.02 + 0.02 * 0.02, 1e-9);
  // An open chamber: the cylinder leaves the box, its ends are not there.
  const TetMesh tube =
      mesh_of(std::string("{difference: [") + kBeam +
                  ", {cylinder: {start_m: [-1, 0, 0], end_m: [1, 0, 0], radius_m: 0.005}, name: bore}]}",
              0.01);
  expect_relative(area(tube, "bore"), 2 * kPi * 0.005 * 0.1, 3e-3);
}

TEST_F(MeshRobot, LetsTheDeepestAndThenTheLastNameWin) {
  const std::string one = "{box: {size_m: [0.02, 0.02, 0.02], center_m: [0, 0, 0]}, name: one}";
  const std::string two = "{box: {size_m: [0.02, 0.02, 0.02], center_m: [0.01, 0, 0]}, name: two}";
  const TetMesh mesh = mesh_of("{union: [" + one + ", " + two + "], name: both}", 0.01);
  expect_relative(area(mesh, "two"), 4 * 0.02 * 0.02 + 0.02 * 0.02, 1e-9);
  expect_relative(area(mesh, "one"), 4 * 0.01 * 0.02 + 0.02 * 0.02, 1e-9);
  EXPECT_EQ(std::count(mesh.surface_names.begin(), mesh.surface_names.end(), "both"), 0);
  EXPECT_EQ(area(mesh, -1), 0.0);
}

TEST_F(MeshRobot, LeavesOutNamesThatBoundNothing) {
  const std::string far = "{sphere: {radius_m: 0.005, center_m: [1, 0, 0]}, name: far}";
  const std::string nothing =
      "{intersection: [{sphere: {radius_m: 0.005, center_m: [2, 0, 0]}}, " + far + "], name: nothing}";
  const TetMesh mesh = mesh_of(std::string("{difference: [") + kBeam + ", " + nothing + ", " + far + "]}", 0.01);
  EXPECT_TRUE(mesh.surface_names.empty());
}

TEST_F(MeshRobot, RefinesAroundAPointAndGrowsAway) {
  MeshRequest request;
  request.solid = solid_of(kBeam);
  request.refinements = {{{0.1, 0, 0}, 0.004, 0.002}};
  const TetMesh mesh = make_linear(read_msh(file_of(request)));
  check_mesh(mesh);
  const auto mean_edge = [&](double x_min, double x_max) {
    double sum = 0;
    int count = 0;
    for (int tet = 0; tet < mesh.tet_count(); ++tet) {
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (int i = 0; i < 4; ++i) centre += mesh.nodes_m.col(mesh.tets(i, tet)) / 4;
      const double off = std::hypot(centre.y(), centre.z());
      if (centre.x() < x_min || centre.x() > x_max || off > 0.003) continue;
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < i; ++j, ++count) {
          sum += (mesh.nodes_m.col(mesh.tets(i, tet)) - mesh.nodes_m.col(mesh.tets(j, tet))).norm();
        }
      }
    }
    return sum / count;
  };
  EXPECT_LT(mean_edge(0.097, 0.1), 0.0026);
  EXPECT_GT(mean_edge(0.0, 0.05), 0.005);
  EXPECT_GT(mean_edge(0.08, 0.09), mean_edge(0.097, 0.1));
  EXPECT_GT(measure_quality(mesh.nodes_m, mesh.tets).min, 0.1);
}

TEST_F(MeshRobot, RefinesAlongANamedSurfaceOrItsEdges) {
  MeshRequest request;
  request.solid = solid_of(
      "{difference: [{box: {size_m: [0.06, 0.06, 0.06], center_m: [0, 0, 0]}}, "
      "{box: {size_m: [0.03, 0.03, 0.03], center_m: [0, 0, 0]}, name: cavity}]}");
  request.element_size_m = 0.03;
  const double even_volume = volume(read_msh(file_of(request)));
  const auto nodes_near = [](const TetMesh& mesh, const Eigen::Vector3d& position_m) {
    return ((mesh.nodes_m.colwise() - position_m).colwise().norm().array() < 0.006).count();
  };
  const Eigen::Vector3d on_edge(0.015, 0.015, 0.0);
  request.refinements.resize(1);
  request.refinements[0].size_m = 0.003;
  request.refinements[0].surface = "cavity";
  const TetMesh surface = read_msh(file_of(request));
  request.refinements[0].edges_only = true;
  const TetMesh edges = read_msh(file_of(request));
  for (const TetMesh* mesh : {&surface, &edges}) {
    EXPECT_NEAR(volume(*mesh), even_volume, 1e-12);
    ASSERT_EQ(mesh->surface_names, std::vector<std::string>{"cavity"});
    EXPECT_GT(nodes_near(*mesh, on_edge), 50);
  }
  EXPECT_GT(surface.tet_count(), edges.tet_count());

  request.refinements[0].surface = "hole";
  try {
    file_of(request);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "refinements: the solid has no surface 'hole'; known: cavity");
  }
}

TEST_F(MeshRobot, MakesTheSameBytesOfTheSameRequest) {
  MeshRequest request;
  request.solid =
      solid_of(std::string("{difference: [") + kBeam + ", {sphere: {radius_m: 0.006, center_m: [0.05, 0, 0]}}]}");
  request.refinements = {{{0.1, 0, 0}, 0.004, 0.003}};
  const auto text = [&] {
    std::ifstream file(file_of(request));
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string first = text();
  fs::remove_all(options_.cache_folder);
  EXPECT_GT(first.size(), 1000u);
  EXPECT_TRUE(text() == first);
}

TEST_F(MeshRobot, SaysWhatIsWrongWithASolid) {
  const std::string ball = "{sphere: {radius_m: 0.005, center_m: [0.05, 0, 0]}}";
  const std::string far = "{sphere: {radius_m: 0.005, center_m: [1, 0, 0]}}";
  EXPECT_EQ(refusal("{difference: [" + ball + ", " + kBeam + "]}"), "empty solid: nothing is left of it");
  EXPECT_EQ(refusal("{intersection: [" + far + ", " + kBeam + "]}"), "empty solid: nothing is left of it");
  EXPECT_EQ(refusal("{intersection: [" + far + ", " + kBeam + ", " + ball + "]}"),
            "empty solid: nothing is left of it");
  EXPECT_EQ(refusal("{union: [" + far + ", " + kBeam + "]}"), "the solid falls into 2 parts, must be one");
  EXPECT_NE(refusal(kBeam, 1e-5).find("element_size_m 1e-05"), std::string::npos);
  EXPECT_NE(refusal("{union: [" + ball + ", {stl: \"" SOFT_ROBOT_LAB_SOURCE "/test/data/hollow_box.stl\"}]}")
                .find("must be the whole solid"),
            std::string::npos);
  EXPECT_NE(refusal("{step: \"" SOFT_ROBOT_LAB_SOURCE "/test/data/hollow_box.stl\"}"), "accepted");
  EXPECT_NE(refusal("{stl: \"" SOFT_ROBOT_LAB_SOURCE "/test/data/cylinder.step\"}"), "accepted");
}

// Quadratic elements take more memory than as many linear ones, and are refused earlier.
TEST_F(MeshRobot, RefusesMoreElementsThanThereIsMemoryForBeforeItMakesThem) {
  constexpr double million = 1.2, per_cube = 8.5;
  const double size_m = std::cbrt(per_cube * 0.1 * 0.02 * 0.02 / (1e6 * million));
  const std::string words = refusal(kBeam, size_m);
  for (const char* part : {"element_size_m 0.0006", "1.2e+06 elements, which take 7.8 GB", "6 GB are taken",
                           "choose larger ones, or element: linear"})
    EXPECT_NE(words.find(part), std::string::npos) << words;
}

TEST_F(MeshRobot, ReadsStepFilesInMillimetres) {
  const std::string step = "{step: \"" SOFT_ROBOT_LAB_SOURCE "/test/data/cylinder.step\", name: part}";
  const TetMesh mesh = mesh_of(step, 0.005);  // radius 10 mm, length 30 mm
  expect_relative(volume(mesh), kPi * 1e-4 * 0.03, 2e-3);
  expect_relative(area(mesh, "part"), 2 * kPi * 1e-4 + 2 * kPi * 0.01 * 0.03, 2e-3);
  const TetMesh cut =
      mesh_of("{difference: [{box: {size_m: [0.04, 0.04, 0.04], center_m: [0, 0, 0.02]}}, " + step + "]}", 0.01);
  expect_relative(volume(cut), 6.4e-5 - kPi * 1e-4 * 0.03, 2e-3);
  expect_relative(area(cut, "part"), kPi * 1e-4 + 2 * kPi * 0.01 * 0.03, 3e-3);  // one end lies in the box's face
}

TEST_F(MeshRobot, ReadsStlFilesInMetres) {
  const TetMesh mesh = mesh_of("{stl: \"" SOFT_ROBOT_LAB_SOURCE "/test/data/hollow_box.stl\", name: skin}", 0.01);
  expect_relative(volume(mesh), 4e-5 - 8e-6, 1e-6);
  expect_relative(area(mesh, "skin"), 2 * 4e-4 + 4 * 2e-3 + 2 * 1e-4 + 4 * 8e-4, 1e-6);
  EXPECT_EQ(area(mesh, -1), 0.0);
}

// Its sides are patches of one triangle each.
TEST_F(MeshRobot, MeshesATetrahedronOfFourTriangles) {
  const std::vector<Eigen::Vector3d> corners = {{0, 0, 0}, {0.05, 0, 0}, {0, 0.05, 0}, {0, 0, 0.05}};
  std::ostringstream text;
  text << "solid tetrahedron\n";
  for (const auto& side : std::vector<std::vector<size_t>>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const size_t corner : side) text << "vertex " << corners[corner].transpose() << "\n";
    text << "endloop\nendfacet\n";
  }
  const fs::path file = write("tetrahedron.stl", text.str() + "endsolid tetrahedron\n");
  options_.time_limit_s = 40;  // meshed in less than one
  const TetMesh mesh = mesh_of("{stl: \"" + file.string() + "\", name: skin}", 0.01);
  expect_relative(volume(mesh), std::pow(0.05, 3) / 6, 1e-6);
  expect_relative(area(mesh, "skin"), (1.5 + std::sqrt(3) / 2) * 0.05 * 0.05, 1e-6);
}

using Triangles = std::vector<std::array<Eigen::Vector3d, 3>>;

std::string stl_text(const Triangles& triangles) {
  std::ostringstream text;
  text.precision(9);
  text << "solid part\n";
  for (const auto& corners : triangles) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const Eigen::Vector3d& corner : corners) text << "vertex " << corner.transpose() << "\n";
    text << "endloop\nendfacet\n";
  }
  return text.str() + "endsolid part\n";
}

double volume_of(const Triangles& triangles) {
  double six = 0;
  for (const auto& t : triangles) six += t[0].cross(t[1]).dot(t[2]);
  return six / 6;
}

// A box whose sides are cut into 2 x 2 squares, in metres; facing outward.
Triangles box_of_facets(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Triangles all;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int square = 0; square < 4; ++square) {
        const auto at = [&](int u, int v) {
          Eigen::Vector3d share;
          share[axis] = side;
          share[(axis + 1) % 3] = 0.5 * (square % 2 + u);
          share[(axis + 2) % 3] = 0.5 * (square / 2 + v);
          return Eigen::Vector3d(low + share.cwiseProduct(high - low));
        };
        const std::array<Eigen::Vector3d, 4> q = {at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
        if (side == 1) {
          all.push_back({q[0], q[1], q[2]});
          all.push_back({q[0], q[2], q[3]});
        } else {
          all.push_back({q[0], q[2], q[1]});
          all.push_back({q[0], q[3], q[2]});
        }
      }
  return all;
}

Triangles both(Triangles one, const Triangles& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

Triangles turned(Triangles triangles) {
  for (auto& corners : triangles) std::swap(corners[0], corners[1]);
  return triangles;
}

TEST_F(MeshRobot, SaysWhereTheSurfaceOfAnStlFileIsFaultyInMetresOfTheScene) {
  const Triangles box = box_of_facets({0, 0, 0}, {20, 20, 40}), hole = turned(box_of_facets({5, 5, 5}, {15, 15, 35}));
  Triangles open = box, twice = box, pierced = box;
  open.erase(open.begin() + 3);
  twice.push_back(box[5]);
  for (auto& corners : pierced)  // the middle of the side at x = 20 goes out through the one at x = 0
    for (Eigen::Vector3d& corner : corners)
      if (corner == Eigen::Vector3d(20, 10, 20)) corner = {-10, 8, 17};
  Triangles aligned = both(box, turned(box_of_facets({5, 5, 10}, {15, 15, 30})));
  for (auto& corners : aligned)  // of the hollow, out through the side at x = 20, whose edges its own edges meet
    for (Eigen::Vector3d& corner : corners)
      if (corner == Eigen::Vector3d(15, 10, 20)) corner = {26, 10, 20};
  const auto words_of = [&](const Triangles& triangles) {
    const fs::path file = write("part.stl", stl_text(triangles));
    const std::string words = refusal("{scale: {solid: {stl: \"" + file.string() + "\"}, factor: 0.001}}", 0.01),
                      start = file.string() + ": ";
    return words.rfind(start, 0) == 0 ? words.substr(start.size()) : words;
  };
  EXPECT_EQ(words_of(box), "accepted");
  EXPECT_EQ(words_of(both(box, hole)), "accepted");
  EXPECT_EQ(words_of(turned(both(box, hole))), "accepted");
  EXPECT_EQ(words_of(open).rfind("its surface is not closed: the edge at (0, 0.01, 0.01) m has one facet; 2 more", 0),
            0u);
  EXPECT_EQ(words_of(twice).rfind("a facet stands twice, at (0, 0.0", 0), 0u) << words_of(twice);
  EXPECT_EQ(words_of(pierced).rfind("its surface cuts itself near (0, 0.012, 0.02) m", 0), 0u) << words_of(pierced);
  EXPECT_EQ(words_of(aligned).rfind("its surface cuts itself near (0.02, 0.0127273, 0.02) m", 0), 0u)
      << words_of(aligned);
  EXPECT_EQ(
      words_of(both(box, box_of_facets({40, 0, 0}, {60, 20, 40}))),
      "its surface has 2 shells: those at (0, 0, 0) m and (0.04, 0, 0) m lie apart, and a body must hang together; "
      "join them, or give each a file and an item of its own, in `bodies` or `obstacles`");
  EXPECT_EQ(
      words_of(both(box, box_of_facets({20, 5, 5}, {30, 15, 15}))).rfind("its surface cuts itself near (0.02, ", 0), 0u)
      << "a shell that lies on the other with a part of its side";
  EXPECT_EQ(words_of(both(box, box_of_facets({20, 20, 0}, {30, 30, 40})))
                .rfind("its surface touches itself: the edge at (0.02, 0.02, ", 0),
            0u);
  EXPECT_NE(words_of(both(box, turned(hole))).find("faces outward as the body's own"), std::string::npos);
  EXPECT_NE(words_of(both(both(box, hole), box_of_facets({8, 8, 8}, {12, 12, 12}))).find("lies in a hollow"),
            std::string::npos);
  EXPECT_EQ(words_of(both(box, box_of_facets({15, 5, 5}, {30, 15, 15}))).rfind("its surface cuts itself", 0), 0u);
}

// Single precision rounds a vertex differently in each of its facets.
TEST_F(MeshRobot, WeldsVerticesOfAnStlFileThatDifferByTheirLastDigit) {
  Triangles box = box_of_facets({0.1, 0.1, 0.1}, {0.12, 0.12, 0.14});
  for (size_t i = 0; i < box.size(); ++i) box[i][i % 3].x() += 1e-9 * static_cast<double>(i % 5);
  const TetMesh mesh = mesh_of("{stl: \"" + write("rounded.stl", stl_text(box)).string() + "\"}", 0.01);
  expect_relative(volume(mesh), 1.6e-5, 1e-5);
}

// The surface where a function is 0, negative inside: each cube of a grid is six tetrahedra (marching tetrahedra).
template <typename Function>
Triangles level_surface(const Function& value, const Eigen::Vector3i& cells, const Eigen::Vector3d& low, double edge) {
  constexpr int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  Triangles all;
  const auto zero_on = [&](Eigen::Vector3d p, Eigen::Vector3d q) -> Eigen::Vector3d {
    if (std::lexicographical_compare(q.data(), q.data() + 3, p.data(), p.data() + 3)) std::swap(p, q);
    const double share = std::min(0.9, std::max(0.1, value(p) / (value(p) - value(q))));
    return p + share * (q - p);
  };
  const auto add = [&](Eigen::Vector3d a, Eigen::Vector3d b, const Eigen::Vector3d& c, const Eigen::Vector3d& inside) {
    if ((b - a).cross(c - a).dot(inside - a) > 0) std::swap(a, b);
    all.push_back({a, b, c});
  };
  for (int i = 0; i < cells.prod() * 6; ++i) {
    const int cube = i / 6;
    Eigen::Vector3d corner =
        low + edge * Eigen::Vector3d(cube % cells[0], cube / cells[0] % cells[1], cube / cells[0] / cells[1]);
    std::vector<Eigen::Vector3d> in, out;
    for (int step = 0; step < 4; ++step) {
      (value(corner) < 0 ? in : out).push_back(corner);
      if (step < 3) corner[axes[i % 6][step]] += edge;
    }
    if (in.empty() || out.empty()) continue;
    if (in.size() == 2) {
      const auto ac = zero_on(in[0], out[0]), ad = zero_on(in[0], out[1]), bc = zero_on(in[1], out[0]),
                 bd = zero_on(in[1], out[1]);
      add(ac, ad, bd, in[0]);
      add(ac, bd, bc, in[0]);
    } else {
      const Eigen::Vector3d alone = in.size() == 1 ? in[0] : out[0];
      const auto& others = in.size() == 1 ? out : in;
      add(zero_on(alone, others[0]), zero_on(alone, others[1]), zero_on(alone, others[2]), in[0]);
    }
  }
  return all;
}

// Gmsh finds no parametrisation of such a surface.
TEST_F(MeshRobot, MeshesASmoothStlSurfaceWithSeveralHoles) {
  const auto ring = [](const Eigen::Vector3d& p, double x) {
    return std::hypot(std::hypot(p.x() - x, p.y()) - 10.0, p.z()) - 4.0;
  };
  const auto value = [&](const Eigen::Vector3d& p) {
    return std::min({ring(p, -20), ring(p, 0), ring(p, 20)}) + 0.0137;
  };
  const Triangles rings = level_surface(value, {40, 18, 8}, {-36.3, -16.3, -6.9}, 1.83);
  const fs::path file = write("rings.stl", stl_text(rings));
  const TetMesh mesh = mesh_of("{scale: {solid: {stl: \"" + file.string() + "\"}, factor: 0.001}, name: skin}", 0.009);
  expect_relative(volume(mesh), 1e-9 * volume_of(rings), 1e-6);
  EXPECT_EQ(area(mesh, -1), 0.0);
}

// Bulges of different size on every edge: in the wrong order the element would fold.
TEST_F(MeshRobot, ConvertsQuadraticVtkToTheOwnNodeOrder) {
  const fs::path file = write("bulge.vtk",
                              "# vtk DataFile Version 3.0\none element\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                              "POINTS 10 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0.5 0 -0.01\n0.52 0.52 0\n-0.03 0.5 0\n"
                              "0 -0.04 0.5\n0.56 0 0.56\n0 0.55 0.55\nCELLS 1 11\n10 0 1 2 3 4 5 6 7 8 9\n"
                              "CELL_TYPES 1\n24\n");
  const TetMesh mesh = convert(file);
  ASSERT_TRUE(mesh.quadratic());
  ASSERT_EQ(mesh.node_count(), 10);
  const auto node = [&](int i) -> Eigen::Vector3d { return mesh.nodes_m.col(mesh.tets(i, 0)); };
  EXPECT_EQ(node(7), Eigen::Vector3d(0, -0.04, 0.5));              // edge 0 3
  EXPECT_EQ(node(8), Eigen::Vector3d(0, 0.55, 0.55));              // edge 2 3
  EXPECT_EQ(node(9), Eigen::Vector3d(0.56, 0, 0.56));              // edge 1 3
  EXPECT_EQ(mesh.nodes_m.col(8), Eigen::Vector3d(0.56, 0, 0.56));  // nodes keep the order of the file
}

// As ParaView and meshio write it, with fields, and points that only a triangle uses.
TEST_F(MeshRobot, ConvertsVtkOfVersion5) {
  const fs::path file = write(
      "five.vtk",
      "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 double\n7\n"
      "POINTS 6 float\n9 9 9 0 0 0 1 0 0\n0 1 0 0 0 1 1 1 1\nMETADATA\nINFORMATION 0\n\nCELLS 4 11\n"
      "OFFSETS vtktypeint64\n0 3 7 11\nCONNECTIVITY vtktypeint64\n0 1 2 1 2 3 4 2 3 4 5\n"
      "CELL_TYPES 3\n5\n10\n10\nPOINT_DATA 6\nSCALARS s float\n");
  const TetMesh mesh = convert(file);
  EXPECT_EQ(mesh.node_count(), 5);
  EXPECT_EQ(mesh.tets.col(1), Eigen::Vector4i(1, 2, 3, 4));
  EXPECT_NEAR(volume(mesh), 0.5, 1e-15);
}

std::string big_endian(uint64_t bits, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(bits >> (8 * i) & 0xff);
  return text;
}

TEST_F(MeshRobot, ConvertsBinaryVtk) {
  std::string points, cells = big_endian(4, 4);
  for (const double value : {0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1}) {
    uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    points += big_endian(bits, 8);
  }
  for (uint64_t node = 0; node < 4; ++node) cells += big_endian(node, 4);
  const std::string head = "# vtk DataFile Version 2.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n";
  const std::string types = "\nCELL_TYPES 1\n" + big_endian(10, 4) + "\n";
  const TetMesh mesh = convert(write("binary.vtk", head + points + "\nCELLS 1 5\n" + cells + types));
  EXPECT_NEAR(volume(mesh), 1e-3 / 6, 1e-18);
  EXPECT_EQ(mesh.nodes_m(0, 1), 0.1);
  EXPECT_THROW(convert(write("short.vtk", head + points + "\nCELLS 1 5\n" + cells.substr(0, 9))),
               std::invalid_argument);
}

TEST_F(MeshRobot, RefusesDamagedVtk) {
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  const std::string points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n";
  const std::string cells = "CELLS 1 5\n4 0 1 2 3\n";
  const std::string types = "CELL_TYPES 1\n10\n";
  EXPECT_NO_THROW(convert(write("damaged.vtk", head + points + cells + types)));
  for (const std::string& rest :
       {points + cells, points + types, cells + types, points + "CELLS 1 5\n4 0 1 2 4\n" + types,
        points + "CELLS 1 5\n5 0 1 2 3\n" + types, points + "CELLS 1 4\n3 0 1 2\n" + types,
        points + "CELLS 99999999999 5\n4 0 1 2 3\n" + types, points + cells + "CELL_TYPES 1\n13\n",
        std::string("POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 nan\n") + cells + types,
        std::string("POINTS 4 string\n0 0 0 1 0 0 0 1 0 0 0 1\n") + cells + types,
        points + "CELLS 2 4\nOFFSETS vtktypeint64\n0 -4\nCONNECTIVITY vtktypeint64\n0 1 2 3\n" + types,
        std::string()}) {
    EXPECT_THROW(convert(write("damaged.vtk", head + rest)), std::invalid_argument) << rest;
  }
}

TEST_F(MeshRobot, ReadsVtkNumbersWithASignAndKeywordsInAnyCase) {
  const fs::path file = write("any.vtk",
                              "# vtk DataFile Version 3.0\nt\nascii\ndataset Unstructured_Grid\nPoints 4 Double\n"
                              "+0 0 -0 +1.0e+0 0 0 0 +1 0 0 0 1E+00\ncells 1 5\n4 0 1 2 3\nCell_Types 1\n10\n");
  expect_relative(volume(convert(file)), 1.0 / 6, 1e-12);
  EXPECT_THROW(convert(write("sign.vtk",
                             "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
                             "0 0 0 +-1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n")),
               std::invalid_argument);
}

TEST_F(MeshRobot, ConvertsMsh4WithItsNamedSurfaces) {
  const fs::path file = write(
      "four.msh",
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 7 \"front door\"\n3 1 \"body\"\n"
      "$EndPhysicalNames\n$Entities\n0 0 1 1\n1 0 0 0 1 1 0 1 7 0\n1 0 0 0 1 1 1 1 1 1 1\n"
      "$EndEntities\n$Nodes\n1 5 1 9\n3 1 0 5\n9\n2\n3\n4\n5\n0.1 0.2 0.30000000000000004\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n"
      "$EndNodes\n$Elements\n2 3 1 3\n2 1 2 1\n1 2 3 5\n3 1 4 2\n2 9 2 3 4\n3 2 3 4 5\n$EndElements\n");
  const TetMesh mesh = convert(file);
  EXPECT_EQ(mesh.tet_count(), 2);
  EXPECT_EQ(mesh.surface_names, std::vector<std::string>{"front door"});
  EXPECT_NEAR(area(mesh, "front door"), Eigen::Vector3d(-1, 1, 0).cross(Eigen::Vector3d(0, 1, 1)).norm() / 2, 1e-12);
  EXPECT_EQ(mesh.nodes_m.col(4),
            Eigen::Vector3d(0.1, 0.2, 0.30000000000000004));  // in the order of tags, no digit lost
}

// Two elements and the face between them; both text formats.
constexpr const char* kMsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"wall\"\n$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n"
    "2 10 0 0\n3 0 10 0\n4 0 0 10\n5 10 10 10\n$EndNodes\n$Elements\n3\n1 2 2 7 7 1 2 3\n2 4 2 1 1 1 2 3 4\n"
    "3 4 2 1 1 2 3 4 5\n$EndElements\n";
constexpr const char* kMsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n1 5 1 5\n"
    "3 1 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n1 2 1 2\n3 1 4 2\n1 1 2 3 4\n"
    "2 2 3 4 5\n$EndElements\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

// Places are those of the scene, after its scale.
TEST_F(MeshRobot, NamesTheUsersFileAndPlacesInMetres) {
  expect_relative(volume(convert(write("sound.msh", kMsh2), 0.001)), 5e-7, 1e-12);
  EXPECT_THROW(convert(write("sound.msh", kMsh2), -1), std::invalid_argument);
  for (const auto& [name, text, words] : std::vector<std::array<std::string, 3>>{
           {"flat.msh", with(kMsh2, "5 10 10 10", "5 5 5 0"),
            "mesh: element 1 at (0.00375, 0.00375, 0.0025) m with signed volume 0 m^3 is degenerate"},
           {"inside.msh", with(kMsh2, "7 7 1 2 3", "7 7 2 3 4"),
            "a triangle of the surface 'wall' at (0.00333333, 0.00333333, 0.00333333) m lies inside the body"}}) {
    const fs::path file = write(name, text);
    const std::string refusal = refusal_of_file(file, 0.001);
    EXPECT_EQ(refusal.find(file.string() + ": " + words), 0u) << refusal;
  }
}

// Gmsh would read what is announced, and go on.
TEST_F(MeshRobot, RefusesMshFilesThatCountWrongly) {
  EXPECT_EQ(convert(write("four.msh", kMsh4)).tet_count(), 2);
  const auto refused = [&](const std::string& text, const std::string& words) {
    const fs::path file = write("wrong.msh", text);
    EXPECT_EQ(refusal_of_file(file), file.string() + words);
  };
  refused(with(kMsh2, "$Elements\n3", "$Elements\n2"), ":17: $Elements announces 2 lines, and has 3");
  refused(with(kMsh2, "$Elements\n3", "$Elements\n4"), ":17: $Elements announces 4 lines, and has 3");
  refused(with(kMsh2, "$Nodes\n5", "$Nodes\n4"), ":9: $Nodes announces 4 lines, and has 5");
  refused(with(kMsh4, "1 2 1 2\n3", "1 1 1 2\n3"), ":23: $Elements announces 2 lines, and has 3");
  refused(with(kMsh4, "1 5 1 5", "1 4 1 5"), ":9: $Nodes announces 9 lines, and has 11");
  refused(with(kMsh2, "2 4 2 1 1 1 2 3 4\n3 4 2 1 1 2 3 4 5\n$EndElements\n", ""),
          ":18: the file ends before $Elements does");
  refused(with(kMsh2, "$EndNodes\n", ""), ":15: $Elements begins before $Nodes has ended");
  refused(kMsh2 + std::string("$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"),
          ":22: $Elements stands in the file twice");
}

TEST_F(MeshRobot, ReadsMsh1) {
  const std::string msh1 =
      "$NOD\n5\n1 0 0 0\n2 10 0 0\n3 0 10 0\n4 0 0 10\n5 10 10 10\n$ENDNOD\n"
      "$ELM\n2\n1 4 1 1 4 1 2 3 4\n2 4 1 1 4 2 3 4 5\n$ENDELM\n";
  EXPECT_EQ(convert(write("one.msh", msh1)).tet_count(), 2);
  const fs::path wrong = write("wrong_one.msh", with(msh1, "$ELM\n2", "$ELM\n3"));
  EXPECT_EQ(refusal_of_file(wrong), wrong.string() + ":10: $ELM announces 3 lines, and has 2");
  const fs::path open = write("open_one.msh", with(msh1, "$ENDNOD\n", ""));
  EXPECT_EQ(refusal_of_file(open), open.string() + ":8: $ELM begins before $NOD has ended");
}

TEST_F(MeshRobot, ReadsFilesOfAnyName) {
  for (const std::string name :
       {"two\nlines", "\ttab", "'one' \"two\"", "\\x41", "\x1b[31m", "\xc3\xa4 \xf0\x9f\xa4\x96"}) {
    EXPECT_EQ(convert(write(name + ".msh", kMsh2)).tet_count(), 2) << name;
    const fs::path stl = fs::path(testing::TempDir()) / (name + ".stl");
    fs::copy_file(SOFT_ROBOT_LAB_SOURCE "/test/data/hollow_box.stl", stl, fs::copy_options::overwrite_existing);
    Solid solid;
    solid.kind = Solid::Kind::stl_file;
    solid.file = stl;
    MeshRequest request;
    request.solid = solid;
    EXPECT_GT(read_msh(file_of(request)).tet_count(), 0) << name;
  }
}

// Gmsh's own words name neither the place nor what is wrong.
TEST_F(MeshRobot, SaysWhatGmshCannotReadInOurWords) {
  const fs::path number = write("number.msh", with(kMsh2, "2 10 0 0", "2 1,0 0 0"));
  // Sanitisers write behind it what Gmsh leaks.
  const auto first_line = [](const std::string& text) { return text.substr(0, text.find('\n')); };
  EXPECT_EQ(first_line(refusal_of_file(number)),
            number.string() + ": cannot be read: a section is broken off, or a number in it is none");
  const fs::path step = write("broken.step", "ISO-10303-21;\nHEADER;\n");
  EXPECT_EQ(first_line(refusal("{step: " + step.string() + "}")),
            step.string() + ": is no whole STEP file; write it anew by the program that made it");
  const std::string thin =
      first_line(refusal("{difference: [{cylinder: {radius_m: 0.02, start_m: [0, 0, 0], end_m: [0, 0, 0.1]}},"
                         " {cylinder: {radius_m: 0.015, start_m: [0.00499, 0, 0.001], end_m: [0.00499, 0, 0.099]}}]}"));
  EXPECT_NE(thin.find("a wall or a gap of it is thinner than they are long; give a smaller element_size_m"),
            std::string::npos)
      << thin;
}

TEST_F(MeshRobot, RefusesBinaryMshFilesThatCountWrongly) {
  const auto bytes = [](auto value) { return std::string(reinterpret_cast<const char*>(&value), sizeof value); };
  const auto numbers = [&](const std::vector<int>& all) {
    std::string text;
    for (const int value : all) text += bytes(value);
    return text;
  };
  std::string nodes;
  int tag = 0;
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, 0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}})
    nodes += bytes(++tag) + bytes(at.x()) + bytes(at.y()) + bytes(at.z());
  const auto file = [&](const std::string& elements) {
    return write("binary.msh", "$MeshFormat\n2.2 1 8\n" + bytes(1) + "\n$EndMeshFormat\n$Nodes\n5\n" + nodes +
                                   "\n$EndNodes\n$Elements\n" + elements +
                                   numbers({4, 2, 2, 1, 1, 1, 1, 2, 3, 4, 2, 1, 1, 2, 3, 4, 5}) + "\n$EndElements\n");
  };
  EXPECT_EQ(convert(file("2\n")).tet_count(), 2);
  for (const char* wrong : {"1\n", "3\n"})
    EXPECT_NE(refusal_of_file(file(wrong)).find("binary.msh: $Elements announces another number than follows"),
              std::string::npos)
        << refusal_of_file(file(wrong));
}

TEST_F(MeshRobot, RefusesMeshFilesOfOtherElements) {
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  const std::string cube =
      "POINTS 8 double\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\n"
      "CELL_TYPES 1\n12\n";
  EXPECT_NE(refusal_of_file(write("cube.vtk", head + cube)).find("cube.vtk:18: cell 0 is a hexahedron"),
            std::string::npos);
  EXPECT_NE(refusal_of_file(write("mesh.vtu", "<VTKFile>")).find("mesh.vtu: .vtu is not read here; save it as"),
            std::string::npos);
  EXPECT_NE(refusal_of_file(write("xml.vtk", "<?xml version=\"1.0\"?>\n<VTKFile>")).find("is XML, no legacy VTK file"),
            std::string::npos);
  EXPECT_NE(refusal_of_file(write("skin.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n"))
                .find("skin.vtk:4: DATASET is 'POLYDATA', must be UNSTRUCTURED_GRID"),
            std::string::npos);
  EXPECT_NE(refusal_of_file(write("prism.msh",
                                  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 "
                                  "0 1\n5 1 0 1\n6 0 1 1\n$EndNodes\n$Elements\n1\n1 6 2 1 1 1 2 3 4 5 6\n"
                                  "$EndElements\n"))
                .find("the mesh holds wedges; only tetrahedra"),
            std::string::npos);
  EXPECT_THROW(convert(write("empty.msh", "")), std::invalid_argument);
  EXPECT_THROW(convert(write("text.msh", "nonsense\n")), std::invalid_argument);
  EXPECT_THROW(convert(write("mesh.obj", "v 0 0 0\n")), std::invalid_argument);
  EXPECT_THROW(convert(write("flat.vtk", head + "POINTS 4 double\n0 0 0\n1 0 0\n0 1 0\n1 1 0\nCELLS 1 5\n4 0 1 2 3\n"
                                                "CELL_TYPES 1\n10\n")),
               std::invalid_argument);
}

// Each script would make a file named by its first word.
TEST_F(MeshRobot, RunsNoScriptWhateverItsName) {
  const fs::path folder = fs::path(testing::TempDir()) / "mesh_robot_scripts";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const std::string made = folder / "made_by_a_script", script = "SystemCall \"echo run > '" + made + "'\";\n";
  const auto refuses = [&](const std::string& name, const std::string& text, bool is_mesh) {
    std::ofstream(folder / name, std::ios::binary) << text;
    const std::string kind =
        name.find(".st") != std::string::npos && name.find(".stl") == std::string::npos ? "step" : "stl";
    try {
      if (is_mesh)
        convert(folder / name);
      else
        mesh_of("{" + kind + ": '" + (folder / name).string() + "'}", 0.01);
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      return true;
    }
    return false;
  };
  for (const char* name : {"a.msh", "a.vtk", "a.MSH", "a.geo", "a.geo_unrolled", "a.obj", "a.pos", "a.msh.gz", "a"})
    EXPECT_TRUE(refuses(name, script, true)) << name;
  for (const char* name : {"a.stl", "a.STL", "a.step", "a.stp", "a.txt", "a.geo", "a.stl.gz"})
    EXPECT_TRUE(refuses(name, script, false)) << name;
  EXPECT_TRUE(refuses("b.stl", "$MeshFormat\n" + script, false));
  EXPECT_TRUE(refuses("b.msh", "$PostFormat\n" + script, true));
  EXPECT_FALSE(fs::exists(made));
}

TEST_F(MeshRobot, ReadsNoOptionsBesideAMesh) {
  const fs::path folder = fs::path(testing::TempDir()) / "mesh_robot_options";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const fs::path mesh = folder / "a.msh", made = folder / "made_by_options";
  fs::copy_file(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/mesh/quadratic.msh", mesh);
  std::ofstream(mesh.string() + ".opt") << "SystemCall \"echo run > '" << made.string() << "'\";\n";
  EXPECT_EQ(convert(mesh).tet_count(), 1);
  EXPECT_FALSE(fs::exists(made));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace soft_robot_lab
