// SPDX-License-Identifier: BSD-3-Clause
// Chambers against reference solutions (config/reference): pressurised sphere and cylinder, and the hollow cuboid.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "hollow_mesh.h"
#include "mechanics/box_mesh.h"
#include "reference_table.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kP0 = 101000.0;

Simulation inflatable(Body body, const std::string& keys = "") {
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Chamber>());
  actuators[0]->initialise(
      YamlNode::parse("{name: air, surface: cavity, initial_pressure_pa: 101000" + keys + "}", "test"), body,
      MeshLocator(body.mesh()));
  return Simulation(std::move(body), std::move(actuators), {}, {});
}

ActuatorReading inflate(Simulation& simulation, double beta) {
  simulation.set_command("air", beta);
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  EXPECT_EQ(report.inverted_elements, 0);
  return simulation.actuator_state(0);
}

// Holds a body that is symmetric about the planes x = 0, y = 0 (and z = 0) where they hold it.
void hold_symmetry_planes(Body& body, int planes) {
  for (int axis = 0; axis < planes; ++axis) {
    const Eigen::Vector3d slab = Eigen::Vector3d::Ones() - (1.0 - 1e-9) * Eigen::Vector3d::Unit(axis);
    body.fix_nodes(-slab, slab, Eigen::Matrix<bool, 3, 1>(axis == 0, axis == 1, axis == 2));
  }
}

// Squares become circles (dimensions 2) or cubes spheres (3) of the same inner size.
std::function<Eigen::Vector3d(const Eigen::Vector3d&)> rounded(int dimensions) {
  return [dimensions](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    Eigen::Vector3d result = x;
    result.head(dimensions) *= x.head(dimensions).cwiseAbs().maxCoeff() / x.head(dimensions).norm();
    return result;
  };
}

// Of an incompressible sphere whose outer radius is `ratio` times the inner one.
double sphere_pressure_pa(double stretch, double ratio) {
  const double a = stretch, b = std::cbrt(1.0 + (a * a * a - 1.0) / (ratio * ratio * ratio));
  return 264200.0 / 6.0 * ((4.0 / b + std::pow(b, -4)) - (4.0 / a + std::pow(a, -4)));
}

const std::vector<double> kAcross = mirrored({0.005, 0.010, 0.013, 0.020});

// Inner radius 10 mm, outer 20 mm. Fills in as much gas as reaches each stretch of the table, which must then be found
// together with its pressure.
void expect_table(Simulation& simulation, const std::string& table, int dimensions) {
  for (const ReferenceRow& row : read_reference(table)) {
    const double stretch = row.number("inner_radius_stretch"), pressure_pa = row.number("p_Pa_nu0.499_iso");
    if (stretch > 1.3) continue;
    SCOPED_TRACE(stretch);
    const double growth = std::pow(stretch, dimensions);
    const ActuatorReading found = inflate(simulation, (1.0 + pressure_pa / kP0) * growth);
    EXPECT_NEAR(std::pow(*found.volume_m3 / *found.initial_volume_m3, 1.0 / dimensions), stretch, 0.01 * stretch);
    EXPECT_NEAR(*found.gauge_pressure_pa, pressure_pa, 0.01 * pressure_pa);
  }
}

TEST(ChamberReference, ThickSphereSwells) {
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant(0.010);
  Body body(hollow_mesh({{kAcross, kAcross, kAcross}, -corner, corner, true, rounded(3)}), {264200.0, 0.499, 1070.0});
  hold_symmetry_planes(body, 3);
  Simulation sphere = inflatable(std::move(body));
  EXPECT_NEAR(*sphere.actuator_state(0).initial_volume_m3, 4.0 / 3.0 * M_PI * 1e-6, 0.005 * 4.19e-6);
  expect_table(sphere, "r3_sphere", 3);
  // The closed form of the incompressible sphere, at the last stretch that is asked for.
  const double a = 1.3, p = sphere_pressure_pa(a, 2.0);
  EXPECT_NEAR(*inflate(sphere, (1.0 + p / kP0) * a * a * a).gauge_pressure_pa, p, 0.01 * p);
}

// A thin sphere holds no more than its closed form has at most; beyond that it balloons, and stays as it was.
TEST(ChamberReference, ThinSphereBalloonsAboveTheMostThatItHolds) {
  const std::vector<double> across = mirrored({0.0034, 0.0067, 0.010, 0.012});
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant(0.010);
  Body body(hollow_mesh({{across, across, across}, -corner, corner, true, rounded(3)}), {264200.0, 0.499, 1070.0});
  hold_symmetry_planes(body, 3);
  double most_pa = 0.0;
  for (double stretch = 1.0; stretch < 3.0; stretch += 0.001)
    most_pa = std::max(most_pa, sphere_pressure_pa(stretch, 1.2));
  Simulation sphere = inflatable(std::move(body), ", command: gauge_pressure, max_gauge_pressure_pa: 100000");
  sphere.set_command("air", 0.95 * most_pa);
  ASSERT_TRUE(sphere.solve_equilibrium().converged);
  const double times = *sphere.actuator_state(0).volume_m3 / *sphere.actuator_state(0).initial_volume_m3;
  EXPECT_NEAR(sphere_pressure_pa(std::cbrt(times), 1.2), 0.95 * most_pa, 0.01 * most_pa);

  const Eigen::Matrix3Xd before_m = sphere.state().positions_m;
  sphere.set_command("air", 1.3 * most_pa);
  const SolveReport report = sphere.solve_equilibrium();
  EXPECT_FALSE(report.converged);
  const std::string words = "chamber 'air' has no rest state above ";
  ASSERT_NE(report.message.find(words), std::string::npos) << report.message;
  const double held_pa = std::stod(report.message.substr(report.message.find(words) + words.size()));
  EXPECT_NEAR(held_pa, most_pa, 0.02 * most_pa);
  for (const SolvePathStage& stage : report.path)  // it is found before anything falls, which takes long
    EXPECT_STRNE(name_of(stage.stage), name_of(SolveStage::pseudo_transient));
  EXPECT_EQ(sphere.state().positions_m, before_m);
}

// Its ends are capped, and kept in their planes.
TEST(ChamberReference, LongThickCylinderSwells) {
  Body body(
      hollow_mesh({{kAcross, kAcross, {0.0, 0.004}}, {-0.010, -0.010, -1.0}, {0.010, 0.010, 1.0}, true, rounded(2)}),
      {264200.0, 0.499, 1070.0});
  hold_symmetry_planes(body, 2);
  body.fix_nodes(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Ones(), {false, false, true});
  Simulation cylinder = inflatable(std::move(body));
  expect_table(cylinder, "r3_cylinder_planestrain", 2);
}

// Its upper half, whose chamber a cap closes in the plane of symmetry.
TEST(ChamberReference, HollowCuboidSwellsAndShrinks) {
  const std::vector<double> across = mirrored({0.005, 0.0088, 0.010, 0.01125, 0.015});
  const std::vector<double> along = {0.0, 0.012, 0.0237, 0.0284, 0.029566375, 0.030816375, 0.034566375};
  Body body(hollow_mesh({{across, across, along}, {-0.010, -0.010, -1.0}, {0.010, 0.010, 0.029566375}, true, {}}),
            {264200.0, 0.499, 1070.0});
  body.fix_nodes({-1, -1, 0.0345}, {1, 1, 1}, {true, true, true});
  body.fix_nodes({-1, -1, -1}, {1, 1, 1e-9}, {false, false, true});
  Simulation cuboid = inflatable(std::move(body));
  for (const ReferenceRow& row : read_reference("r4_chamber")) {
    if (row.text("nu") != "0.499" || row.text("law") != "iso") continue;
    SCOPED_TRACE(row.text("beta"));
    const ActuatorReading found = inflate(cuboid, row.number("beta"));
    EXPECT_NEAR(2.0 * *found.initial_volume_m3, row.number("V0_m3"), 1e-9 * row.number("V0_m3"));
    EXPECT_NEAR(2.0 * *found.volume_m3, row.number("V_m3"), 0.01 * row.number("V_m3"));
    // The reference knows the small pressure at beta 0.975 to 2 % only.
    const double pressure_pa = row.number("P_gauge_Pa");
    EXPECT_NEAR(*found.gauge_pressure_pa, pressure_pa, std::max(0.01 * std::abs(pressure_pa), row.number("unc_P_Pa")));
  }
}

// A thin ring of radius 50 mm, one cell deep: a bar that is closed. Its inner side is the surface "cavity".
constexpr double kRing = 0.05;
constexpr int kAround = 64;

TetMesh ring_mesh(double thickness_m, double imperfection) {
  const double depth_m = 2.0 * M_PI * kRing / kAround;
  TetMesh mesh = box_mesh({0, -0.5 * thickness_m, 0}, {kAround, 0.5 * thickness_m, depth_m}, {kAround, 1, 1}, false);
  const Eigen::Index across = 4, kept = mesh.nodes_m.cols() - across;  // box_mesh counts along x last
  mesh.tets = mesh.tets.unaryExpr([&](int node) { return node < kept ? node : node - static_cast<int>(kept); });
  mesh.nodes_m.conservativeResize(3, kept);
  for (Eigen::Index i = 0; i < kept; ++i) {
    const Eigen::Vector3d at = mesh.nodes_m.col(i);
    const double angle = 2.0 * M_PI * at.x() / kAround,
                 r = kRing * (1.0 + imperfection * std::cos(2.0 * angle)) - at.y();
    mesh.nodes_m.col(i) = Eigen::Vector3d(r * std::sin(angle), -r * std::cos(angle), at.z());
  }
  mesh = make_quadratic(mesh);
  complete_boundary(mesh);
  mesh.surface_names = {"cavity"};
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const auto corner = [&](int i) -> Eigen::Vector3d { return mesh.nodes_m.col(mesh.faces(i, face)); };
    const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    const bool inside = normal.head<2>().dot(corner(0).head<2>()) < -0.5 * kRing;
    mesh.face_surface[static_cast<std::size_t>(face)] = inside ? 0 : -1;
  }
  return mesh;
}

// A ring under pressure from outside (Flaherty, Keller & Rubinow 1972), in EI / R^3 a unit of length: it buckles at 3,
// opposite sides touch at 5.247, and lie on one another from 10.34 on, with 7.956 EI / R^2 there. With Poisson's ratio
// 0, as the elastica knows EI alone. The pressure acts at the inner side.
TEST(ChamberReference, ARingIsPressedShut) {
  constexpr double kThin = 0.02;
  Body body(ring_mesh(kThin * kRing, 1e-4), {264200.0, 0.0, 1070.0});
  hold_symmetry_planes(body, 2);
  body.fix_nodes(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Ones(), {false, false, true});
  body.let_touch_itself();
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Chamber>());
  actuators[0]->initialise(
      YamlNode::parse("{name: air, surface: cavity, command: gauge_pressure, min_gauge_pressure_pa: -100}", "ring"),
      body, MeshLocator(body.mesh()));
  Simulation ring(std::move(body), std::move(actuators), {}, {});
  const double unit_pa = 264200.0 * std::pow(kThin, 3) / 12.0, depth_m = 2.0 * M_PI * kRing / kAround;
  const auto pressed_n = [&](double pressure) {
    ring.set_command("air", -pressure * unit_pa / (1.0 - 0.5 * kThin));
    const SolveReport report = ring.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    return ring.contacts().back().normal_force_n;
  };
  const auto half_width = [&] { return ring.state().positions_m.row(0).maxCoeff() / kRing; };
  const double slack = 0.03;
  pressed_n((1.0 - slack) * 3.0);
  EXPECT_NEAR(half_width(), 1.0, 0.05);
  pressed_n((1.0 + slack) * 3.0);
  EXPECT_GT(std::abs(half_width() - 1.0), 0.15);
  EXPECT_EQ(pressed_n((1.0 - slack) * 5.247), 0.0);
  EXPECT_GT(pressed_n((1.0 + slack) * 5.247), 0.0);
  const double expected_n = 7.956 * unit_pa * kRing * depth_m;
  EXPECT_NEAR(pressed_n(10.34), expected_n, slack * expected_n);
}

}  // namespace
}  // namespace soft_robot_lab
