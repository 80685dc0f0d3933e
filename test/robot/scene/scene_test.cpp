// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene_file.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

SceneOptions options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

TEST(Scene, BuildsWhatTheFileDescribes) {
  const SceneFolder folder;
  const Scene scene = load_scene(folder.path("bar.yaml"), options());
  const Body& body = scene.simulation->body();
  EXPECT_NEAR(body.node_masses_kg().sum(), 0.1 * 0.02 * 0.02 * 1070, 1e-9);
  EXPECT_TRUE(body.mesh().quadratic());
  EXPECT_GT(body.fixed_node_count(), 0);
  EXPECT_EQ(body.gravity_m_s2(), Eigen::Vector3d(0, -9.81, 0));
  ASSERT_EQ(scene.simulation->actuators().size(), 2u);
  EXPECT_EQ(scene.simulation->actuators()[0]->name(), "left");
  EXPECT_EQ(scene.simulation->marker_index("middle"), 1);
  EXPECT_EQ(scene.run.mode, RunMode::equilibrium);
}

TEST(Scene, KeepsTheStructsDefaults) {
  const SceneFolder folder;
  const Scene scene = load_scene(folder.path("bar.yaml"), options());
  const SolverOptions otherwise;
  EXPECT_EQ(scene.simulation->options().integrator, otherwise.integrator);
  EXPECT_EQ(scene.simulation->options().time_step_s, otherwise.time_step_s);
  EXPECT_EQ(scene.simulation->options().tolerance, otherwise.tolerance);
  EXPECT_EQ(scene.simulation->options().max_iterations, otherwise.max_iterations);
  EXPECT_EQ(scene.run.record_every_s, 0.0);
  EXPECT_FALSE(scene.run.sensitivity);
}

TEST(Scene, LetsTheSiliconeAloneDampWhereItsDampingIsGiven) {
  const SceneFolder folder;
  const auto integrator = [&](const std::string& more) {
    return load_scene(folder.write("damped.yaml", "include: bar.yaml\n" + more), options())
        .simulation->options()
        .integrator;
  };
  const std::string damped = "body: {damping: {rayleigh_stiffness_s: 0.004}}\n";
  EXPECT_EQ(integrator(damped), Integrator::tr_bdf2);
  EXPECT_EQ(integrator("body: {hysteresis: {stiffness_ratio: 0.1, relaxation_time_s: 3}}\n"),
            Integrator::implicit_euler);
  EXPECT_EQ(integrator(damped + "solver: {time_step_s: 0.01}\n"), Integrator::tr_bdf2);
  EXPECT_EQ(integrator(damped + "solver: {integrator: implicit_euler}\n"), Integrator::implicit_euler);
  EXPECT_EQ(integrator("body: {damping: {rayleigh_mass_per_s: 1}}\nsolver: {method: xpbd}\n"),
            Integrator::implicit_euler);
  EXPECT_EQ(integrator("solver: {integrator: tr_bdf2}\n"), Integrator::tr_bdf2);
}

TEST(Scene, ChoosesTheSolver) {
  const SceneFolder folder;
  const std::string path =
      folder.write("scene.yaml", "include: bar.yaml\nsolver: {method: xpbd, substeps: 40, iterations: 2}\n");
  const SolverOptions chosen = load_scene(path, options()).simulation->options();
  EXPECT_EQ(chosen.method, SolverOptions::Method::xpbd);
  EXPECT_EQ(chosen.substep_count, 40);
  EXPECT_EQ(chosen.iteration_count, 2);
}

TEST(Scene, OverridesWhatItIncludes) {
  const SceneFolder folder;
  folder.write("robots/stiff.yaml", "include: ../bar.yaml\nbody: {material: {youngs_modulus_pa: 1.0e+6}}\n");
  const std::string path = folder.write("scene.yaml", R"(include: robots/stiff.yaml
body: {element: linear}
cables: []
markers: [{name: end, position_m: [0.1, 0, 0]}]
solver: {integrator: bdf2}
run: {mode: dynamic, duration_s: 0.5, record_every_s: 0.1, commands: []}
)");
  const Scene scene = load_scene(path, options());
  EXPECT_EQ(scene.simulation->body().material().youngs_modulus_pa, 1.0e6);
  EXPECT_EQ(scene.simulation->body().material().density_kg_m3, 1070);
  EXPECT_FALSE(scene.simulation->body().mesh().quadratic());
  EXPECT_TRUE(scene.simulation->actuators().empty());
  EXPECT_EQ(scene.simulation->options().integrator, Integrator::bdf2);
  ASSERT_EQ(scene.simulation->markers().size(), 1u);  // lists replace
  EXPECT_EQ(scene.run.mode, RunMode::dynamic);
  EXPECT_EQ(scene.run.duration_s, 0.5);
}

TEST(SceneFile, KnowsItsRobot) {
  const SceneFolder files;
  files.write("ball.yaml", "include: ./bar.yaml\n");
  files.write("table.yaml", "include: ball.yaml\n");
  files.write("round.yaml", "include: circle.yaml\n");
  files.write("circle.yaml", "include: round.yaml\n");
  for (const char* name : {"bar.yaml", "ball.yaml", "table.yaml"}) {
    EXPECT_EQ(robot_file(files.path(name)), files.path("bar.yaml"));
    EXPECT_EQ(name_of_robot(files.path(name)), "bar");
  }
  EXPECT_EQ(robot_file(files.path("none.yaml")), files.path("none.yaml"));
  EXPECT_FALSE(robot_file(files.path("round.yaml")).empty()) << "it ends";
  EXPECT_EQ(name_of_robot("/robots/gripper/robot.yaml"), "gripper");
}

TEST(SceneFile, IsKnownOfEveryRobot) {
  const std::filesystem::path robots = std::filesystem::path(SOFT_ROBOT_LAB_SOURCE) / "config/robots";
  for (const auto& folder : std::filesystem::directory_iterator(robots)) {
    EXPECT_TRUE(is_scene_file(folder.path() / "robot.yaml")) << folder;
    EXPECT_FALSE(is_scene_file(folder.path() / "motors.yaml")) << folder;
  }
  const SceneFolder files;
  EXPECT_TRUE(is_scene_file(files.write("two.yaml", "include: bar.yaml\nbodies: []\n")));
  EXPECT_FALSE(is_scene_file(files.write("odd.yaml", "include: bar.yaml\nplant: {}\n")));
}

TEST(Scene, NamesAFileThatIsNone) {
  const SceneFolder files;
  const auto error_of = [](const auto& load) -> std::string {
    try {
      load();
    } catch (const SettingsError& error) {
      return error.what();
    }
    return "accepted";
  };
  for (const std::string key : {"mesh: ", "solid: {stl: ", "solid: {step: "}) {
    const std::string path = files.write("empty.yaml", "body:\n  " + key + "''" + (key[0] == 's' ? "}" : "") + "\n");
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(std::filesystem::path(path).parent_path());
    const std::string error = error_of([&] { load_scene("empty.yaml", options()); });
    std::filesystem::current_path(before);
    EXPECT_NE(error.find("empty.yaml:2: body."), std::string::npos) << error;
    EXPECT_NE(error.find("is empty, must name a file"), std::string::npos) << error;
  }
  const std::string nul = files.write("nul.yaml", "body:\n  mesh: \"a\\0b.msh\"\n");
  EXPECT_NE(error_of([&] { load_scene(nul, options()); }).find("nul.yaml:2: body.mesh: holds a byte of value 0"),
            std::string::npos);
  const std::string long_name = files.write("long.yaml", "include: " + std::string(300, 'x') + ".yaml\n");
  EXPECT_NE(error_of([&] { load_scene(long_name, options()); }).find("long.yaml:1: include: there is no file "),
            std::string::npos);
}

TEST(Scene, AveragesTheVolumeOfLinearElements) {
  const SceneFolder folder;
  const std::string path = folder.write(
      "scene.yaml", "include: bar.yaml\nbody: {element: linear, linear_volume: vertex_averaged}\ncables: []\n");
  EXPECT_EQ(load_scene(path, options()).simulation->body().linear_volume(), LinearVolume::vertex_averaged);
  const std::string wrong =
      folder.write("wrong.yaml", "include: bar.yaml\nbody: {linear_volume: vertex_averaged}\ncables: []\n");
  EXPECT_THROW(load_scene(wrong, options()), SettingsError);
}

TEST(Scene, ReadsDampingAndHysteresis) {
  const SceneFolder folder;
  const auto viscosity = [&](const std::string& keys) {
    const std::string path = folder.write("scene.yaml", "include: bar.yaml\nbody: {" + keys + "}\ncables: []\n");
    return load_scene(path, options()).simulation->body().viscosity();
  };
  EXPECT_FALSE(viscosity("").of_strain());
  const Viscosity all = viscosity(
      "damping: {rayleigh_mass_per_s: 1, rayleigh_stiffness_s: 2}, "
      "hysteresis: {stiffness_ratio: 0.3, relaxation_time_s: 4}");
  EXPECT_EQ(all.rayleigh_mass_per_s, 1.0);
  EXPECT_EQ(all.rayleigh_stiffness_s, 2.0);
  EXPECT_EQ(all.hysteresis_ratio, 0.3);
  EXPECT_EQ(all.relaxation_time_s, 4.0);
  EXPECT_THROW(viscosity("damping: {rayleigh_mass_per_s: -1}"), SettingsError);
  EXPECT_THROW(viscosity("hysteresis: {stiffness_ratio: 0.3}"), SettingsError);
  EXPECT_THROW(viscosity("hysteresis: {stiffness_ratio: 0.3, relaxation_time_s: 0}"), SettingsError);
}

TEST(Scene, LaysChangesOverTheFile) {
  const SceneFolder folder;
  SceneOptions changed = options();
  changed.overrides.set({"body", "material", "poissons_ratio"}, 0.3);
  const Material material = load_scene(folder.path("bar.yaml"), changed).simulation->body().material();
  EXPECT_EQ(material.poissons_ratio, 0.3);
  EXPECT_EQ(material.density_kg_m3, 1070);
  changed.overrides = Overrides().set({"body", "colour"}, "blue");
  try {
    load_scene(folder.path("bar.yaml"), changed);
    ADD_FAILURE() << "accepted";
  } catch (const SettingsError& error) {
    EXPECT_NE(std::string(error.what()).find("(with changes)"), std::string::npos) << error.what();
  }
}

TEST(Scene, FindsFilesBesideTheFileThatNamesThem) {
  const SceneFolder folder;
  const std::string gmsh_bar = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 0.1 0 0
3 0 0.1 0
4 0 0 0.1
$EndNodes
$Elements
1
1 4 2 1 1 1 2 3 4
$EndElements
)";
  folder.write("meshes/one.msh", gmsh_bar);
  folder.write("meshes/one.yaml",
               "body: {mesh: one.msh, fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}, axes: [x]}]}\n");
  const Scene scene = load_scene(folder.write("scene.yaml", "include: meshes/one.yaml\n"), options());
  EXPECT_EQ(scene.simulation->body().mesh().tet_count(), 1);
  EXPECT_EQ(scene.simulation->body().mesh().node_count(), 10);
  EXPECT_FALSE(scene.simulation->body().fixed()(1, 0));
}

TEST(Scene, RefinesTheMeshAroundPlugsWhenAsked) {
  const SceneFolder folder;
  const Scene coarse = load_scene(folder.path("bar.yaml"), options());
  const Scene plugs =
      load_scene(folder.write("plugs.yaml", "include: bar.yaml\nbody: {refine_plugs: true}\n"), options());
  const Scene ball = load_scene(
      folder.write("ball.yaml",
                   "include: bar.yaml\nbody: {refinements: [{center_m: [0, 0, 0], radius_m: 0.01, size_m: 0.005}]}\n"),
      options());
  const int count = coarse.simulation->body().mesh().tet_count();
  EXPECT_GT(plugs.simulation->body().mesh().tet_count(), 2 * count);
  EXPECT_GT(ball.simulation->body().mesh().tet_count(), count);
}

TEST(Scene, SpreadsForceAndTractionAlike) {
  const SceneFolder folder;
  const std::string end = "include: bar.yaml\nloads: [{box: {min_m: [0.099999, -1, -1], max_m: [1, 1, 1]}, ";
  const Scene traction = load_scene(folder.write("t.yaml", end + "traction_pa: [0, 500, 0]}]\n"), options());
  const Scene force = load_scene(folder.write("f.yaml", end + "force_n: [0, 0.2, 0]}]\n"), options());
  const Eigen::Matrix3Xd difference =
      traction.simulation->body().external_forces_n() - force.simulation->body().external_forces_n();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-12);
  const double weight_n = 9.81 * traction.simulation->body().node_masses_kg().sum();
  EXPECT_NEAR(traction.simulation->body().external_forces_n().row(1).sum(), 0.2 - weight_n, 1e-9);
}

struct BadScene {
  std::string text;   // after `include: bar.yaml`, so that it starts in line 2
  std::string words;  // expected in the message
};

void expect_refused(const std::vector<BadScene>& table) {
  const SceneFolder folder;
  for (const BadScene& bad : table) {
    SCOPED_TRACE(bad.text);
    try {
      load_scene(folder.write("bad.yaml", "include: bar.yaml\n" + bad.text + "\n"), options());
      ADD_FAILURE() << "accepted";
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find(bad.words), std::string::npos) << error.what();
    }
  }
}

TEST(Scene, RefusesWithPlaceAndReason) {
  expect_refused({
      {"gravity_m_s: [0, 0, 0]", "bad.yaml:2: unknown key 'gravity_m_s' (did you mean 'gravity_m_s2'?)"},
      {"gravity_m_s2: [0, .nan, 0]", "bad.yaml:2: gravity_m_s2[1]: '.nan' is not a finite number"},
      {"body: {mesh: bar.msh}", "body: must have one of solid, mesh"},
      {"markers: [{name: \"a\\x01b\", position_m: [0, 0, 0]}]",
       "markers[0].name: character 2 of the name is a quote, a backslash or a control character"},
      {"markers: [{name: it's, position_m: [0, 0, 0]}]", "character 3 of the name is a quote"},
      {"markers: [{name: a\xc3, position_m: [0, 0, 0]}]", "markers[0].name: "},
      {"cables: [{name: \"\", points_m: [[0, 0, 0], [0.1, 0, 0]]}]", "cables[0].name: must not be empty"},
      {"cables: [{name: " + std::string(101, 'x') + ", points_m: [[0, 0, 0], [0.1, 0, 0]]}]",
       "the name has 101 characters, must have [1, 100]"},
      {"markers: [{name: far, position_m: [1.0e9, 0, 0]}]",
       "markers[0].position_m[0]: 1.0e9 is out of range [-1000, 1000]"},
      {"loads: [{point_m: [0, 0, 0], force_n: [0, 0, 1.0e+300]}]",
       "force_n[2]: 1.0e+300 is out of range [-1000000000, 1000000000]"},
      {"run: {mode: dynamic, duration_s: 1.0e+19}", "run.duration_s: 1.0e+19 is out of range [-1000000, 1000000]"},
      {"run: {mode: dynamic, duration_s: 1, record_every_s: 1}\nsolver: {time_step_s: 1.0e-17}",
       "run.duration_s: 1 is"},
      {"body:\n  fixed:\n  - {box: {min_m: [5, 5, 5], max_m: [6, 6, 6]}}",
       "bad.yaml:4: body.fixed[0]: no node lies in the box [5, 5, 5] to [6, 6, 6]; the body spans [0, -0.01, -0.01] "
       "to"},
      {"body: {fixed: [{box: {min_m: [1, 0, 0], max_m: [0, 0, 0]}}]}", "body.fixed[0].box: min_m lies beyond max_m"},
      {"body: {fixed: [{box: {min_m: [-1, -1, -1], max_m: [0, 1, 1]}, axes: [w]}]}", "'w' is not one of x, y, z"},
      {"body: {fixed: [{box: {min_m: [-1, -1, -1], max_m: [0, 1, 1]}, axes: []}]}", "at least one of x, y, z"},
      {"body: {fixed: []}", "bad.yaml:2: body.fixed: is empty"},
      {"body: {element: cubic}", "body.element: 'cubic' is not one of linear, quadratic"},
      {"body: {element_size_m: 0}", "body.element_size_m: 0 is out of range (0, inf)"},
      {"body: {refinements: [{center_m: [0, 0, 0], radius_m: 0, size_m: 1}]}", "radius_m: 0 is out of range (0, inf)"},
      {"body: {material: {poissons_ratio: 0.5}}", "poissons_ratio"},
      {"body: {material: {youngs_modulus_pa: -1}}", "youngs_modulus_pa"},
      {"loads: [{box: {min_m: [0, 0, 0], max_m: [1, 1, 1]}}]", "loads[0]: must have one of traction_pa, force_n"},
      {"loads: [{box: {min_m: [3, 3, 3], max_m: [4, 4, 4]}, force_n: [0, 1, 0]}]",
       "no part of a boundary face, and no edge of one, lies in"},
      {"cables: [{name: far, points_m: [[0, 0, 0], [0.1, 0.5, 0]]}]", "bad.yaml:2: cables[0]"},
      {"cables: [{name: left, points_m: [[0, 0, 0], [0.1, 0, 0]], model: rope}]", "'rope' is not one of"},
      {"chambers: [{name: main, surface: cavity}]", "surface: the mesh has no surface 'cavity'; known: none"},
      {"actuators: [{plugin: my_lab/Muscle, name: m}]", "bad.yaml:2: actuators[0].plugin: "},
      {"markers: [{position_m: [0, 0, 0]}]", "markers[0]: key 'name' is missing"},
      {"markers: [{name: a, position_m: [0, 0, 0]}, {name: a, position_m: [0, 0, 0]}]", "two markers are named 'a'"},
      {"contact: {friction: [{between: [skin, skin], coefficient: 0.5}]}",
       "their skin does not touch; contact.self or contact.bodies lets it"},
      {"contact: {self: true, friction: [{between: [skin, skin], coefficient: -1}]}", "coefficient"},
      {"contact: {obstacles: [{plane: 1}]}", "contact.obstacles[0]: key 'name' is missing"},
      {"contact: {obstacles: [{name: floor}]}", "obstacles[0]: must have one of plane, sphere, capsule, cylinder, box"},
      {"contact: {obstacles: [{name: ball, sphere: {center_m: [0, 0, 1], radius_m: 0}}]}",
       "contact: obstacle 'ball': radius_m: 0 is out of range (0, inf)"},
      {"contact: {friction: -1}", "contact.friction: -1 is out of range [0, inf)"},
      {"contact: {friction: [{between: [skin, wall], coefficient: 1}]}", "unknown surface 'wall'; known: skin"},
      {"contact: {obstacles: [{name: floor, plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]}",
       "contact: obstacle 'floor' is"},
      {"contact: {friction: [{between: [skin, skin, skin], coefficient: 1}]}", "must be two names: [skin, floor]"},
      {"contact: {bodies: [[body, second]]}", "contact.bodies[0]: unknown body 'second'; known: body"},
      {"contact: {bodies: [[body, body], [body, body]]}", "contact: contact of 'body' and 'body' is given twice"},
      {"contact: {self: true, bodies: [[body, body]]}", "leave out one of both"},
      {"contact: {obstacles: [{name: a, sphere: {center_m: [0, 0, 1], radius_m: 0.1}, motion: [{time_s: 1}, {time_s: "
       "1}]}]}",
       "motion[1].time_s: 1 is out of range of times that rise from pose to pose: nothing jumps"},
  });
}

// It would hold the default modulus, and none of the preset's numbers.
TEST(Scene, RefusesAModelWithoutModulusOverAnIncludedPreset) {
  const SceneFolder folder;
  folder.write("soft.yaml", "include: bar.yaml\nbody: {material: {preset: ecoflex_00_50}}\n");
  const auto refusal = [&](const std::string& material) -> std::string {
    try {
      load_scene(folder.write("over.yaml", "include: soft.yaml\nbody: {material: {" + material + "}}\n"), options());
    } catch (const SettingsError& error) {
      return error.what();
    }
    return "";
  };
  const std::string model = refusal("model: neo_hookean, density_kg_m3: 1000");
  EXPECT_NE(model.find("over.yaml:2: body.material.model: replaces `preset: ecoflex_00_50` of "), std::string::npos);
  EXPECT_NE(model.find("soft.yaml with all its keys: give youngs_modulus_pa beside it, or leave it out"),
            std::string::npos)
      << model;
  const std::string modulus = refusal("youngs_modulus_pa: 1.0e+5");
  EXPECT_NE(modulus.find("over.yaml:2: body.material.youngs_modulus_pa: stands over `preset: ecoflex_00_50` of "),
            std::string::npos);
  EXPECT_NE(modulus.find("give the `model` of this modulus beside it"), std::string::npos) << modulus;
  for (const std::string material : {"model: neo_hookean, youngs_modulus_pa: 1.0e+5", "model: yeoh, c1_pa: 5.0e+4",
                                     "preset: dragon_skin_10", "stiffness_ratio: 1.1", "density_kg_m3: 1000"})
    EXPECT_EQ(refusal(material), "") << material;
}

TEST(Scene, RefusesFreeObstaclesWithPlaceAndReason) {
  const std::string ball = "{name: ball, sphere: {center_m: [0, 0, 1], radius_m: 0.1}";
  const std::string floor = "{name: floor, plane: {point_m: [0, 0, -1], normal: [0, 0, 1]}}";
  expect_refused({
      {"contact: {obstacles: [" + ball + ", mass_kg: 0}]}", "obstacles[0].mass_kg: 0 is out of range (0, inf)"},
      {"contact: {obstacles: [" + ball + ", mass_kg: 1, motion: [{time_s: 0}]}]}",
       "motion: is for obstacles that it moves"},
      {"contact: {obstacles: [" + ball + ", velocity_m_s: [1, 0, 0]}]}",
       "is for free obstacles; give mass_kg or density_kg_m3 too"},
      {"contact: {obstacles: [" + ball + ", mass_kg: 1, inertia_kg_m2: [1, 1, -1]}]}", "inertia_kg_m2: must be"},
      {"contact: {obstacles: [{name: floor, mass_kg: 1, plane: {point_m: [0, 0, -1], normal: [0, 0, 1]}}]}",
       "mass_kg: a plane cannot be free"},
      {"contact: {friction: [{between: [ball, floor], coefficient: 1}], obstacles: [" + ball + "}, " + floor + "]}",
       "neither 'ball' nor 'floor' is free"},
      {"contact: {friction: [{between: [ball, wall], coefficient: 1}], obstacles: [" + ball + ", mass_kg: 1}]}",
       "unknown surface 'wall'; known: skin, ball"},
      {"contact: {obstacles: [" + ball +
           ", mass_kg: 1}, {name: wall, plane: {point_m: [0, 0, 1], normal: [0, 0, 1]}}]}",
       "obstacle 'wall' is"},
  });
}

// A step's time grows by the cube of their number, so whoever wants many says so.
TEST(Scene, TakesAsManyFreeObstaclesAsItIsToldTo) {
  const SceneFolder folder;
  const auto refusal = [&](int count, const std::string& more) -> std::string {
    std::string balls;
    for (int i = 0; i < count; ++i)
      balls += "{name: b" + std::to_string(i) + ", sphere: {center_m: [" + std::to_string(0.03 * i) +
               ", 0, 1], radius_m: 0.01}, mass_kg: 0.01}, ";
    try {
      load_scene(folder.write("balls.yaml", "include: bar.yaml\ncontact: {" + more + "obstacles: [" + balls + "]}\n"),
                 options());
    } catch (const SettingsError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(100, ""), "");
  EXPECT_NE(refusal(101, "").find("101 have mass_kg, at most contact.max_free_obstacles, 100"), std::string::npos)
      << refusal(101, "");
  EXPECT_EQ(refusal(101, "max_free_obstacles: 101, "), "");
  EXPECT_NE(refusal(3, "max_free_obstacles: 2, ").find("3 have mass_kg, at most contact.max_free_obstacles, 2"),
            std::string::npos);
  EXPECT_NE(refusal(1, "max_free_obstacles: 0, ").find("1 have mass_kg"), std::string::npos);
  EXPECT_NE(refusal(1, "max_free_obstacles: 1001, ").find("max_free_obstacles: 1001 is out of range [0, 1000]"),
            std::string::npos);
}

TEST(Scene, RefusesSolversAndRunsWithPlaceAndReason) {
  expect_refused({
      {"solver: {method: jacobi}", "solver.method: 'jacobi' is not one of newton, xpbd"},
      {"solver: {substeps: 10}", "unknown key 'substeps'"},
      {"solver: {method: xpbd, substeps: 0}", "solver.substeps: 0 is out of range [1, 10000]"},
      {"solver: {method: xpbd, iterations: 10001}", "solver.iterations: 10001 is out of range [1, 10000]"},
      {"solver: {method: xpbd, integrator: bdf2}",
       "solver.integrator: must be implicit_euler with solver.method xpbd, not bdf2"},
      {"solver: {integrator: verlet}", "solver.integrator: 'verlet' is not one of implicit_euler, bdf2"},
      {"solver: {time_step_s: 2}", "time_step_s: 2 is out of range (0, 1]"},
      {"solver: {tolerance: 0}", "tolerance: 0 is out of range (0, 1)"},
      {"solver: {dynamic_tolerance: 1}", "dynamic_tolerance: 1 is out of range (0, 1)"},
      {"solver: {max_iterations: 0}", "max_iterations: 0 is out of range [1, 10000]"},
      {"run: {mode: model}", "run.mode: 'model' is not one of equilibrium, dynamic, modal"},
      {"run: {mode: modal, modes: 0}", "run.modes: 0 is out of range [1, 100]"},
      {"run: {mode: modal, modes: 101}", "run.modes: 101 is out of range [1, 100]"},
      {"run: {mode: modal, modes: 1.5}", "run.modes: '1.5' is not"},
      {"run: {mode: modal, duration_s: 1}", "unknown key 'duration_s'"},
      {"run: {mode: modal, commands: [{left: 0.9}]}", "run.commands: a modal run is about the rest shape"},
      {"run: {modes: 4}", "unknown key 'modes'"},
      {"run: {mode: dynamic}", "run: key 'duration_s' is missing"},
      {"run: {mode: dynamic, duration_s: -1}", "run.duration_s: -1 is out of range (0, inf)"},
      {"run: {mode: dynamic, duration_s: 1, record_every_s: -1}", "record_every_s: -1 is out of range [0, inf)"},
      {"run: {mode: dynamic, duration_s: 1, sensitivity: true}", "unknown key 'sensitivity'"},
      {"run: {sensitivity: 1}", "run.sensitivity: '1' is not true or false"},
      {"run: {commands: [{time_s: 0, left: 7}]}", "run.commands[0].left: 7 is out of range"},
      {"run: {commands: [{time_s: 0, lefd: 0.9}]}", "unknown key 'lefd' (did you mean 'left'?)"},
      {"run: {commands: [{time_s: 1, left: 0.9}, {time_s: 0.5}]}", "run.commands[1].time_s: is earlier than"},
      {"run: {commands: [{time_s: -1}]}", "time_s: -1 is out of range [0, inf)"},
  });
}

TEST(Scene, RefusesIncludesThatLeadNowhere) {
  const SceneFolder folder;
  folder.write("a.yaml", "include: b.yaml\n");
  folder.write("b.yaml", "include: a.yaml\n");
  const std::vector<BadScene> table = {
      {"include: missing.yaml", "there is no file"},
      {"include: a.yaml", "includes itself"},
      {"include: bad.yaml", "includes itself"},
  };
  for (const BadScene& bad : table) {
    SCOPED_TRACE(bad.text);
    try {
      load_scene(folder.write("bad.yaml", bad.text + "\n"), options());
      ADD_FAILURE() << "accepted";
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find(bad.words), std::string::npos) << error.what();
    }
  }
}

TEST(Scene, LoadsEveryFileOfThePackage) {
  int count = 0;
  for (const std::string folder : {"scenes", "robots"}) {
    const std::filesystem::path path = std::filesystem::path(SOFT_ROBOT_LAB_SOURCE) / "config" / folder;
    if (!std::filesystem::exists(path)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (entry.path().extension() != ".yaml") continue;
      SCOPED_TRACE(entry.path());
      EXPECT_NO_THROW(load_scene(entry.path().string(), options()));
      ++count;
    }
  }
  EXPECT_GE(count, 1);
}

}  // namespace
}  // namespace soft_robot_lab
