// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "mechanics/actuators/hollow_mesh.h"
#include "mechanics/actuators/test_bar.h"
#include "mechanics/box_mesh.h"
#include "mechanics/carved_mesh.h"
#include "mechanics/reduced/audit.h"
#include "mechanics/reduced/held_out.h"
#include "mechanics/reduced/reduced_sensitivities.h"
#include "mechanics/reduced/reduced_simulation.h"
#include "mechanics/reduced/train.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"

namespace soft_robot_lab {
namespace {

ReducedTraining small_training() {
  ReducedTraining training;
  training.box = {{0.85}, {1.0}};
  training.modes = 10;
  training.ramps = 4;
  training.transient_s = 1.5;
  return training;
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// The bar is 100 mm long, and one training serves all cases.
class ReducedBar : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    model_ = train(hanging_bar("pull_speed_m_s: 0.02").model(), small_training());
    held_out_ = std::make_unique<HeldOut>(model_->full, model_->box, 5, 1.5);
  }
  static void TearDownTestSuite() {
    model_.reset();
    held_out_.reset();
  }
  static std::shared_ptr<const ReducedModel> model_;
  static std::unique_ptr<const HeldOut> held_out_;
};
std::shared_ptr<const ReducedModel> ReducedBar::model_;
std::unique_ptr<const HeldOut> ReducedBar::held_out_;

TEST_F(ReducedBar, ItsModesAreOrthonormalInMassAndHoldWhatIsHeld) {
  const Eigen::MatrixXd& modes = model_->basis.modes;
  const Body& body = model_->full->body();
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(modes.cols(), modes.cols());
  for (Eigen::Index i = 0; i < body.mesh().node_count(); ++i) {
    const Eigen::MatrixXd rows = modes.middleRows<3>(3 * i);
    products += body.node_masses_kg()[i] * rows.transpose() * rows;
    if (body.fixed()(0, i)) {
      EXPECT_EQ(rows.norm(), 0.0);
    }
  }
  EXPECT_EQ(modes.cols(), 10);
  EXPECT_LT((products - Eigen::MatrixXd::Identity(modes.cols(), modes.cols())).norm(), 1e-12);
}

TEST_F(ReducedBar, EndsASolveWhereItIsAskedTo) {
  for (const auto& solve : {&ReducedSimulation::step, &ReducedSimulation::solve_equilibrium}) {
    ReducedSimulation simulation(model_);
    for (int i = 0; i < 3; ++i) simulation.step();
    simulation.set_command("cable", 0.88);
    const ReducedState before = simulation.state();
    int until = 2;
    simulation.set_interrupt([&] { return --until <= 0; });
    const ReducedReport report = (simulation.*solve)();
    EXPECT_EQ(report.interrupted, "interrupted");
    EXPECT_FALSE(report.converged);
    EXPECT_EQ(simulation.state().at.q, before.at.q);
    EXPECT_EQ(simulation.state().velocity, before.velocity);
    EXPECT_EQ(simulation.state().time_s, before.time_s);
    EXPECT_EQ(simulation.state().drives[0].command, 0.88);
    simulation.set_interrupt({});
    EXPECT_TRUE((simulation.*solve)().converged);
  }
}

TEST_F(ReducedBar, ItsEquilibriaAreTheFullModelsWithinATwentiethOfAMillimetre) {
  const ReducedError error = held_out_->equilibria(model_);
  EXPECT_EQ(error.unsolved, 0);
  EXPECT_LT(error.rms_m, 0.05e-3);
  EXPECT_LT(error.max_m, 0.2e-3);
  RecordProperty("rms_um", std::to_string(1e6 * error.rms_m));
  RecordProperty("max_um", std::to_string(1e6 * error.max_m));
}

TEST_F(ReducedBar, ItsTransientsAreTheFullModelsWithinATenthOfAMillimetre) {
  const ReducedError error = held_out_->transient(model_);
  EXPECT_EQ(error.unsolved, 0);
  EXPECT_LT(error.rms_m, 0.1e-3);
  EXPECT_LT(error.max_m, 0.5e-3);
  RecordProperty("rms_um", std::to_string(1e6 * error.rms_m));
  RecordProperty("max_um", std::to_string(1e6 * error.max_m));
}

TEST_F(ReducedBar, ItsModesHoldTransientsCloserThanItsMotionDoes) {
  const ReducedError shapes = held_out_->projection(*model_), motion = held_out_->transient(model_);
  EXPECT_EQ(shapes.unsolved, 0);
  EXPECT_GT(shapes.rms_m, 0.0);
  EXPECT_LT(shapes.rms_m, motion.rms_m);
  RecordProperty("rms_um", std::to_string(1e6 * shapes.rms_m));
  RecordProperty("max_um", std::to_string(1e6 * shapes.max_m));
}

TEST_F(ReducedBar, AuditsEstimateTheErrorOfItsMarkersWithinAFactorOfTwo) {
  Audit audit(*model_, model_->full);
  ReducedSimulation fast(model_);
  Simulation full(model_->full);
  int near = 0, better = 0;
  constexpr int count = 20;
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> commands = commands_in(model_->box, 7000 + i);
    command(commands, fast);
    command(commands, full);
    ASSERT_TRUE(fast.solve_equilibrium().converged);
    ASSERT_TRUE(full.solve_equilibrium().converged);
    const AuditResult found = audit.at_rest(fast.state());
    const Eigen::Vector3d true_m = full.marker_position(0);
    const double error_m = (model_->full->markers()[0].position(fast.positions_m()) - true_m).norm();
    near += found.found && found.estimate_m > 0.5 * error_m && found.estimate_m < 2.0 * error_m ? 1 : 0;
    better += (found.markers_m.col(0) - true_m).norm() < 0.3 * error_m ? 1 : 0;
  }
  EXPECT_GE(near, 19);
  EXPECT_GE(better, 19);
}

TEST_F(ReducedBar, ItNeedsFewOfTheQuadraturePoints) {
  EXPECT_GT(model_->energy.points().size(), 0u);
  EXPECT_LT(model_->energy.points().size(), 60u);
  RecordProperty("points", std::to_string(model_->energy.points().size()));
}

TEST_F(ReducedBar, AHeldCommandEndsWhereItsEquilibriumIs) {
  ReducedSimulation moved(model_), still(model_);
  moved.set_command("cable", 0.9);
  still.set_command("cable", 0.9);
  for (int i = 0; i < 600; ++i) ASSERT_TRUE(moved.step().converged);
  ASSERT_TRUE(still.solve_equilibrium().converged);
  EXPECT_NEAR(moved.state().time_s, 10.0, 1e-9);
  EXPECT_LT((moved.positions_m() - still.positions_m()).cwiseAbs().maxCoeff(), 2e-6);
}

TEST_F(ReducedBar, RepeatsItselfToTheLastBit) {
  const auto end = [] {
    ReducedSimulation simulation(model_);
    simulation.set_command("cable", 0.88);
    for (int i = 0; i < 20; ++i) simulation.step();
    return simulation.state().at.q;
  };
  EXPECT_EQ(end(), end());
}

// A cube with a hollow that is filled, and swings.
std::shared_ptr<const Model> swelling_cube(const Material& material, const std::string& air,
                                           const Viscosity& viscosity = {}) {
  Body body(hollow_cube(2.0), material);
  body.set_viscosity(viscosity);
  body.fix_nodes(Eigen::Vector3d::Constant(-1e3), {1e3, 1e3, -0.0298}, {true, true, true});
  body.set_gravity({0, 0, -9.81});
  auto chamber = std::make_unique<Chamber>();
  chamber->initialise(YamlNode::parse("{name: air, surface: cavity, " + air + "}", "test"), body,
                      MeshLocator(body.mesh()));
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::move(chamber));
  SolverOptions options;
  options.time_step_s = 0.01;
  return std::make_shared<const Model>(std::move(body), std::move(actuators), std::vector<Marker>{}, options);
}

void expect_swelling_as_the_full_model(const std::shared_ptr<const Model>& full, double most) {
  ReducedTraining training = small_training();
  training.box = {{full->actuators()[0]->limits().rest}, {most}};
  const auto model = train(full, training);
  const HeldOut held_out(full, model->box, 5, 1.5);
  const ReducedError rest = held_out.equilibria(model), motion = held_out.transient(model);
  EXPECT_EQ(rest.unsolved + motion.unsolved, 0);
  EXPECT_LT(rest.rms_m, 0.02e-3);
  EXPECT_LT(motion.rms_m, 0.02e-3);
  ReducedSimulation simulation(model);
  simulation.set_command("air", most);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  EXPECT_GT((simulation.positions_m() - full->body().mesh().nodes_m).colwise().norm().maxCoeff(), 0.5e-3);
  EXPECT_GT(-simulation.state().at.multipliers[0], 1000.0);  // its gauge pressure
}

TEST(ReducedChamber, SwellsAndRestsAsTheFullModel) {
  expect_swelling_as_the_full_model(swelling_cube({264200.0, 0.49, 1070.0}, "command: beta"), 1.5);
}

// Its pump takes its time, and drag its speed.
TEST(ReducedChamber, OfYeohSiliconeByARegulatorSwellsAsTheFullModel) {
  Viscosity drag;
  drag.rayleigh_mass_per_s = 15.0;
  const Material silicone = Material::yeoh(15000.0, 400.0, 0.0, 0.49, 1070.0);
  expect_swelling_as_the_full_model(swelling_cube(silicone, "command: gauge_pressure, flow_ml_s: 40", drag), 8000.0);
}

TEST(ReducedChamber, RefusesAnExplicitOne) {
  ReducedTraining training = small_training();
  training.box = {{1.0}, {1.5}};
  EXPECT_NE(refusal([&] { train(swelling_cube({}, "command: beta, model: explicit"), training); }).find("'air'"),
            std::string::npos);
}

// A cable that rubs: where its bar rests depends on the way.
class ReducedRub : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    model_ = train(hanging_bar("pull_speed_m_s: 0.02, model: friction, friction_coefficient: 0.3").model(),
                   small_training());
  }
  static void TearDownTestSuite() { model_.reset(); }
  static std::shared_ptr<const ReducedModel> model_;
};
std::shared_ptr<const ReducedModel> ReducedRub::model_;

TEST_F(ReducedRub, RestsAndSwingsAsTheFullModel) {
  const HeldOut held_out(model_->full, model_->box, 5, 1.5);
  const ReducedError rest = held_out.equilibria(model_), motion = held_out.transient(model_);
  EXPECT_EQ(rest.unsolved + motion.unsolved, 0);
  EXPECT_LT(rest.rms_m, 0.05e-3);
  EXPECT_LT(motion.rms_m, 0.1e-3);
  EXPECT_LT(rest.max_m, 0.2e-3);
}

// By the cable's friction a bar that is pulled and let out bends further than one that is pulled as far at once.
TEST_F(ReducedRub, RemembersItsWayAsTheFullModel) {
  Simulation full(model_->full);
  ReducedSimulation fast(model_);
  const auto tip_m = [&] { return model_->full->markers()[0].position(fast.positions_m()); };
  const auto rest_at = [&](double contraction) {
    command({contraction}, full);
    command({contraction}, fast);
    EXPECT_TRUE(full.solve_equilibrium().converged);
    EXPECT_TRUE(fast.solve_equilibrium().converged);
  };
  rest_at(0.94);
  const Eigen::Vector3d pulled_m = full.marker_position(0), fast_pulled_m = tip_m();
  rest_at(0.87);
  rest_at(0.94);
  const Eigen::Vector3d left_m = full.marker_position(0) - pulled_m, fast_left_m = tip_m() - fast_pulled_m;
  EXPECT_GT(left_m.norm(), 0.5e-3);
  EXPECT_LT((fast_left_m - left_m).norm(), 0.05 * left_m.norm());
  EXPECT_EQ(fast.state().drives[0].memory.size(), full.state().drives[0].memory.size());
}

TEST_F(ReducedRub, SensitivitiesHeedWhatSlips) {
  ReducedSimulation simulation(model_);
  simulation.set_command("cable", 0.9);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const ReducedSensitivities found = reduced_sensitivities(*model_, simulation.state());
  ASSERT_TRUE(found.stable);
  const ReducedState before = simulation.state();
  simulation.set_command("cable", 0.9 - 1e-5);  // further, so that what slips goes on
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const Eigen::VectorXd slope = (simulation.state().at.q - before.at.q) / -1e-5;
  EXPECT_LT((found.q.col(0) - slope).norm(), 1e-3 * slope.norm());
}

// A column of 100 mm with a cable on either side: both pulled, it buckles to the front or to the back. Gravity leans
// it.
Simulation column() {
  Body body(box_mesh({-0.01, 0, -0.006}, {0.01, 0.1, 0.006}, {2, 6, 2}), Material{264200.0, 0.49, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1, 1e-6, 1}, {true, true, true});
  body.set_gravity({0, -9.81, 1.0});
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  for (const char* cable : {"{name: left, points_m: [[-0.006, 0, 0], [-0.006, 0.095, 0]]",
                            "{name: right, points_m: [[0.006, 0, 0], [0.006, 0.095, 0]]"}) {
    actuators.push_back(std::make_unique<Cable>());
    actuators.back()->initialise(
        YamlNode::parse(std::string(cable) + ", sheath_radius_m: 0.002, plug_radius_m: 0.003}", "column"), body,
        locator);
  }
  return Simulation(std::move(body), std::move(actuators), {}, SolverOptions{});
}

class ReducedColumn : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    ReducedTraining training;
    training.box = {{0.95, 0.95}, {1.0, 1.0}};
    training.modes = 20;
    training.ramps = 8;
    training.transient_s = 2.0;
    model_ = train(column().model(), training);
  }
  static void TearDownTestSuite() { model_.reset(); }

  static ReducedSimulation pulled(const std::shared_ptr<const ReducedModel>& model = model_) {
    ReducedSimulation simulation(model);
    simulation.set_command("left", 0.955);
    simulation.set_command("right", 0.955);
    return simulation;
  }
  static std::shared_ptr<const ReducedModel> model_;
};
std::shared_ptr<const ReducedModel> ReducedColumn::model_;

TEST_F(ReducedColumn, ComesFromRestToTheSideThatTheFullModelTakes) {
  Simulation full(model_->full);
  ReducedSimulation fast(model_);
  for (const double left : {0.952, 0.96, 0.97}) {
    for (const double right : {0.955, 0.965}) {
      full.reset();
      fast.reset();
      command({left, right}, full);
      command({left, right}, fast);
      ASSERT_TRUE(full.solve_equilibrium().converged);
      const ReducedReport report = fast.solve_equilibrium();
      ASSERT_TRUE(report.converged);
      EXPECT_LE(report.steps, 4);  // it starts beside a rest state that training found, and does not search
      EXPECT_LT((fast.positions_m() - full.state().positions_m).colwise().norm().maxCoeff(), 1e-3) << left << right;
    }
  }
}

TEST_F(ReducedColumn, LeavesItsSideToTheFullModelWhereNoKnownRestStateIsNear) {
  auto straight = std::make_shared<ReducedModel>(*model_);
  straight->rests = {Eigen::MatrixXd::Ones(2, 1), Eigen::MatrixXd::Zero(model_->energy.modes(), 1),
                     Eigen::MatrixXd::Zero(model_->energy.pressures(), 1),
                     Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(model_->constraints.count()), 1)};
  ReducedSimulation simulation = pulled(straight);
  EXPECT_FALSE(simulation.solve_equilibrium().converged);  // a search would take one by chance
}

TEST_F(ReducedColumn, FindsNothingNearbyWhereItBucklesAndStaysAsItWas) {
  ReducedSimulation simulation(model_);
  ASSERT_TRUE(simulation.solve_nearby().converged);
  const ReducedUnknowns before = simulation.state().at;
  command({0.955, 0.955}, simulation);
  EXPECT_FALSE(simulation.solve_nearby().converged);
  EXPECT_EQ(simulation.state().at.q, before.q);
  EXPECT_EQ(simulation.state().at.multipliers, before.multipliers);
  command({0.998, 0.999}, simulation);
  EXPECT_TRUE(simulation.solve_nearby().converged);
  EXPECT_NE(simulation.state().at.q, before.q);
}

// Without the rest states of its training.
TEST_F(ReducedColumn, LeavesTheSaddleForAMinimumOnOneSide) {
  auto bare = std::make_shared<ReducedModel>(*model_);
  bare->rests = {};
  ReducedSimulation simulation = pulled(bare);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const Eigen::Matrix3Xd moved = simulation.positions_m() - model_->full->body().mesh().nodes_m;
  EXPECT_GT(moved.row(2).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_TRUE(ReducedNewton(*model_).stable(simulation.state().drives, simulation.state().at));
}

TEST_F(ReducedColumn, KnowsASaddleFromTheMinimumOnEitherSide) {
  ReducedSimulation simulation = pulled();
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const DriveStates& drives = simulation.state().drives;
  EXPECT_TRUE(ReducedNewton(*model_).stable(drives, simulation.state().at));
  // From the straight shape Newton's method goes to the equilibrium nearby, which is the saddle.
  ReducedUnknowns straight = ReducedSimulation(model_).state().at;
  ReducedNewton newton(*model_);
  ASSERT_TRUE(newton.solve({0.0, straight.q, 1e-9}, drives, straight).converged);
  EXPECT_GT((model_->positions_m(straight.q) - simulation.positions_m()).cwiseAbs().maxCoeff(), 0.005);
  EXPECT_FALSE(ReducedNewton(*model_).stable(drives, straight));
  EXPECT_TRUE(ReducedNewton(*model_).stable(drives, straight, 1e6));  // the inertia of a short step holds it
}

TEST_F(ReducedColumn, NewtonsMethodCutsStepsThatLeadTooFarAndEndsWhereItDoesFromNearby) {
  ReducedSimulation buckled = pulled();
  ASSERT_TRUE(buckled.solve_equilibrium().converged);
  const ReducedState rest = ReducedSimulation(model_).state();
  const auto solved = [&](double share, ReducedUnknowns& at) {
    at = rest.at;
    at.q = share * buckled.state().at.q;
    return ReducedNewton(*model_).solve({1e5, buckled.state().at.q, 1e-9}, rest.drives, at);
  };
  ReducedUnknowns near, far;
  const ReducedEnd from_near = solved(1.0, near), from_far = solved(2.0, far);
  ASSERT_TRUE(from_near.converged);
  ASSERT_TRUE(from_far.converged);
  EXPECT_EQ(from_near.shortened, 0);
  EXPECT_GT(from_far.shortened, 0);
  EXPECT_LT((near.q - far.q).norm(), 1e-8);  // of unit kg^0.5 m, some 1e-7 m
}

TEST_F(ReducedColumn, ATimeStepWithoutASolutionIsHalvedAndAtLastUndone) {
  ReducedSimulation simulation = pulled();
  const ReducedState before = simulation.state();
  simulation.set_tolerance_m(1e-30, 1e-9);  // beyond rounding
  const ReducedReport report = simulation.step();
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.steps, 7);  // the whole and its halves down to a 64th
  EXPECT_EQ(simulation.state().at.q, before.at.q);
  EXPECT_EQ(simulation.state().time_s, before.time_s);
  EXPECT_EQ(simulation.state().drives[0].actuated_command, before.drives[0].actuated_command);
}

// Two legs of 6 mm, 6 mm apart, the lower one shorter. A cable across pulls them together until its end meets the
// other leg.
Simulation clip(double friction = 0.0) {
  Body body(carved({0, -0.009, 0}, {0.06, 0.009, 0.01}, {15, 6, 1},
                   [](const Eigen::Vector3d& at) {
                     return at.x() < 0.008 || at.y() > 0.003 || (at.y() < -0.003 && at.x() < 0.048);
                   }),
            Material{264200.0, 0.49, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_gravity({0, -9.81, 0});
  body.let_touch_itself(friction);
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators.back()->initialise(YamlNode::parse("{name: cable, points_m: [[0.04, 0.007, 0.005], [0.04, -0.007, 0.005]], "
                                               "sheath_radius_m: 0.001, plug_radius_m: 0.002, pull_speed_m_s: 0.02}",
                                               "clip"),
                               body, locator);
  std::vector<Marker> markers;
  markers.emplace_back("upper", Eigen::Vector3d(0.06, 0.009, 0.005), body.mesh(), locator);
  markers.emplace_back("lower", Eigen::Vector3d(0.048, -0.009, 0.005), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), SolverOptions{});
}

class ReducedClip : public ::testing::Test {
 protected:
  static ReducedTraining training() {
    ReducedTraining training;
    training.box = {{0.5}, {1.0}};
    training.modes = 20;
    training.ramps = 8;
    training.transient_s = 2.0;
    return training;
  }
  static void SetUpTestSuite() { model_ = train(clip().model(), training()); }
  static void TearDownTestSuite() { model_.reset(); }
  // At rest, from `near`, or from the rest shape.
  static ReducedState pulled_to(double command, const ReducedState* near = nullptr) {
    ReducedSimulation simulation(model_);
    simulation.set_tolerance_m(3e-6, 1e-11);
    if (near) simulation.set_state(*near);
    simulation.set_command("cable", command);
    EXPECT_TRUE(simulation.solve_equilibrium().converged) << command;
    return simulation.state();
  }
  static std::shared_ptr<const ReducedModel> model_;
};
std::shared_ptr<const ReducedModel> ReducedClip::model_;

TEST_F(ReducedClip, ItsLegsMeetAsThoseOfTheFullModel) {
  const HeldOut held_out(model_->full, model_->box, 5, 1.5);
  for (const ReducedError& error : {held_out.equilibria(model_), held_out.transient(model_)}) {
    EXPECT_EQ(error.unsolved, 0);
    EXPECT_LT(error.rms_m, 0.1e-3);
    EXPECT_LT(error.max_m, 0.5e-3);
    RecordProperty("rms_um", std::to_string(1e6 * error.rms_m));
  }
}

// Where an edge is about to slip off a face an audit may find nothing.
TEST_F(ReducedClip, ItsLegsPressAsHardAsThoseOfTheFullModelAndGoOnFromThere) {
  int audited = 0;
  for (const double pull : {0.6, 0.65, 0.7}) {
    Simulation full(model_->full), after(model_->full);
    const ReducedState rest = pulled_to(pull);
    full.set_command("cable", pull);
    ASSERT_TRUE(full.solve_equilibrium().converged);
    after.set_state(full_state(*model_, rest, after.state()));
    const double force_n = full.contacts().back().normal_force_n;
    EXPECT_GT(force_n, 0.0);
    EXPECT_NEAR(after.contacts().back().normal_force_n, force_n, 0.1 * force_n) << pull;
    const AuditResult audit = Audit(*model_, model_->full).at_rest(rest);
    if (!audit.found) continue;
    ++audited;
    EXPECT_LT((audit.markers_m.col(0) - full.marker_position(0)).norm(), 1e-6);
  }
  EXPECT_GE(audited, 1);
}

// As an audit may be by a model with obstacles, or by one that does not touch itself.
TEST_F(ReducedClip, ItsPressuresComeAfterThoseOfObstacles) {
  const ReducedState rest = pulled_to(0.65);
  const Eigen::VectorXd own = full_state(*model_, rest, Simulation(model_->full).state()).contact.pressures_pa;
  ASSERT_GT(own.maxCoeff(), 0.0);
  Eigen::VectorXd after_others = Eigen::VectorXd::Zero(own.size() + 7), others = Eigen::VectorXd::Zero(7);
  model_->skin.add_pressures(rest.at.pushes_n, after_others);
  model_->skin.add_pressures(rest.at.pushes_n, others);
  EXPECT_EQ(after_others.tail(own.size()), own);
  EXPECT_TRUE(after_others.head(7).isZero(0.0));
  EXPECT_TRUE(others.isZero(0.0));
}

TEST_F(ReducedClip, SensitivitiesHeedHowTheSkinTurnsItsPush) {
  const ReducedState rest = pulled_to(0.6);
  ASSERT_GT(rest.at.pushes_n.maxCoeff(), 0.0);
  const ReducedSensitivities found = reduced_sensitivities(*model_, rest);
  ASSERT_TRUE(found.stable);
  constexpr double kStep = 1e-5;
  const Eigen::VectorXd difference =
      (pulled_to(0.6 + kStep, &rest).at.q - pulled_to(0.6 - kStep, &rest).at.q) / (2.0 * kStep);
  EXPECT_LT((found.q.col(0) - difference).norm(), 2e-3 * difference.norm());
}

TEST_F(ReducedBar, RefusesCommandsOutsideWhatItWasTrainedFor) {
  ReducedSimulation simulation(model_);
  for (const double command : {0.84, 1.01, std::nan("")}) {
    const std::string words = refusal([&] { simulation.set_command("cable", command); });
    EXPECT_NE(words.find("cable"), std::string::npos);
    EXPECT_NE(words.find("[0.85, 1]"), std::string::npos) << words;
  }
  EXPECT_EQ(simulation.state().drives[0].command, 1.0);
}

TEST(ReducedTrainingInput, RefusesSkinThatRubs) {
  const Simulation rough = clip(0.3);
  EXPECT_NE(refusal([&] { train(rough.model(), small_training()); }).find("friction of skin on skin"),
            std::string::npos);
}

TEST(ReducedTrainingInput, RefusesWhatItDoesNotKnow) {
  const auto refused = [](const std::string& cable, const ReducedTraining& training) {
    const Simulation bar = hanging_bar(cable);
    return refusal([&] { train(bar.model(), training); });
  };
  EXPECT_NE(refused("model: springs, stiffness_n_m: 3000, integration: explicit", small_training()).find("'cable'"),
            std::string::npos);
  ReducedTraining training = small_training();
  training.box = {{0.85}, {0.95}};
  EXPECT_NE(refused("compliance_m_n: 0", training).find("rest command 1"), std::string::npos);
  training.box = {{0.85, 0.9}, {1.0}};
  EXPECT_NE(refused("compliance_m_n: 0", training).find("each of 1"), std::string::npos);
  training = small_training();
  training.modes = 41;
  EXPECT_NE(refused("compliance_m_n: 0", training).find("modes: 41"), std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
