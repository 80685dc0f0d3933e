// SPDX-License-Identifier: BSD-3-Clause
// Loads, held regions and the account of energy, from a scene's file to its result.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene_files.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kWeight_n = 0.1 * 0.02 * 0.02 * 1070.0 * 9.81;

Scene bar_with(const std::string& keys) {
  const SceneFolder folder;
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  return load_scene(folder.write("scene.yaml", "include: bar.yaml\ncables: []\n" + keys), options);
}

nlohmann::json result_of(const std::string& keys) {
  Scene scene = bar_with(keys);
  const RunReport report = run_scene(scene);
  EXPECT_TRUE(report.solve.converged) << report.solve.message;
  return nlohmann::json::parse(result_json(scene, report));
}

void expect_refused(const std::string& keys, const std::string& words) {
  try {
    bar_with(keys);
    ADD_FAILURE() << "accepted: " << keys;
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Loads, EachHeldRegionHasItsReaction) {
  const nlohmann::json result = result_of(
      "body: {fixed: [{name: base, box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}},\n"
      "               {box: {min_m: [0.099999, -1, -1], max_m: [1, 1, 1]},\n"
      "                motion: [{time_s: 0}, {time_s: 1, translation_m: [0.002, 0, 0]}]}]}\n");
  const auto &base = result["reactions"]["base"]["force_n"], &grip = result["reactions"]["1"]["force_n"];
  EXPECT_NEAR(result["markers"]["tip"]["position_m"][0].get<double>(), 0.102, 1e-9);
  EXPECT_GT(grip[0].get<double>(), 1.0);  // some E A strain = 2.1 N
  EXPECT_NEAR(base[0].get<double>() + grip[0].get<double>(), 0.0, 1e-4);
  EXPECT_NEAR(base[1].get<double>() + grip[1].get<double>(), kWeight_n, 1e-4);
}

TEST(Loads, AWeightAtAMarkerIsTheForceOfItsWeight) {
  const nlohmann::json hung = result_of("loads: [{marker: tip, mass_kg: 0.002}]\n"),
                       pulled = result_of("loads: [{point_m: [0.1, 0, 0], force_n: [0, -0.01962, 0]}]\n");
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(hung["markers"]["tip"]["position_m"][axis].get<double>(),
                pulled["markers"]["tip"]["position_m"][axis].get<double>(), 1e-7);
  EXPECT_NEAR(hung["reaction"]["force_n"][1].get<double>(), kWeight_n + 0.01962, 1e-4);
}

TEST(Loads, ARunInTimeKeepsAccountOfEnergy) {
  const nlohmann::json energy = result_of("run: {mode: dynamic, duration_s: 0.3}\n")["energy"];
  EXPECT_LT(energy["gravity_j"].get<double>(), 0.0);
  EXPECT_LT(std::abs(energy["closure_error_j"].get<double>()), 0.01 * energy["turned_over_j"].get<double>());
}

TEST(Loads, WhatCannotBeIsRefused) {
  expect_refused("loads: [{point_m: [0.2, 0, 0], mass_kg: 0.1}]\n", "off the body");
  expect_refused("loads: [{point_m: [0.1, 0, 0], mass_kg: 0.1, string_m: 0.2}]\n", "string is not supported");
  expect_refused("loads: [{point_m: [0.1, 0, 0], mass_kg: 0}]\n", "mass_kg");
  expect_refused("loads: [{marker: top, mass_kg: 0.1}]\n", "unknown marker 'top'; known: tip, middle");
  expect_refused("loads: [{point_m: [0.1, 0, 0], force_n: [1, 0, 0], mass_kg: 0.1}]\n", "one of mass_kg, force_n");
  expect_refused("loads: [{force_n: [1, 0, 0]}]\n", "one of box, point_m, marker");
  expect_refused(
      "body: {fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}, motion: [{time_s: 0, translation_m: [1, 0, "
      "0]}]}]}\n",
      "at time_s 0 the region must be where the mesh has it");
}

}  // namespace
}  // namespace soft_robot_lab
