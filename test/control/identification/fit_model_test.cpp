// SPDX-License-Identifier: BSD-3-Clause
// Fitting to rest states, on a coarse bar with two cables whose truth is known.
#include "soft_robot_lab/control/identification/fit_model.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "control/identification/pose_model.h"
#include "fitted_bar.h"
#include "robot/scene/block_beside.h"

namespace soft_robot_lab {
namespace {

TEST(FitModel, FindsWhatMadeTheData) {
  const std::string given = kLying + "cables: [" + cable("left", -0.007, "compliance_m_n: 1.0e-5") + ", " +
                            cable("right", 0.007, "compliance_m_n: 1.0e-5") + "]\n";
  const std::string truth = kLying + "body: {material: {youngs_modulus_pa: 303830}}\ncables: [" +
                            cable("left", -0.007, "compliance_m_n: 2.0e-4, length_offset_m: 0.0006") + ", " +
                            cable("right", 0.007, "compliance_m_n: 2.0e-4, length_offset_m: -0.0004") + "]";
  Eigen::Isometry3d shifted(Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, -1).normalized()));
  shifted.translation() << 0.002, -0.001, 0.0015;
  FitRequest request;
  request.model_error_m = 0.0;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}},
                        {"compliance_m_n", {}, {}, {}},
                        {"length_offset_m", {}, {}, {}},
                        {"camera_to_base", {}, {}, {}}};
  const FitResult result = fit_model(kScene, options_with(given), measure(truth, kWay, shifted, 5e-5, 1), request);
  EXPECT_TRUE(result.converged) << result.message;
  expect_within(result, "youngs_modulus_pa", 303830);
  EXPECT_LT(value_of(result, "youngs_modulus_pa").deviation, 0.03 * 303830);
  expect_within(result, "compliance_m_n", 2e-4);
  expect_within(result, "length_offset_m.left", 6e-4);
  expect_within(result, "length_offset_m.right", -4e-4);
  expect_within(result, "camera_to_base.x_m", 0.002);
  EXPECT_GT(result.before.rms_m, 1e-3);
  EXPECT_LT(result.after.rms_m, 1.2e-4);
  EXPECT_GT(result.after.rms_m, 0.5e-4);  // no more than the noise allows

  // Poses that it has not seen, with the scene that it writes.
  const std::string file =
      std::filesystem::temp_directory_path().string() + "/soft_robot_lab_fitted_" + std::to_string(getpid()) + ".yaml";
  EXPECT_NO_THROW(require_own_or_new(file));
  write_fitted_scene(result, kScene, file);
  EXPECT_NO_THROW(require_own_or_new(file)) << "a fit may write over an earlier one";
  const std::vector<MeasuredPose> unseen = measure(truth, {{0.92, 0.98}, {0.97, 0.9}}, shifted, 0.0, 2);
  EXPECT_LT(model_gap(file, options_with(""), unseen, result.measured_from_base).rms_m,
            0.1 * model_gap(kScene, options_with(given), unseen).rms_m);
  std::filesystem::remove(file);
}

// In the midst of a solve; the best so far counts where there is one.
TEST(FitModel, EndsWithinASolveWhereItIsInterrupted) {
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", 150000.0, {}, {}}};
  const std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 5e-5, 1);
  int asked = 0, iterations = 0, answers = 5;
  bool stop = false;
  SceneOptions options = options_with(kLying);
  options.interrupt = [&] { return stop && ++asked > answers; };
  request.progress = [&](int iteration, double) {
    iterations = iteration;
    stop = iteration >= 1;
    return asked == 0;
  };
  const FitResult result = fit_model(kScene, options, poses, request);
  EXPECT_EQ(iterations, 2) << "the next iteration ended within its first solves";
  EXPECT_FALSE(result.converged);
  EXPECT_GT(value_of(result, "youngs_modulus_pa").value, 200000.0);
  EXPECT_LT(result.after.rms_m, result.before.rms_m);
  for (const int later : {50, 100, 150, 200, 300}) {  // among the derivatives of what was found last, too
    stop = false;
    asked = 0;
    answers = later;
    EXPECT_LT(fit_model(kScene, options, poses, request).after.rms_m, result.before.rms_m) << later;
  }
  options.interrupt = [] { return true; };
  EXPECT_THROW(fit_model(kScene, options, poses, request), std::runtime_error);
}

TEST(FitModel, NamesHoldsThatAreLeftOut) {
  std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 5e-5, 1);
  poses[2].markers.clear();
  poses[2].left_out = "no marker was seen";
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}};
  EXPECT_TRUE(warns(fit_model(kScene, options_with(kLying), poses, request),
                    "a hold of (left 0.9, right 1) is left out: no marker was seen"));
}

// As a service may be asked to by anybody.
TEST(FitModel, WritesOverNothingThatNoFitWrote) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("soft_robot_lab_own_" + std::to_string(getpid()));
  fs::create_directories(folder / "sub");
  std::ofstream(folder / "diary.txt") << "dear diary\n";
  std::ofstream(folder / "empty.yaml");
  fs::create_symlink(folder / "nowhere", folder / "link.yaml");
  for (const char* name : {"diary.txt", "empty.yaml", "link.yaml", "sub"})
    EXPECT_THROW(require_own_or_new(folder / name), std::invalid_argument) << name;
  EXPECT_THROW(require_own_or_new("/dev/null"), std::invalid_argument);
  EXPECT_NO_THROW(require_own_or_new(folder / "new.yaml"));
  fs::remove_all(folder);
}

TEST(FitModel, WritesOverNoSceneThatItReads) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("soft_robot_lab_read_" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "fitted.yaml") << "include: " << kScene << "\n";
  std::ofstream(folder / "tuned.yaml") << "include: fitted.yaml\n";
  std::ofstream(folder / "circle.yaml") << "include: circle.yaml\n";
  fs::create_symlink(folder / "fitted.yaml", folder / "link.yaml");
  for (const auto& [file, scene] : std::vector<std::pair<std::string, std::string>>{
           {"fitted.yaml", "fitted.yaml"}, {"fitted.yaml", "tuned.yaml"}, {"link.yaml", "tuned.yaml"}})
    EXPECT_THROW(require_not_read(folder / file, folder / scene), std::invalid_argument) << file << " of " << scene;
  for (const char* scene : {"fitted.yaml", "tuned.yaml", "circle.yaml"})
    EXPECT_NO_THROW(require_not_read(folder / "new.yaml", folder / scene)) << scene;
  fs::remove_all(folder);
}

// Tendons that command tension weigh the robot, so that stiffness and density can both be identified.
TEST(FitModel, FindsStiffnessAndDensityWhereCablesCommandTensions) {
  const auto with_tensions = [](const std::string& material) {
    return kLying + "body: {material: {" + material + "}}\ncables: [" + cable("left", -0.007, "command: tension_n") +
           ", " + cable("right", 0.007, "command: tension_n") + "]\n";
  };
  const std::string truth = with_tensions("youngs_modulus_pa: 303830, density_kg_m3: 1300");
  const std::vector<MeasuredPose> poses =
      measure(truth, {{0.0, 0.0}, {0.3, 0.0}, {0.6, 0.1}, {0.0, 0.5}}, Eigen::Isometry3d::Identity(), 0.0, 1);
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}, {"density_kg_m3", {}, {}, {}}};
  const FitResult result = fit_model(kScene, options_with(with_tensions("density_kg_m3: 1070")), poses, request);
  EXPECT_TRUE(result.converged) << result.message;
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 303830, 300);
  EXPECT_NEAR(value_of(result, "density_kg_m3").value, 1300, 2);
  request.mass_kg = 0.05;
  EXPECT_THROW(fit_model(kScene, options_with(with_tensions("")), poses, request), std::invalid_argument);
}

// Back and forth, so that each drive turns within its play, out of it, and through it.
const std::vector<std::pair<double, double>> kBackAndForth = {
    {0.96, 1.0}, {0.92, 1.0},  {0.926, 1.0},  {0.94, 0.97},  {0.98, 0.94},  {1.0, 0.90},
    {1.0, 0.91}, {0.97, 0.93}, {0.95, 0.932}, {0.958, 0.96}, {0.965, 0.99}, {0.99, 0.98}};

// Where drives with play leave the cables, 0.1 m long.
std::vector<std::pair<double, double>> behind_play(double left_m, double right_m) {
  std::vector<std::pair<double, double>> ends;
  double left = 1.0, right = 1.0;
  for (const auto& [asked_left, asked_right] : kBackAndForth) {
    left = std::min(asked_left, std::max(asked_left - left_m / 0.1, left));
    right = std::min(asked_right, std::max(asked_right - right_m / 0.1, right));
    ends.emplace_back(left, right);
  }
  return ends;
}

std::vector<MeasuredPose> measure_behind_play(const std::string& overrides, double left_m, double right_m,
                                              double noise_m) {
  std::vector<MeasuredPose> poses =
      measure(overrides, behind_play(left_m, right_m), Eigen::Isometry3d::Identity(), noise_m, 1);
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i].commands = {{"left", kBackAndForth[i].first}, {"right", kBackAndForth[i].second}};
  return poses;
}

TEST(FitModel, FindsBacklashBesideLengthAndStiffness) {
  const std::string truth = kLying + "body: {material: {youngs_modulus_pa: 290000}}\ncables: [" +
                            cable("left", -0.007, "length_offset_m: 0.0003") + ", " +
                            cable("right", 0.007, "length_offset_m: -0.0002") + "]";
  const std::string given = kLying + "cables: [" + cable("left", -0.007, "length_offset_m: 0") + ", " +
                            cable("right", 0.007, "length_offset_m: 0") + "]";
  FitRequest request;
  request.model_error_m = 0.0;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}, {"length_offset_m", {}, {}, {}}, {"backlash_m", {}, {}, {}}};
  const std::vector<MeasuredPose> poses = measure_behind_play(truth, 4e-4, 7e-4, 2e-5);
  const FitResult result = fit_model(kScene, options_with(given), poses, request);
  EXPECT_TRUE(result.converged) << result.message;
  expect_within(result, "backlash_m.left", 4e-4);
  expect_within(result, "backlash_m.right", 7e-4);
  EXPECT_LT(value_of(result, "backlash_m.left").deviation, 0.1 * 4e-4);
  expect_within(result, "length_offset_m.left", 3e-4);
  expect_within(result, "youngs_modulus_pa", 290000);
  SceneOptions fitted = options_with("");
  fitted.overrides = result.overrides;
  EXPECT_LT(model_gap(kScene, fitted, poses, {Eigen::Isometry3d::Identity()}, result.backlash_m).rms_m, 5e-5);
  EXPECT_GT(model_gap(kScene, fitted, poses).rms_m, 1e-4) << "without the backlash it does not fit";
}

// With friction what slipped on the way depends on the backlash as well.
TEST(FitModel, DifferentiatesByBacklashAlongTheWay) {
  const std::string scene = kLying + "cables: [" + cable("left", -0.007, "model: friction, friction_coefficient: 0.3") +
                            ", " + cable("right", 0.007, "model: friction, friction_coefficient: 0.3") + "]";
  const std::vector<MeasuredPose> poses = measure_behind_play(scene, 0.0, 0.0, 0.0);
  const auto predict = [&](double left_m, bool derivatives) {
    PoseModel::Parameters parameters;
    if (derivatives) parameters = [](const Simulation&) { return std::vector<ModelParameter>{{"backlash_m", {0}}}; };
    return PoseModel(kScene, options_with(""), poses)
        .predict(overrides_from(scene), parameters, {{"left", left_m}, {"right", 6e-4}});
  };
  constexpr double h_m = 1e-6;
  const auto at = predict(4e-4, true), less = predict(4e-4 - h_m, false), more = predict(4e-4 + h_m, false);
  double largest = 0.0;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const Eigen::Matrix3Xd difference = (more[p].markers_m - less[p].markers_m) / (2.0 * h_m);
    const Eigen::Map<const Eigen::VectorXd> expected(difference.data(), difference.size());
    EXPECT_LT((at[p].jacobian.col(0) - expected).norm(), 0.02) << "pose " << p;
    largest = std::max(largest, expected.norm());
  }
  EXPECT_GT(largest, 0.5);
}

TEST(FitModel, FindsFrictionFromTheWayThere) {
  const auto with_friction = [](const std::string& coefficient) {
    return kLying + "cables: [" + cable("left", -0.007, "model: friction, friction_coefficient: " + coefficient) +
           ", " + cable("right", 0.007, "model: friction, friction_coefficient: " + coefficient) + "]";
  };
  FitRequest request;
  request.model_error_m = 0.0;
  request.parameters = {{"friction_coefficient", 0.15, {}, {}}, {"youngs_modulus_pa", {}, {}, {}}};
  // In small moves, as rigs and fits make them.
  std::vector<std::pair<double, double>> way;
  for (double c = 1.0; c > 0.85; c -= 0.02) way.emplace_back(c, 1.0);
  for (double c = 0.86; c < 0.95; c += 0.02) way.emplace_back(c, 1.0);
  const std::vector<MeasuredPose> poses = measure(with_friction("0.3"), way, Eigen::Isometry3d::Identity(), 0.0, 1);
  const FitResult result = fit_model(kScene, options_with(with_friction("0.1")), poses, request);
  EXPECT_NEAR(value_of(result, "friction_coefficient").value, 0.3, 0.01) << summary(result);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 264200, 2600) << summary(result);
}

// Noise on a way with friction: where cables begin to slip is not smooth, and no step gains at the end.
TEST(FitModel, StopsWhereStepsAreInVain) {
  const std::string scene = kLying + "cables: [" +
                            cable("left", -0.007, "model: friction, friction_coefficient: 0.02") + ", " +
                            cable("right", 0.007, "model: friction, friction_coefficient: 0.02") + "]";
  FitRequest request;
  request.parameters = {{"friction_coefficient", {}, {}, {}}, {"length_offset_m", {}, {}, {}}};
  double last_m = -1.0;
  int in_vain = 0, most_in_vain = 0;
  request.progress = [&](int iteration, double rms_gap_m) {
    in_vain = iteration > 0 && rms_gap_m == last_m ? in_vain + 1 : 0;
    most_in_vain = std::max(most_in_vain, in_vain);
    last_m = rms_gap_m;
    return true;
  };
  const std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 2e-4, 2);
  EXPECT_TRUE(fit_model(kScene, options_with(scene), poses, request).converged);
  EXPECT_EQ(most_in_vain, 4);
}

TEST(FitModel, TakesThePlaceThatDrivesReallyReached) {
  const std::string truth = kLying + "body: {material: {youngs_modulus_pa: 303830}}\n";
  std::vector<std::pair<double, double>> reached = kWay;
  for (auto& [left, right] : reached) left += 0.003, right -= 0.003;
  std::vector<MeasuredPose> poses = measure(truth, reached, Eigen::Isometry3d::Identity(), 0.0, 1);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].reached = poses[i].commands;
    poses[i].commands = {{"left", kWay[i].first}, {"right", kWay[i].second}};
  }
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}, {"length_offset_m", {}, {}, {}}};
  const FitResult result = fit_model(kScene, options_with(kLying), poses, request);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 303830, 0.01 * 303830) << summary(result);
  EXPECT_NEAR(value_of(result, "length_offset_m.left").value, 0.0, 1e-5);
  EXPECT_LT(result.after.rms_m, 1e-5);
}

TEST(FitModel, TellsStiffnessAgainstTheWeightThatWasWeighed) {
  const std::string truth = kLying + "body: {material: {youngs_modulus_pa: 303830, density_kg_m3: 1177}}\n";
  const std::vector<MeasuredPose> poses = measure(truth, kWay, Eigen::Isometry3d::Identity(), 0.0, 1);
  const Scene model = load_scene(kScene, options_with(kLying));
  const double mass_kg = 1177.0 * volume(model.simulation->body().mesh());
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}};
  EXPECT_NEAR(value_of(fit_model(kScene, options_with(kLying), poses, request), "youngs_modulus_pa").value,
              303830 / 1.1, 5000);
  request.mass_kg = mass_kg;
  const FitResult result = fit_model(kScene, options_with(kLying), poses, request);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 303830, 3000) << summary(result);
  EXPECT_NE(result.overrides.text().find("1177"), std::string::npos) << result.overrides.text();
  for (const double wrong : {0.0, -1.0, std::nan("")}) {
    request.mass_kg = wrong;
    EXPECT_THROW(fit_model(kScene, options_with(kLying), poses, request), std::invalid_argument);
  }
}

TEST(FitModel, SaysWhatTheDataCannotTell) {
  const std::vector<MeasuredPose> slack =
      measure(kLying, {{1.1, 1.1}, {1.2, 1.1}}, Eigen::Isometry3d::Identity(), 0, 1);
  FitRequest request;
  request.parameters = {
      {"youngs_modulus_pa", {}, {}, {}}, {"compliance_m_n.left", {}, {}, {}}, {"damping", {}, {}, {}}};
  const FitResult result = fit_model(kScene, options_with(kLying), slack, request);
  EXPECT_TRUE(warns(result, "cannot identify compliance_m_n.left")) << summary(result);
  EXPECT_TRUE(warns(result, "damping"));
  EXPECT_FALSE(value_of(result, "compliance_m_n.left").identifiable);
  EXPECT_TRUE(value_of(result, "youngs_modulus_pa").identifiable);
  EXPECT_TRUE(result.overrides.has({"body", "material"})) << result.overrides.text();
  EXPECT_FALSE(result.overrides.has({"cables", "left"})) << "left as the scene has it\n" << result.overrides.text();
  EXPECT_NE(summary(result).find("not identifiable from the data: left as the scene has it"), std::string::npos);
  for (const FittedValue& value : result.values) EXPECT_TRUE(std::isfinite(value.deviation)) << value.name;
}

TEST(FitModel, OutliersHardlyMoveIt) {
  std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 5e-5, 3);
  poses[2].markers[0].position_m.y() += 0.02;
  FitRequest request;
  request.model_error_m = 0.0;
  request.parameters = {{"youngs_modulus_pa", 200000.0, {}, {}}};
  const FitResult result = fit_model(kScene, options_with(kLying), poses, request);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 264200, 0.05 * 264200) << summary(result);
  ASSERT_EQ(result.configurations.size(), kWay.size());
  for (std::size_t i = 0; i < kWay.size(); ++i) EXPECT_EQ(result.configurations[i].outlying, i == 2) << summary(result);
  EXPECT_TRUE(warns(result, "configuration 3 (left 0.9, right 1) is missed by 1"))
      << summary(result);  // 20 mm of one of two
  EXPECT_NE(summary(result).find("  3 (left 0.9, right 1): "), std::string::npos) << summary(result);
}

TEST(FitModel, RefusesSeveralBodiesAndMaterials) {
  const std::vector<MeasuredPose> poses = measure(kLying, {{1.0, 1.0}}, Eigen::Isometry3d::Identity(), 1e-4, 1);
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}};
  try {
    fit_model(kScene, options_with(kLying + kBlockBeside), poses, request);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "a fit knows one body of one material, not several");
  }
}

TEST(FitModel, RefusesBadRequests) {
  const std::vector<MeasuredPose> poses = measure(kLying, {{1.0, 1.0}}, Eigen::Isometry3d::Identity(), 1e-4, 1);
  const auto refusal = [&](const std::vector<FitParameter>& parameters, const std::vector<MeasuredPose>& data) {
    FitRequest request;
    request.parameters = parameters;
    try {
      fit_model(kScene, options_with(kLying), data, request);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing refused");
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  has(refusal({{"stiffness", {}, {}, {}}}, poses), "is not one of youngs_modulus_pa");
  has(refusal({{"compliance_m_n.middle", {}, {}, {}}}, poses), "known: left, right");
  has(refusal({{"youngs_modulus_pa", 1.0, 2.0, 3.0}}, poses), "is not in [2, 3]");
  has(refusal({{"youngs_modulus_pa", {}, -1.0, {}}}, poses), "from above 0");
  has(refusal({{"backlash_m", {}, -1e-3, {}}}, poses), "from 0 or more");
  has(refusal({{"compliance_m_n", {}, {}, {}}, {"compliance_m_n.left", {}, {}, {}}}, poses), "twice");
  has(refusal({{"camera_to_base", {}, {}, {}}}, poses), "cannot identify 6 parameters");
  has(refusal({{"youngs_modulus_pa", {}, {}, {}}}, {}), "nowhere at rest");
  has(refusal({{"damping", {}, {}, {}}}, poses), "none that data could identify");
  has(refusal({{"damping", {}, -1.0, {}}}, poses), "from above 0");
  has(refusal({{"damping", 1.0, {}, {}}}, poses), "damping: start 1 is not in [1e-05, 0.1]");
  has(refusal({{"damping", {}, {}, {}}, {"damping", {}, {}, {}}}, poses), "twice");
  std::vector<MeasuredPose> strange = poses;
  strange[0].markers[0].name = "nose";
  has(refusal({{"youngs_modulus_pa", {}, {}, {}}}, strange), "unknown marker 'nose'");
  strange = poses;
  strange[0].markers[0].position_m.x() = std::nan("");
  has(refusal({{"youngs_modulus_pa", {}, {}, {}}}, strange), "not finite");
}

}  // namespace
}  // namespace soft_robot_lab
