// Scenes of the package against reference solutions (config/reference).
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "reference_table.h"
#include "scene/scene_files.h"
#include "soft_robot_lab/actuators/factory.h"
#include "soft_robot_lab/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

// How far the scene's first marker moves to equilibrium, with `changes` on top of a scene of the package.
Eigen::Vector3d displacement_m(const std::string& scene_name, const std::string& changes) {
  const SceneFolder folder;
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  const std::string base = std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/scenes/" + scene_name + ".yaml";
  Scene scene = load_scene(folder.write("scene.yaml", "include: " + base + "\n" + changes), options);
  const RunReport report = run_scene(scene);
  EXPECT_TRUE(report.solve.converged) << report.solve.message;
  EXPECT_LE(report.solve.iterations, 10);
  return scene.simulation->marker_position(0) - scene.simulation->markers()[0].rest_position_m();
}

void expect_near(const Eigen::Vector3d& found_m, const Eigen::Vector3d& expected_m, double relative) {
  EXPECT_LT((found_m - expected_m).norm(), relative * expected_m.norm())
      << found_m.transpose() << " instead of " << expected_m.transpose();
}

TEST(Reference, CantileverSagsUnderItsWeight) {
  for (const ReferenceRow& row : read_reference("r1_cantilever")) {
    if (row.text("law") != "iso") continue;
    SCOPED_TRACE(row.text("nu"));
    const Eigen::Vector3d found_m = displacement_m(
        "cantilever", "body: {element_size_m: 0.008, material: {poissons_ratio: " + row.text("nu") + "}}\n");
    expect_near(found_m, {row.number("tip_ux_m"), row.number("tip_uy_m"), 0.0}, 0.01);
  }
}

TEST(Reference, CooksMembraneShears) {
  for (const ReferenceRow& row : read_reference("r2_cook")) {
    if (row.text("law") != "iso") continue;
    const bool plane_strain = row.text("faces_z") == "plane_strain";
    SCOPED_TRACE(row.text("faces_z") + " " + row.text("nu") + " " + row.text("traction_y_Pa"));
    const Eigen::Vector3d found_m =
        displacement_m(plane_strain ? "cook_plane_strain" : "cook",
                       "body: {material: {poissons_ratio: " + row.text("nu") +
                           "}}\nloads: [{box: {min_m: [0.047999, -1, -1], max_m: [1, 1, 1]}, traction_pa: [0, " +
                           row.text("traction_y_Pa") + ", 0]}]\n");
    expect_near(found_m, {row.number("mid_right_ux_m"), row.number("mid_right_uy_m"), 0.0}, 0.01);
    if (plane_strain) {
      EXPECT_LT(std::abs(found_m.z()), 1e-12);
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
