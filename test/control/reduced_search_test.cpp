// SPDX-License-Identifier: BSD-3-Clause
// Policies that are searched for on a reduced model of a bar with two cables.
#include "control/reduced_search.h"

#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "cabled_bar.h"
#include "mechanics/reduced/reduced_sensitivities.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

// One training serves all cases.
class SearchOnAReducedBar : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ReducedRequest request;
    request.box = {{0.9, 0.985}, {1.0, 1.0}};  // so that it does not buckle
    request.tolerance_m = 3e-4;
    reduced_ = std::make_unique<ReducedChoice>(choose_modes(bar({}, 264200.0, {0, -9.81, 0}).model(), request, {}));
  }
  static void TearDownTestSuite() { reduced_.reset(); }

  static Eigen::Vector3d tip_at(double left, double right) {
    Simulation simulation(reduced_->model->full);
    return ForwardModel(simulation, {"tip"}, {"left", "right"}).predict(Eigen::Vector2d(left, right), false).markers_m;
  }
  static PolicyTask reach(const Eigen::Vector3d& target_m) { return {{{{{"tip", target_m, 1.0}}, 2.0, {}}}, {}, 0.0}; }

  static std::unique_ptr<const ReducedChoice> reduced_;
};
std::unique_ptr<const ReducedChoice> SearchOnAReducedBar::reduced_;

// Narrowed commands begin the training anew, three times here.
TEST(ReducedTraining, NeverShowsLessThanBefore) {
  ReducedRequest request;
  request.box = {{0.95, 0.985}, {1.0, 1.0}};
  request.modes = 2;
  request.tolerance_m = 1e-9;
  request.may_narrow = true;
  double before = 0.0;
  int begun = 0;
  const auto show = [&](double share, const std::string& what) {
    EXPECT_GE(share, before) << what;
    EXPECT_LE(share, 1.0);
    before = share;
    begun += what == "reduced model of 2 modes";
  };
  EXPECT_THROW(choose_modes(bar({}, 264200.0, {0, -9.81, 0}).model(), request, show), std::invalid_argument);
  EXPECT_EQ(begun, 4);
}

TEST_F(SearchOnAReducedBar, DerivativesAreDifferencesOfItsPredictions) {
  ReducedForwardModel model(reduced_->model, {"tip", "middle"}, {"left", "right"});
  const Eigen::Vector2d at(0.95, 0.99);
  const Prediction here = model.predict(at, true);
  ASSERT_EQ(here.marker_jacobian.rows(), 6);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = 1e-5 * Eigen::Vector2d::Unit(i);
    const Prediction more = model.predict(at + step, false), less = model.predict(at - step, false);
    const Eigen::Matrix3Xd slope = (more.markers_m - less.markers_m) / 2e-5;
    const Eigen::VectorXd expected = Eigen::Map<const Eigen::VectorXd>(slope.data(), 6);
    EXPECT_LT((here.marker_jacobian.col(i) - expected).norm(), 1e-3 * expected.norm());
    const Eigen::VectorXd tension = (more.tensions_n - less.tensions_n) / 2e-5;
    EXPECT_LT((here.tension_jacobian.col(i) - tension).norm(), 1e-3 * tension.norm());
  }
}

TEST_F(SearchOnAReducedBar, DerivativesAreThoseOfTheFullModelWithinFivePercent) {
  Simulation simulation(reduced_->model->full);
  ForwardModel full(simulation, {"tip"}, {"left", "right"});
  ReducedForwardModel fast(reduced_->model, {"tip"}, {"left", "right"});
  const Eigen::Vector2d at(0.93, 1.0);
  const Prediction a = full.predict(at, true), b = fast.predict(at, true);
  EXPECT_LT((a.marker_jacobian - b.marker_jacobian).norm(), 0.05 * a.marker_jacobian.norm());
  EXPECT_NEAR(a.tensions_n[0], b.tensions_n[0], 0.02 * a.tensions_n[0]);
  EXPECT_NEAR(a.slack[1], b.slack[1], 1e-3);
}

TEST_F(SearchOnAReducedBar, EndsWhereTheFullModelDoesAndLeavesTheSimulationAtRestThere) {
  for (const Eigen::Vector3d& target_m : {tip_at(0.92, 1.0), tip_at(0.97, 0.99), Eigen::Vector3d(0.09, -0.03, 0.01)}) {
    Simulation by_newton(reduced_->model->full), by_reduced(reduced_->model->full);
    PolicyTask task = reach(target_m);
    task.bounds = {{"left", 0.9, 1.0}, {"right", 0.985, 1.0}};
    const PolicyAnswer full = find_policy(by_newton, task, {}),
                       fast = find_policy(by_reduced, task, {}, {}, reduced_.get());
    ASSERT_TRUE(full.success);
    ASSERT_TRUE(fast.success);
    EXPECT_TRUE(full.full_because.empty());
    EXPECT_EQ(fast.full_because, std::vector<std::string>{""});
    EXPECT_LT((fast.summaries[0].markers_m - full.summaries[0].markers_m).norm(), 1e-4) << target_m.transpose();
    EXPECT_NEAR(fast.summaries[0].final_distance_m, (fast.summaries[0].markers_m.col(0) - target_m).norm(), 1e-12);
    const Eigen::Vector3d tip_m = by_reduced.marker_position(by_reduced.marker_index("tip"));
    EXPECT_EQ(tip_m, Eigen::Vector3d(fast.summaries[0].markers_m.col(0)));
    EXPECT_LT((tip_m - tip_at(fast.policy.steps[0].values[0], fast.policy.steps[0].values[1])).norm(), 1e-6);
  }
}

TEST_F(SearchOnAReducedBar, EndsThereByARoughModelToo) {
  ReducedRequest request;
  request.box = reduced_->model->box;
  request.tolerance_m = 0.01;
  request.modes = 6;
  const ReducedChoice rough = choose_modes(reduced_->model->full, request, {});
  EXPECT_GT(rough.equilibria.rms_m, 1e-4);
  for (const Eigen::Vector3d& target_m : {tip_at(0.92, 1.0), Eigen::Vector3d(0.09, -0.03, 0.01)}) {
    Simulation by_newton(rough.model->full), by_reduced(rough.model->full);
    PolicyTask task = reach(target_m);
    task.bounds = {{"left", 0.9, 1.0}, {"right", 0.985, 1.0}};
    const PolicyAnswer full = find_policy(by_newton, task, {}), fast = find_policy(by_reduced, task, {}, {}, &rough);
    ASSERT_TRUE(full.success && fast.success);
    EXPECT_EQ(fast.full_because, std::vector<std::string>{""});
    EXPECT_LT((fast.summaries[0].markers_m - full.summaries[0].markers_m).norm(), 1e-4) << target_m.transpose();
  }
}

TEST_F(SearchOnAReducedBar, IsNotHeldBackByTheRangeOfASlackCable) {
  Simulation by_newton(reduced_->model->full), by_reduced(reduced_->model->full);
  const PolicyTask task = reach(tip_at(1.1, 0.99));
  const PolicyAnswer full = find_policy(by_newton, task, {}),
                     fast = find_policy(by_reduced, task, {}, {}, reduced_.get());
  ASSERT_TRUE(full.success && fast.success);
  EXPECT_EQ(fast.full_because, std::vector<std::string>{""});
  EXPECT_LT((fast.summaries[0].markers_m - full.summaries[0].markers_m).norm(), 2e-5);
}

TEST_F(SearchOnAReducedBar, LeavesToTheFullModelWhatItWasNotTrainedForAndSaysWhy) {
  Simulation by_newton(reduced_->model->full), by_reduced(reduced_->model->full);
  const PolicyTask task = reach(tip_at(0.83, 1.0));
  const PolicyAnswer full = find_policy(by_newton, task, {}),
                     fast = find_policy(by_reduced, task, {}, {}, reduced_.get());
  ASSERT_TRUE(fast.success);
  EXPECT_NE(fast.full_because[0].find("beyond the commands of left"), std::string::npos) << fast.full_because[0];
  EXPECT_EQ(fast.summaries[0].markers_m, full.summaries[0].markers_m);
  Simulation pulled(reduced_->model->full);
  pulled.set_command("left", 0.85);
  const PolicyAnswer from_outside = find_policy(pulled, reach(tip_at(0.92, 1.0)), {}, {}, reduced_.get());
  EXPECT_NE(from_outside.full_because[0].find("start is outside"), std::string::npos) << from_outside.full_because[0];
}

TEST_F(SearchOnAReducedBar, LeavesToTheFullModelASearchThatItsErrorDoesNotAllow) {
  const auto why_full = [](double error_m) {
    ReducedChoice strict = *reduced_;
    strict.equilibria.max_m = strict.transient.max_m = error_m;
    Simulation simulation(reduced_->model->full);
    const PolicyAnswer answer = find_policy(simulation, reach(tip_at(0.92, 0.99)), {}, {}, &strict);
    EXPECT_TRUE(answer.success);
    return answer.full_because.at(0);
  };
  EXPECT_EQ(why_full(1e-9), "the reduced model starts in another shape");
  EXPECT_NE(why_full(5e-5).find("mm from the search's end, more than the 0.1 mm"), std::string::npos) << why_full(5e-5);
}

TEST_F(SearchOnAReducedBar, StopsWhereTheCallerCancels) {
  Simulation simulation(reduced_->model->full);
  const PolicyAnswer answer = find_policy(
      simulation, reach(tip_at(0.92, 1.0)), {}, [](size_t, const auto&, const auto&) { return false; }, reduced_.get());
  EXPECT_EQ(answer.summaries[0].stop_reason, "cancelled");
}

}  // namespace
}  // namespace soft_robot_lab
