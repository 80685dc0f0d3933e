// Fitting, on a coarse bar with two cables whose truth is known.
#include "soft_robot_lab/experiment/fit_model.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "experiment/swing_model.h"
#include "soft_robot_lab/actuators/factory.h"

namespace soft_robot_lab {
namespace {

const std::string kScene = std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/scenes/cable_bar.yaml";
// As if the bar lay on its side: its weight bends it, and tells its stiffness.
const std::string kLying = "gravity_m_s2: [0, 9.81, 0]\n";

SceneOptions options_with(const std::string& changes) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.changes = changes;
  return options;
}

std::string cable(const std::string& name, double x, const std::string& rest) {
  const std::string place = std::to_string(x);
  return "{name: " + name + ", points_m: [[" + place + ", 0, 0], [" + place + ", 0, -0.05], [" + place +
         ", 0, -0.1]], " + rest + "}";
}

// Rest states of the scene as cameras would measure them.
std::vector<MeasuredPose> measure(const std::string& changes,
                                  const std::vector<std::pair<double, double>>& contractions,
                                  const Eigen::Isometry3d& measured_from_base, double noise_m, unsigned seed) {
  const Scene scene = load_scene(kScene, options_with(changes));
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<MeasuredPose> poses;
  for (const auto& [left, right] : contractions) {
    scene.simulation->set_command("left", left);
    scene.simulation->set_command("right", right);
    EXPECT_TRUE(scene.simulation->solve_equilibrium().converged);
    MeasuredPose pose{{{"left", left}, {"right", right}}, {}};
    for (int m = 0; m < 2; ++m) {
      const Eigen::Vector3d noise(normal(random), normal(random), normal(random));
      pose.markers.push_back({scene.simulation->markers()[static_cast<std::size_t>(m)].name(),
                              measured_from_base * scene.simulation->marker_position(m) + noise_m * noise,
                              std::max(1e-5, noise_m) * std::max(1e-5, noise_m) * Eigen::Matrix3d::Identity()});
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

const std::vector<std::pair<double, double>> kWay = {{1.0, 1.0},  {0.95, 1.0}, {0.9, 1.0},   {0.95, 0.97},
                                                     {1.0, 0.95}, {1.0, 0.9},  {0.96, 0.93}, {0.93, 1.02}};

const FittedValue& value_of(const FitResult& result, const std::string& name) {
  for (const FittedValue& value : result.values)
    if (value.name == name) return value;
  throw std::out_of_range(name);
}

void expect_within(const FitResult& result, const std::string& name, double truth) {
  const FittedValue& value = value_of(result, name);
  EXPECT_NEAR(value.value, truth, 3.0 * value.deviation) << name << "\n" << summary(result);
  EXPECT_TRUE(value.told) << name;
}

bool warns(const FitResult& result, const std::string& of) {
  for (const std::string& warning : result.warnings)
    if (warning.find(of) != std::string::npos) return true;
  return false;
}

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
  const std::string file = (std::filesystem::temp_directory_path() / "soft_robot_lab_fitted.yaml").string();
  write_fitted_scene(result, kScene, file);
  const std::vector<MeasuredPose> unseen = measure(truth, {{0.92, 0.98}, {0.97, 0.9}}, shifted, 0.0, 2);
  EXPECT_LT(model_gap(file, options_with(""), unseen, result.measured_from_base).rms_m,
            0.1 * model_gap(kScene, options_with(given), unseen).rms_m);
  std::filesystem::remove(file);
}

// Tendons that command tension weigh the robot, so that stiffness and density can both be told.
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
  int in_vain = 0;
  request.progress = [&](int, double rms_gap_m) {
    in_vain = rms_gap_m == last_m ? in_vain + 1 : 0;
    last_m = rms_gap_m;
    return true;
  };
  const std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 2e-4, 2);
  EXPECT_TRUE(fit_model(kScene, options_with(scene), poses, request).converged);
  EXPECT_EQ(in_vain, 4);
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
  EXPECT_NE(result.changes.find("1177"), std::string::npos) << result.changes;
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
  EXPECT_TRUE(warns(result, "cannot tell compliance_m_n.left")) << summary(result);
  EXPECT_TRUE(warns(result, "damping"));
  EXPECT_FALSE(value_of(result, "compliance_m_n.left").told);
  EXPECT_TRUE(value_of(result, "youngs_modulus_pa").told);
  for (const FittedValue& value : result.values) EXPECT_TRUE(std::isfinite(value.deviation)) << value.name;
}

// Released from a pull, as cameras behind the drives would see it.
MeasuredSwing swing_of(const std::string& changes, double pulled, double noise_m, unsigned seed) {
  const Scene scene = load_scene(kScene, options_with(changes));
  Simulation& simulation = *scene.simulation;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise_m);
  MeasuredSwing swing{{{"left", pulled}}, {{10.0, {{"left", 1.1}, {"right", 1.1}}}}, {}};
  simulation.set_command("left", pulled);
  EXPECT_TRUE(simulation.solve_equilibrium().converged);
  simulation.set_command("left", 1.1);
  simulation.set_command("right", 1.1);
  constexpr double delay_s = 0.27;  // such as a message sent by rostopic has
  for (int step = 1; step <= 90; ++step) {
    simulation.step();
    if (step % 2 != 0) continue;
    MarkersAt at{10.0 + delay_s + step * simulation.options().time_step_s, {}};
    for (int m = 0; m < 2; ++m)
      at.markers.push_back(
          {simulation.markers()[static_cast<std::size_t>(m)].name(),
           simulation.marker_position(m) + Eigen::Vector3d(normal(random), normal(random), normal(random)),
           std::pow(std::max(1e-5, noise_m), 2) * Eigen::Matrix3d::Identity()});
    swing.seen.push_back(std::move(at));
  }
  return swing;
}

const std::string kFineSteps = "solver: {time_step_s: 0.008}\n";

TEST(FitModel, FindsTheDampingOfSwings) {
  const std::string damped = "body: {damping: {rayleigh_stiffness_s: 0.004}}\n";
  FitRequest request;
  request.parameters = {{"damping", {}, {}, {}}};
  const MeasuredSwing swing = swing_of(kFineSteps + damped, 0.85, 1e-4, 1);
  const FitResult result = fit_model(kScene, options_with(kFineSteps), {}, request, {swing});
  EXPECT_TRUE(result.converged) << result.message;
  expect_within(result, "damping.rayleigh_stiffness_s", 0.004);
  EXPECT_LT(value_of(result, "damping.rayleigh_stiffness_s").deviation, 0.06 * 0.004);
  EXPECT_EQ(result.swings, 1);
  EXPECT_LT(result.swing_rms_m, 2.5e-4) << summary(result);
  EXPECT_NE(result.changes.find("rayleigh_stiffness_s"), std::string::npos) << result.changes;
}

// Of a robot on a finer mesh with another stiffness, let go of more than once.
TEST(FitModel, FindsTheDampingBesideWhatRestTells) {
  const std::string truth = kFineSteps + kLying +
                            "body: {element_size_m: 0.015, material: {youngs_modulus_pa: 290620}, "
                            "damping: {rayleigh_stiffness_s: 0.004}}\n";
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}, {"damping", 0.01, {}, {}}};
  const std::vector<MeasuredPose> poses = measure(truth, kWay, Eigen::Isometry3d::Identity(), 5e-5, 1);
  const FitResult result = fit_model(kScene, options_with(kFineSteps + kLying), poses, request,
                                     {swing_of(truth, 0.9, 1e-4, 1), swing_of(truth, 0.85, 1e-4, 2)});
  EXPECT_TRUE(result.converged) << result.message;
  EXPECT_EQ(result.swings, 2);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 290620, 0.1 * 290620) << "of such meshes no better";
  // The integrator damps as 8 ms would, and that grows with the stiffness too.
  EXPECT_NEAR(value_of(result, "damping.rayleigh_stiffness_s").value, 0.004, 0.1 * 0.004) << summary(result);
  EXPECT_EQ(result.correlations.rows(), 2);

  const std::string file = (std::filesystem::temp_directory_path() / "soft_robot_lab_damped.yaml").string();
  write_fitted_scene(result, kScene, file);
  EXPECT_NEAR(load_scene(file, options_with("")).simulation->body().viscosity().rayleigh_stiffness_s,
              value_of(result, "damping.rayleigh_stiffness_s").value, 1e-12);
  std::filesystem::remove(file);
}

TEST(SwingModel, IsFreeOnceItsCablesAreSlackThoughDrivesGoOn) {
  const std::string slow = "compliance_m_n: 1.0e-5, pull_speed_m_s: 0.05";
  const std::string changes =
      kFineSteps + "cables: [" + cable("left", -0.007, slow) + ", " + cable("right", 0.007, slow) + "]\n";
  const MeasuredSwing swing{{{"left", 0.9}}, {{10.0, {{"left", 1.2}}}}, {}};
  const SimulatedSwing simulated =
      simulate_swings(*load_scene(kScene, options_with(changes)).simulation, {swing}, 0.5).front();
  EXPECT_GT(simulated.free_s(), 10.1);
  EXPECT_LT(simulated.free_s(), 10.4) << "the drive arrives at 10.6 s";
  const Eigen::Vector3d before = simulated.deflection_m(0, 10.0), after = simulated.deflection_m(0, simulated.free_s());
  EXPECT_GT(before.norm(), 0.01);
  EXPECT_LT(after.norm(), 0.5 * before.norm());
  constexpr double h = 1e-4;
  const double at_s = simulated.free_s() + 0.05;
  EXPECT_LT((simulated.velocity_m_s(0, at_s) -
             (simulated.deflection_m(0, at_s + h) - simulated.deflection_m(0, at_s - h)) / (2.0 * h))
                .norm(),
            1e-3 * simulated.velocity_m_s(0, at_s).norm());
}

// Held by taut cables nothing swings; what creeps does not either.
TEST(FitModel, TakesNoDampingFromWhatDoesNotSwing) {
  MeasuredSwing creep = swing_of(kFineSteps, 0.9, 1e-4, 1);
  for (MarkersAt& at : creep.seen)
    for (MeasuredMarker& marker : at.markers)
      marker.position_m = {2e-3 * std::exp(-(at.time_s - 10.0) / 3.0), 0.0, -0.1};
  MeasuredSwing held = creep;
  held.commands = {{10.0, {{"left", 0.9}, {"right", 0.9}}}};
  FitRequest request;
  request.parameters = {{"youngs_modulus_pa", {}, {}, {}}, {"damping", {}, {}, {}}};
  const std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 5e-5, 1);
  const FitResult result = fit_model(kScene, options_with(kLying), poses, request, {creep, held});
  EXPECT_TRUE(warns(result, "damping: the data cannot tell it")) << summary(result);
  EXPECT_EQ(result.values.size(), 1u);
  EXPECT_EQ(result.changes.find("damping"), std::string::npos) << result.changes;
}

TEST(FitModel, OutliersHardlyMoveIt) {
  std::vector<MeasuredPose> poses = measure(kLying, kWay, Eigen::Isometry3d::Identity(), 5e-5, 3);
  poses[2].markers[0].position_m.y() += 0.02;
  FitRequest request;
  request.model_error_m = 0.0;
  request.parameters = {{"youngs_modulus_pa", 200000.0, {}, {}}};
  const FitResult result = fit_model(kScene, options_with(kLying), poses, request);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 264200, 0.05 * 264200) << summary(result);
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
  has(refusal({{"compliance_m_n", {}, {}, {}}, {"compliance_m_n.left", {}, {}, {}}}, poses), "twice");
  has(refusal({{"camera_to_base", {}, {}, {}}}, poses), "cannot tell 6 parameters");
  has(refusal({{"youngs_modulus_pa", {}, {}, {}}}, {}), "nowhere at rest");
  has(refusal({{"damping", {}, {}, {}}}, poses), "none that data could tell");
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
