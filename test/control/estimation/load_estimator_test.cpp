// SPDX-License-Identifier: BSD-3-Clause
#include "control/estimation/load_estimator.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "control/estimation/push_cone.h"
#include "control/estimation/push_places.h"
#include "settings/overrides_from.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kNoise_m = 3.0e-5;
constexpr double kGravity_m_s2 = 9.81;

std::unique_ptr<Simulation> bar(const std::string& overrides = "") {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from(overrides);
  return load_scene(std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/scenes/pushed_bar.yaml", options).simulation;
}

const std::string kFiner = "body: {element_size_m: 0.01}";

void rest(Simulation& simulation, double left, double right) {
  simulation.set_command("left", left);
  simulation.set_command("right", right);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
}

std::string words(const LoadEstimate& found) {
  std::ostringstream text;
  text << name_of(found.kind) << ", chi^2 " << found.chi2_unloaded << " to " << found.chi2 << found.message;
  for (const auto& [kind, log_evidence] : found.log_evidence) text << ", " << name_of(kind) << " " << log_evidence;
  for (const EstimatedLoad& load : found.loads)
    text << "; " << 1e3 * load.force_n.transpose() << " mN at " << 1e3 * load.position_m.transpose() << " mm "
         << load.marker;
  return text.str();
}

// A robot that is measured, and a model of it. Offsets of the first look are taken.
class Twin {
 public:
  explicit Twin(const std::string& robot, double left = 0.98, double right = 1.0)
      : robot_(bar(robot)), model_(bar()), estimator_(*model_, {}) {
    go(left, right);
  }

  void go(double left, double right) {
    rest(*robot_, left, right);
    rest(*model_, left, right);
    estimator_.take_offsets(look());
  }

  std::vector<MeasuredMarker> look() {
    std::normal_distribution<double> noise(0.0, kNoise_m);
    std::vector<MeasuredMarker> seen;
    for (std::size_t i = 0; i < robot_->markers().size(); ++i)
      seen.push_back({robot_->markers()[i].name(),
                      robot_->marker_position(static_cast<int>(i)) +
                          Eigen::Vector3d::NullaryExpr([&](int) { return noise(random_); }),
                      kNoise_m * kNoise_m * Eigen::Matrix3d::Identity()});
    return seen;
  }

  // A place of the robot's skin near a point at rest.
  PointLoad load(const Eigen::Vector3d& rest_m, const Eigen::Vector3d& force_n) const {
    return {MeshLocator(robot_->body().mesh()).embed(rest_m), force_n};
  }

  LoadEstimate under(const std::vector<PointLoad>& loads) {
    robot_->pull(loads);
    EXPECT_TRUE(robot_->solve_equilibrium().converged);
    return estimator_.estimate(look());
  }

  Simulation& robot() { return *robot_; }
  Simulation& model() { return *model_; }
  LoadEstimator& estimator() { return estimator_; }

 private:
  std::unique_ptr<Simulation> robot_, model_;
  LoadEstimator estimator_;
  std::mt19937 random_{7};
};

TEST(Marker, AForceDoesTheWorkOfItsVelocity) {
  const auto simulation = bar();
  rest(*simulation, 0.98, 1.0);
  const Eigen::Matrix3Xd& positions_m = simulation->state().positions_m;
  const Eigen::Matrix3Xd motion_m = 1e-3 * Eigen::Matrix3Xd::Random(3, positions_m.cols());
  const Eigen::Vector3d force_n(0.3, -0.2, 0.5);
  for (const Marker& marker : simulation->markers()) {
    Eigen::Matrix3Xd forces_n = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
    marker.add_force(positions_m, force_n, forces_n);
    EXPECT_NEAR(forces_n.cwiseProduct(motion_m).sum(), force_n.dot(marker.velocity(positions_m, motion_m)), 1e-12)
        << marker.name();
  }
}

TEST(MarkerCompliances, SayHowAForceMovesMarkers) {
  const auto simulation = bar();
  rest(*simulation, 0.98, 1.0);
  const EmbeddedPoint at = MeshLocator(simulation->body().mesh()).embed({0.0, -0.008, -0.07});
  const Eigen::MatrixXd compliances_m_n = simulation->marker_compliances();
  Eigen::MatrixXd of_place = Eigen::MatrixXd::Zero(3, compliances_m_n.cols());
  for (std::size_t k = 0; k < at.nodes.size(); ++k)
    of_place += at.weights[k] * compliances_m_n.middleRows<3>(3 * at.nodes[k]);
  const Eigen::Vector3d force_n(2e-5, 5e-5, -3e-5);
  std::vector<Eigen::Vector3d> before_m;
  const auto rest_under = [&](double sign) {
    simulation->pull({{at, sign * force_n}});
    EquilibriumOptions tight;
    EXPECT_TRUE(simulation->solve_equilibrium(tight).converged);
  };
  rest_under(-1.0);
  for (std::size_t i = 0; i < simulation->markers().size(); ++i)
    before_m.push_back(simulation->marker_position(static_cast<int>(i)));
  rest_under(1.0);
  for (std::size_t i = 0; i < before_m.size(); ++i) {
    const Eigen::Vector3d moved_m = simulation->marker_position(static_cast<int>(i)) - before_m[i],
                          expected_m =
                              2.0 * of_place.middleCols<3>(3 * static_cast<Eigen::Index>(i)).transpose() * force_n;
    EXPECT_LT((moved_m - expected_m).norm(), 2e-3 * expected_m.norm()) << i;
  }
}

TEST(PushPlaces, StandForTheWholeSkinThatIsFree) {
  const auto simulation = bar();
  double area_m2 = 0.0;
  for (const PushPlace& place : push_places(simulation->body(), 0.004)) {
    area_m2 += place.area_m2;
    const Eigen::Vector3d at_m = place.at.at(simulation->body().mesh().nodes_m);
    EXPECT_LT(at_m.z(), -1e-4) << "the clamped face cannot be pushed";
    const Eigen::Vector3d normal = normal_at(simulation->body().mesh(), simulation->body().mesh().nodes_m, place);
    EXPECT_GT(normal.dot(at_m - Eigen::Vector3d(0, 0, -0.05)), 0.0) << at_m.transpose();
  }
  EXPECT_NEAR(area_m2, 2 * (0.02 + 0.016) * 0.1 + 0.02 * 0.016, 1e-9);
}

TEST(PushCone, FindsTheLeastOverAllDirections) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto vector = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&](int, int) { return normal(random); });
    const ForceQuadratic quadratic{root * root.transpose() + 0.1 * Eigen::Matrix3d::Identity(), vector()};
    const Eigen::Vector3d outward = vector().normalized();
    const double mu = 0.5;
    const Eigen::Vector3d found = best_push(quadratic, outward, mu);
    EXPECT_LE((found + (-found.dot(outward)) * outward).norm(), mu * (-found.dot(outward)) + 1e-9);
    double most = 0.0;
    for (int k = 0; k < 20000; ++k) {
      const Eigen::Vector3d across = vector() - outward * 0.0;
      const Eigen::Vector3d lateral = (across - across.dot(outward) * outward).normalized();
      const double lean = mu * std::sqrt(std::uniform_real_distribution<double>(0, 1)(random));
      most = std::max(most, quadratic.gain(best_along(quadratic, (-outward + lean * lateral).normalized())));
    }
    EXPECT_GE(quadratic.gain(found), most - 0.01 * (most + 1e-3)) << i;
  }
}

TEST(LoadEstimator, SaysNothingOfAnUntouchedRobot) {
  Twin twin(kFiner);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(twin.estimator().estimate(twin.look()).kind, LoadKind::none);
}

TEST(LoadEstimator, FindsPushesOnARobotOfAnotherMesh) {
  Twin twin(kFiner);
  struct Push {
    Eigen::Vector3d rest_m, force_n;
  };
  for (const Push& push : {Push{{0.0, -0.008, -0.075}, {0.0, 0.05, 0.0}}, Push{{-0.01, 0.0, -0.09}, {0.12, 0.0, 0.01}},
                           Push{{0.0, 0.008, -0.055}, {0.01, -0.09, 0.0}}}) {
    const PointLoad load = twin.load(push.rest_m, push.force_n);
    const LoadEstimate found = twin.under({load});
    ASSERT_EQ(found.kind, LoadKind::push) << words(found);
    const Eigen::Vector3d at_m = load.at.at(twin.robot().state().positions_m);
    const double deviation_m = std::sqrt(found.loads[0].position_covariance_m2.trace());
    EXPECT_TRUE(found.loads[0].observable);
    EXPECT_LT((found.loads[0].position_m - at_m).norm(), 0.006) << "deviation " << deviation_m;
    EXPECT_LT((found.loads[0].position_m - at_m).norm(), 3.0 * deviation_m + 0.002);
    EXPECT_LT((found.loads[0].force_n - push.force_n).norm(), 0.12 * push.force_n.norm() + 0.005);
    for (std::size_t i = 0; i < twin.robot().markers().size(); ++i)
      EXPECT_LT(
          (found.markers_m.at(twin.robot().markers()[i].name()) - twin.robot().marker_position(static_cast<int>(i)))
              .norm(),
          4.0 * kNoise_m + 0.02 * (at_m - push.rest_m).norm());
  }
}

TEST(LoadEstimator, ForeseesAMarkerThatNoCameraSees) {
  Twin twin(kFiner);
  twin.robot().pull({twin.load({0.0, -0.008, -0.075}, {0.0, 0.05, 0.0})});
  ASSERT_TRUE(twin.robot().solve_equilibrium().converged);
  std::vector<MeasuredMarker> seen = twin.look();
  seen.erase(seen.begin());
  const LoadEstimate found = twin.estimator().estimate(seen);
  EXPECT_EQ(found.coordinates, 12);
  EXPECT_LT((found.markers_m.at("tip") - twin.robot().marker_position(0)).norm(), 5e-4);
}

TEST(LoadEstimator, WeighsWhatHangsAtAMarker) {
  Twin twin(kFiner);
  for (const double mass_kg : {0.01, 0.04}) {
    const LoadEstimate found = twin.under({twin.load({-0.01, 0.0, -0.06}, {0.0, 0.0, -kGravity_m_s2 * mass_kg})});
    ASSERT_EQ(found.kind, LoadKind::weight) << words(found);
    EXPECT_EQ(found.loads[0].marker, "middle_left");
    EXPECT_NEAR(found.loads[0].force_n.norm() / kGravity_m_s2, mass_kg, 0.05 * mass_kg + 0.0003);
  }
}

TEST(LoadEstimator, TellsTwoPushesFromOne) {
  Twin twin(kFiner);
  const LoadEstimate found = twin.under(
      {twin.load({0.0, -0.008, -0.04}, {0.0, 0.15, 0.0}), twin.load({0.0, 0.008, -0.095}, {0.0, -0.05, 0.0})});
  ASSERT_EQ(found.kind, LoadKind::two_pushes) << words(found);
  EXPECT_GT(found.probability, 0.99);
  EXPECT_LT(found.chi2, 40.0) << words(found);
}

TEST(LoadEstimator, TellsWhatIsNoLoad) {
  {
    Twin twin(kFiner);
    rest(twin.robot(), 0.96, 1.0);
    const LoadEstimate found = twin.estimator().estimate(twin.look());
    ASSERT_EQ(found.kind, LoadKind::command) << words(found);
    EXPECT_EQ(found.actuator, "left");
    EXPECT_NEAR(found.change, -0.02, 0.003);
  }
  {
    Twin twin(kFiner);
    std::vector<MeasuredMarker> seen = twin.look();
    for (MeasuredMarker& marker : seen) marker.position_m += Eigen::Vector3d(0.003, -0.004, 0.0);
    EXPECT_EQ(twin.estimator().estimate(seen).kind, LoadKind::frame);
  }
  {
    Twin twin(kFiner);
    std::vector<MeasuredMarker> seen = twin.look();
    std::swap(seen[0].position_m, seen[3].position_m);
    const LoadEstimate found = twin.estimator().estimate(seen);
    EXPECT_EQ(found.kind, LoadKind::unknown);
    EXPECT_FALSE(found.message.empty());
    EXPECT_TRUE(found.loads.empty());
  }
}

TEST(LoadEstimator, LeavesTheModelAsItWas) {
  Twin twin(kFiner);
  const SimulationState before = twin.model().state();
  twin.under({twin.load({0.0, -0.008, -0.075}, {0.0, 0.05, 0.0})});
  EXPECT_TRUE(twin.model().state().positions_m == before.positions_m);
  EXPECT_FALSE(twin.estimator().estimated_state().positions_m == before.positions_m);
  ASSERT_TRUE(twin.model().solve_equilibrium().converged);
  EXPECT_LT((twin.model().state().positions_m - before.positions_m).cwiseAbs().maxCoeff(), 1e-6) << "no load stays";
}

TEST(LoadEstimator, RefusesWhatCannotBe) {
  Twin twin(kFiner);
  const auto refused = [&](const std::function<void(std::vector<MeasuredMarker>&)>& spoil) {
    std::vector<MeasuredMarker> seen = twin.look();
    spoil(seen);
    EXPECT_THROW(twin.estimator().estimate(seen), std::invalid_argument);
    EXPECT_THROW(twin.estimator().take_offsets(seen), std::invalid_argument);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([&](auto& seen) { seen[0].position_m.x() = nan; });
  refused([&](auto& seen) { seen[1].covariance_m2(0, 0) = nan; });
  refused([](auto& seen) { seen[1].covariance_m2 *= -1.0; });
  refused([](auto& seen) { seen[2].name = "nobody"; });
  refused([](auto& seen) { seen[2].name = seen[1].name; });
  EXPECT_EQ(twin.estimator().estimate({}).kind, LoadKind::unknown);
  EXPECT_EQ(twin.estimator().estimate(twin.look()).kind, LoadKind::none) << "nothing is lost";
  LoadEstimationOptions wrong;
  wrong.place_spacing_m = 0.0;
  EXPECT_THROW(LoadEstimator(twin.model(), wrong), std::invalid_argument);
  wrong = {};
  wrong.most_force_n = 0.5 * wrong.least_force_n;
  EXPECT_THROW(LoadEstimator(twin.model(), wrong), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
