// SPDX-License-Identifier: BSD-3-Clause
// Fibres as scene files describe them, against closed forms of tubes under pressure.
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr double kRadius_m = 0.01, kInside_m = 0.009, kOutside_m = 0.011;  // of threads and of the wall

SceneOptions tube_options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

struct Tube {
  std::string fibres;
  double length_m = 0.06, size_m = 0.005, modulus_pa = 5000.0, pressure_pa = 2000.0, force_n = 0.0;
};

// A soft tube along z, closed by a stiff cap and held at the other end.
std::string scene_of(const Tube& tube) {
  const auto text = [](double number) { return std::to_string(number); };
  const std::string from_cap = text(tube.length_m - 0.003), length = text(tube.length_m);
  return R"(body:
  solid:
    difference:
      - union:
          - cylinder: {start_m: [0, 0, 0], end_m: [0, 0, )" +
         from_cap +
         "], radius_m: 0.011}\n          - {name: cap, material: {youngs_modulus_pa: 2.0e+6, poissons_ratio: "
         "0.4}, cylinder: {start_m: [0, 0, " +
         from_cap + "], end_m: [0, 0, " + length + R"(], radius_m: 0.011}}
      - {name: cavity, cylinder: {start_m: [0, 0, 0.003], end_m: [0, 0, )" +
         from_cap + "], radius_m: 0.009}}\n  element_size_m: " + text(tube.size_m) +
         "\n  material: {youngs_modulus_pa: " + text(tube.modulus_pa) +
         ", poissons_ratio: 0.499}\n  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 0.003001]}}]\nfibres:\n" +
         tube.fibres +
         "chambers: [{name: air, surface: cavity, command: gauge_pressure}]\nloads: [{box: {min_m: [-1, -1, " +
         text(tube.length_m - 1e-6) + "], max_m: [1, 1, 1]}, force_n: [0, 0, " + text(tube.force_n) +
         "]}]\nmarkers:\n  - {name: low, position_m: [0.011, 0, " + text(0.3 * tube.length_m) +
         "]}\n  - {name: high, position_m: [0.011, 0, " + text(0.7 * tube.length_m) +
         "]}\nrun: {commands: [{time_s: 0, air: " + text(tube.pressure_pa) + "}]}\n";
}

std::string braid(double angle_deg, double length_m) {
  return "  - {name: braid, axial_stiffness_n: 2000, winding: {start_m: [0, 0, 0], end_m: [0, 0, " +
         std::to_string(length_m) + "], radius_m: 0.01, angle_deg: " + std::to_string(angle_deg) +
         ", threads: 24, crossed: true}}\n";
}

double strain_of(Simulation& simulation) {
  const auto rest_m = [&](int marker) {
    return simulation.markers()[static_cast<std::size_t>(marker)].rest_position_m();
  };
  return (simulation.marker_position(1) - simulation.marker_position(0)).norm() / (rest_m(1) - rest_m(0)).norm() - 1.0;
}

// Of its middle, away from the ends.
double strain_of(const Tube& tube) {
  const SceneFolder folder;
  Scene scene = load_scene(folder.write("tube.yaml", scene_of(tube)), tube_options());
  const RunReport report = run_scene(scene);
  EXPECT_TRUE(report.solve.converged) << report.solve.message;
  return strain_of(*scene.simulation);
}

// The tension of an ideal muscle (Tondu and Lopez 2000).
double mckibben_n(double angle_rad, double pressure_pa, double strain) {
  return pressure_pa * M_PI * kRadius_m * kRadius_m *
         (3.0 / std::pow(std::tan(angle_rad), 2) * std::pow(1.0 + strain, 2) - 1.0 / std::pow(std::sin(angle_rad), 2));
}

// What its silicone adds: d/dl of a neo-Hookean wall that goes round with the threads.
double wall_n(double angle_rad, double modulus_pa, double stretch) {
  const double around = std::sqrt(1.0 - std::pow(stretch * std::cos(angle_rad), 2)) / std::sin(angle_rad);
  const double slope = -stretch / std::pow(std::tan(angle_rad), 2) / around;
  const double area_m2 = M_PI * (kOutside_m * kOutside_m - kInside_m * kInside_m);
  return modulus_pa / (2.0 * 1.499) * area_m2 *
         (stretch - std::pow(stretch, -3) * std::pow(around, -2) +
          (around - std::pow(stretch, -2) * std::pow(around, -3)) * slope);
}

TEST(FibreScene, ATubeKeepsItsLengthWhereItsThreadsCrossAtTheMagicAngle) {
  const auto strain_at = [](double angle_deg) {
    Tube tube;
    tube.fibres = braid(angle_deg, tube.length_m);
    return strain_of(tube);
  };
  const double below = strain_at(52.0), above = strain_at(57.0);
  EXPECT_LT(strain_at(45.0), -0.05);
  EXPECT_GT(strain_at(65.0), 0.05);
  EXPECT_LT(below, 0.0);
  EXPECT_GT(above, 0.0);
  const double angle_deg = 52.0 - below * 5.0 / (above - below), magic_deg = 180.0 / M_PI * std::atan(std::sqrt(2.0));
  EXPECT_NEAR(angle_deg / magic_deg, 1.0, 0.02);
}

TEST(FibreScene, AMuscleContractsAsMcKibbensLawHasIt) {
  constexpr double kAngle_rad = M_PI / 6.0;
  for (const double force_n : {6.0, 4.5}) {
    Tube tube;
    tube.length_m = 0.16;
    tube.modulus_pa = 10000.0;
    tube.pressure_pa = 5000.0;
    tube.force_n = force_n;
    tube.fibres = braid(30.0, tube.length_m);
    const double strain = strain_of(tube);
    EXPECT_LT(strain, -0.04);
    EXPECT_NEAR(force_n / (mckibben_n(kAngle_rad, tube.pressure_pa, strain) +
                           wall_n(kAngle_rad, tube.modulus_pa, 1.0 + strain)),
                1.0, 0.02)
        << strain;
  }
}

TEST(FibreScene, ATubeWithRingsBecomesLongerAndNotWider) {
  Tube tube;
  tube.modulus_pa = 20000.0;
  tube.length_m = 0.08;
  tube.fibres =
      "  - {name: hoops, axial_stiffness_n: 2000, rings: {start_m: [0, 0, 0.001], end_m: [0, 0, 0.079], "
      "radius_m: 0.01, spacing_m: 0.001}}\n";
  const SceneFolder folder;
  Scene scene = load_scene(folder.write("tube.yaml", scene_of(tube)), tube_options());
  ASSERT_TRUE(run_scene(scene).solve.converged);
  const double stretch = 1.0 + strain_of(*scene.simulation);
  const double area_m2 = M_PI * (kOutside_m * kOutside_m - kInside_m * kInside_m);
  // p dV = dW with the radius of the rings kept: plane strain of the wall.
  const double wall_n = tube.modulus_pa / 2.998 * area_m2 * (stretch - std::pow(stretch, -3));
  EXPECT_GT(stretch, 1.15);
  EXPECT_NEAR(wall_n / (tube.pressure_pa * M_PI * kRadius_m * kRadius_m), 1.0, 0.02);
  EXPECT_LT(scene.simulation->marker_position(0).head<2>().norm(), kOutside_m);
}

TEST(FibreScene, ATubeTurnedAndOnAnotherMeshDoesTheSame) {
  Tube tube;
  tube.fibres = braid(45.0, tube.length_m);
  const double straight = strain_of(tube);
  tube.size_m = 0.0065;
  const SceneFolder folder;
  const Scene scene = load_scene(folder.write("tube.yaml", scene_of(tube)), tube_options());
  const Body& upright = scene.simulation->body();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.2, -0.9, 0.4).normalized()).matrix();
  TetMesh mesh = upright.mesh();
  mesh.nodes_m = turn * mesh.nodes_m;
  std::vector<Material> materials;
  for (std::size_t region = 0; region < mesh.regions.size(); ++region)
    for (int tet = 0; tet < mesh.tet_count(); ++tet)
      if (mesh.region_of(tet) == static_cast<int>(region)) {
        materials.push_back(upright.material_of(tet));
        break;
      }
  Body body(mesh, materials);
  for (int node = 0; node < mesh.node_count(); ++node) {
    const Eigen::Array3d at_m = mesh.nodes_m.col(node);
    if (upright.fixed()(0, node)) body.fix_nodes(at_m - 1e-9, at_m + 1e-9, {true, true, true});
  }
  for (Fibre fibre : upright.fibres()) {
    for (auto& line : fibre.lines_m)
      for (Eigen::Vector3d& point_m : line) point_m = turn * point_m;
    body.add_fibre(std::move(fibre));
  }
  const MeshLocator locator(body.mesh());
  auto chamber = std::make_unique<Chamber>();
  chamber->initialise(YamlNode::parse("{name: air, surface: cavity, command: gauge_pressure}", "chamber"), body,
                      locator);
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::move(chamber));
  std::vector<Marker> markers;
  for (const Marker& marker : scene.simulation->markers())
    markers.emplace_back(marker.name(), turn * marker.rest_position_m(), body.mesh(), locator);
  Simulation turned(std::move(body), std::move(actuators), std::move(markers), {});
  turned.set_command("air", tube.pressure_pa);
  ASSERT_TRUE(turned.solve_equilibrium().converged);
  EXPECT_NEAR(strain_of(turned) / straight, 1.0, 0.03);
}

std::string message_of(const std::string& fibres) {
  const SceneFolder folder;
  Tube tube;
  tube.fibres = fibres;
  try {
    load_scene(folder.write("tube.yaml", scene_of(tube)), tube_options());
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "";
}

TEST(FibreScene, RefusesWhatCannotBe) {
  const std::string around = "start_m: [0, 0, 0.01], end_m: [0, 0, 0.05], ";
  for (const auto& [text, said] : std::vector<std::pair<std::string, std::string>>{
           {"{name: a, axial_stiffness_n: 1, winding: {" + around + "radius_m: 0.01, pitch_m: 0}}", "pitch_m"},
           {"{name: a, axial_stiffness_n: 1, winding: {" + around + "radius_m: 0, pitch_m: 0.01}}", "radius_m"},
           {"{name: a, axial_stiffness_n: 1, winding: {" + around + "radius_m: 0.01}}", "pitch_m, angle_deg"},
           {"{name: a, axial_stiffness_n: 1, winding: {" + around + "radius_m: 0.02, pitch_m: 0.01}}",
            "leaves the body at"},
           {"{name: a, axial_stiffness_n: 1, winding: {" + around + "radius_m: 0.01, pitch_m: 1.0e-7}}", "turns"},
           {"{name: a, axial_stiffness_n: 1, winding: {" + around + "radius_m: 0.01, angle_deg: 90}}", "angle_deg"},
           {"{name: a, axial_stiffness_n: 1, winding: {" + around + "around: skin, offset_m: 0.001, pitch_m: 0.01}}",
            "unknown surface"},
           {"{name: a, axial_stiffness_n: 1, rings: {" + around + "radius_m: 0.01, spacing_m: -1}}", "spacing_m"},
           {"{name: a, axial_stiffness_n: 1, rings: {start_m: [0, 0, 0], end_m: [0, 0, 0], radius_m: 0.01, spacing_m: "
            "1}}",
            "end_m"},
           {"{name: a, axial_stiffness_n: -1, points_m: [[0.01, 0, 0.01], [0.01, 0, 0.05]]}", "axial_stiffness_n"},
           {"{name: a, axial_stiffness_n: 1.0e+9, points_m: [[0.01, 0, 0.01], [0.01, 0, 0.05]]}", "out of range"},
           {"{name: a, axial_stiffness_n: .nan, points_m: [[0.01, 0, 0.01], [0.01, 0, 0.05]]}", "axial_stiffness_n"},
           {"{name: a, modulus_pa: 1.0e+9, points_m: [[0.01, 0, 0.01], [0.01, 0, 0.05]]}", "diameter_m"},
           {"{name: a, axial_stiffness_n: 1}", "must have one of"},
           {"{name: a, modulus_pa: 1, sheet: {thickness_m: 1, corners_m: [[0, 0, 0], [0, 0, 1], [0, 1, 2]]}}",
            "right angle"},
           {"{name: a, only_tension: true, modulus_pa: 1, sheet: {thickness_m: 1, corners_m: [[0, 0, 0], [0, 0, 1], "
            "[0, 1, 1]]}}",
            "must be false"},
           {"{name: a, modulus_pa: 1, sheet: {thickness_m: 0, corners_m: [[0, 0, 0], [0, 0, 1], [0, 1, 1]]}}",
            "thickness_m"},
           {"{name: a, modulus_pa: 1, sheet: {thickness_m: 1, corners_m: [[0, 0, 0], [0, 0, 1]]}}", "three corners"},
           {"{name: a, axial_stiffness_n: 1, points_m: [[0.01, 0, 0.01]]}", "two points"},
           {"{name: a, axial_stiffness_n: 1, points_m: [[0.01, 0, 0.01], [0.01, 0, 0.05]], pitch: 1}", "pitch"}})
    EXPECT_NE(message_of("  - " + text + "\n").find(said), std::string::npos) << text << "\n"
                                                                              << message_of("  - " + text + "\n");
}

TEST(FibreScene, WindsAroundASurface) {
  Tube tube;
  tube.fibres =
      "  - {name: a, modulus_pa: 1.0e+9, diameter_m: 0.0002, winding: {start_m: [0, 0, 0.01], end_m: [0, 0, 0.05], "
      "around: "
      "cavity, offset_m: 0.001, pitch_m: 0.01}}\n";
  const SceneFolder folder;
  const Scene scene = load_scene(folder.write("tube.yaml", scene_of(tube)), tube_options());
  const Fibre& fibre = scene.simulation->body().fibres().at(0);
  EXPECT_NEAR(fibre.axial_stiffness_n, 31.4159, 1e-3);
  double length_m = 0.0;
  for (const FibreGroup& group : scene.simulation->body().fibre_groups()) length_m += group.rest_length_m;
  EXPECT_NEAR(length_m, 4.0 * std::hypot(2.0 * M_PI * kRadius_m, 0.01), 0.02 * length_m);
}

TEST(FibreScene, WarnsOfAFibreThatIsHeld) {
  Tube tube;
  tube.fibres = "  - {name: inside, axial_stiffness_n: 1, points_m: [[-0.004, 0, 0.001], [0.004, 0, 0.001]]}\n";
  const SceneFolder folder;
  const Scene scene = load_scene(folder.write("tube.yaml", scene_of(tube)), tube_options());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].kind, "held_fibre");
}

TEST(FibreScene, AStateThatIsRestoredGoesOnToTheLastBit) {
  Tube tube;
  tube.fibres = braid(45.0, tube.length_m);
  const SceneFolder folder;
  const Scene scene = load_scene(folder.write("tube.yaml", scene_of(tube)), tube_options());
  Simulation& first = *scene.simulation;
  first.set_command("air", 1000.0);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(first.step().converged);
  Simulation second(first.model());
  second.set_state(first.state());
  for (int i = 0; i < 5; ++i)
    for (Simulation* each : {&first, &second}) ASSERT_TRUE(each->step().converged);
  EXPECT_TRUE(first.state() == second.state());
}

// Of a bar of 100 x 20 x 4 mm with a sheet in its middle plane, pulled along x.
double stretched_m(const std::string& corners, double force_n) {
  const SceneFolder folder;
  const std::string text =
      R"(body:
  solid: {box: {size_m: [0.1, 0.02, 0.004], center_m: [0.05, 0, 0]}}
  element_size_m: 0.006
  material: {youngs_modulus_pa: 100000, poissons_ratio: 0.45}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]
fibres: [{name: paper, modulus_pa: 1.0e+8, sheet: {thickness_m: 0.0001, corners_m: )" +
      corners + "}}]\nloads: [{box: {min_m: [0.099999, -1, -1], max_m: [1, 1, 1]}, force_n: [" +
      std::to_string(force_n) +
      ", 0, 0]}]\nmarkers:\n  - {name: low, position_m: [0.03, 0, 0]}\n  - {name: high, position_m: "
      "[0.07, 0, 0]}\n";
  Scene scene = load_scene(folder.write("sheet.yaml", text), tube_options());
  EXPECT_TRUE(run_scene(scene).solve.converged);
  return strain_of(*scene.simulation);
}

TEST(FibreScene, ASheetIsAnEvenMembrane) {
  // E t w of the sheet and E A of the silicone.
  constexpr double kStiffness_n = 1e8 * 1e-4 * 0.02 + 1e5 * 0.02 * 0.004, kForce_n = 0.2;
  const double along = stretched_m("[[0.1, -0.01, 0], [0, -0.01, 0], [0, 0.01, 0]]", kForce_n);
  const double turned = stretched_m("[[0, 0.01, 0], [0, -0.01, 0], [0.1, -0.01, 0]]", kForce_n);
  EXPECT_NEAR(along * kStiffness_n / kForce_n, 1.0, 0.02);
  EXPECT_NEAR(turned / along, 1.0, 0.02);
}

Scene load_robot(const std::string& robot) {
  return load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/" + robot + "/robot.yaml", tube_options());
}

double growth_of(const Simulation& simulation, const std::string& chamber) {
  const ActuatorReading reading = simulation.actuator_state(simulation.actuator_index(chamber));
  return *reading.volume_m3 / *reading.initial_volume_m3;
}

TEST(FibreRobots, TheArmBendsAtFortyKilopascalWithoutBallooning) {
  Scene scene = load_robot("fibre_arm");
  Simulation& arm = *scene.simulation;
  arm.set_command("a", 40000.0);
  const SolveReport report = arm.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_LT(growth_of(arm, "a"), 1.7);
  const Eigen::Vector3d moved_m = arm.marker_position(1) - arm.markers()[1].rest_position_m();
  EXPECT_LT(moved_m.x(), -0.05);  // away from the chamber
}

TEST(FibreRobots, TheFingerCurlsAndItsSensitivityIsThatOfDifferences) {
  Scene scene = load_robot("fibre_finger");
  Simulation& finger = *scene.simulation;
  const auto tip_m = [&](double pressure_pa) {
    finger.set_command("air", pressure_pa);
    const SolveReport report = finger.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    return finger.marker_position(1);
  };
  const Eigen::Vector3d more = tip_m(30300.0), less = tip_m(29700.0), by_difference = (more - less) / 600.0;
  const Eigen::Vector3d at = tip_m(30000.0), exact = finger.marker_sensitivities().block<3, 1>(3, 0);
  EXPECT_LT(at.z(), -0.02);
  EXPECT_LT((exact - by_difference).norm(), 0.01 * exact.norm());
  EXPECT_LT(growth_of(finger, "air"), 1.5);
}

TEST(FibreRobots, MoveInTimeToTheSameRest) {
  Scene scene = load_robot("fibre_finger");
  Simulation& finger = *scene.simulation;
  finger.set_command("air", 10000.0);
  ASSERT_TRUE(finger.solve_equilibrium().converged);
  const Eigen::Vector3d rest_m = finger.marker_position(1);
  finger.reset();
  finger.set_command("air", 10000.0);
  finger.keep_energy_ledger();
  for (int i = 0; i < 240; ++i) ASSERT_TRUE(finger.step().converged) << i;
  EXPECT_LT((finger.marker_position(1) - rest_m).norm(), 5e-4);
  const EnergyLedger ledger = *finger.energy_ledger();
  EXPECT_LT(std::abs(ledger.closure_error_j), 0.01 * ledger.turned_over_j);
}

TEST(FibreRobots, MoveWithADampedSilicone) {
  for (const char* integrator : {"implicit_euler", "tr_bdf2"}) {
    const SceneFolder folder;
    Scene scene = load_scene(folder.write("damped.yaml", std::string("include: ") + SOFT_ROBOT_LAB_SOURCE +
                                                             "/config/robots/fibre_finger/robot.yaml\nbody: {damping: "
                                                             "{rayleigh_stiffness_s: 0.01}}\nsolver: {integrator: " +
                                                             integrator + "}\n"),
                             tube_options());
    Simulation& finger = *scene.simulation;
    finger.set_command("air", 20000.0);
    finger.keep_energy_ledger();
    for (int i = 0; i < 30; ++i) ASSERT_TRUE(finger.step().converged) << i << integrator;
    const EnergyLedger ledger = *finger.energy_ledger();
    EXPECT_LT(std::abs(ledger.closure_error_j), 0.01 * ledger.turned_over_j);
  }
}

std::string refusal(const std::string& more) {
  const SceneFolder folder;
  Tube tube;
  tube.fibres = "  - {name: a, axial_stiffness_n: 1, points_m: [[0.01, 0, 0.01], [0.01, 0, 0.05]]}\n";
  try {
    load_scene(folder.write("tube.yaml", scene_of(tube) + more), tube_options());
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "";
}

TEST(FibreScene, SaysWhichSolversDoNotKnowFibres) {
  EXPECT_NE(refusal("solver: {method: xpbd}\n").find("choose method newton"), std::string::npos);
  EXPECT_EQ(refusal(""), "");
}

}  // namespace
}  // namespace soft_robot_lab
