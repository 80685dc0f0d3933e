// SPDX-License-Identifier: BSD-3-Clause
// What shortens the solution of a time step.
#include "mechanics/simulation/prediction.h"

#include <gtest/gtest.h>

#include "mechanics/linear_algebra/anderson_mixing.h"

namespace soft_robot_lab {
namespace {

// One node on x = 3 + 2 t + 5 t^2, at t = 0, with what each integrator takes for its velocity there.
SimulationState on_a_parabola(double previous_step_s, StepRule rule) {
  const double h = previous_step_s, middle = rule == StepRule::bdf2 ? 0.0 : 0.5;
  const auto velocity = [&](double t) { return 2.0 + 10.0 * (t - middle * h); };
  SimulationState state;
  state.positions_m = Eigen::Matrix3Xd::Constant(3, 1, 3.0);
  state.velocities_m_s = Eigen::Matrix3Xd::Constant(3, 1, velocity(0.0));
  state.previous_step_s = h;
  state.previous_velocities_m_s = Eigen::Matrix3Xd::Constant(3, 1, velocity(-h));
  state.element_multipliers_pa = Eigen::VectorXd::Constant(1, 7.0);
  state.previous_element_multipliers_pa = Eigen::VectorXd::Constant(1, 6.0);
  state.constraint_multipliers = Eigen::Vector2d(1.0, 4.0);
  state.previous_constraint_multipliers = Eigen::Vector2d(3.0, 3.0);
  state.contact.pressures_pa = Eigen::Vector4d(5.0, 1.0, 2.0, 0.0);
  state.previous_pressures_pa = Eigen::Vector4d(4.0, 3.0, 0.0, 2.0);
  return state;
}

TEST(Prediction, FollowsAParabola) {
  const double h = 0.01;
  const NewtonState bdf2 = predict(on_a_parabola(h, StepRule::bdf2), h, StepRule::bdf2);
  EXPECT_NEAR(bdf2.positions_m(0, 0), 3.0 + 2.0 * h + 5.0 * h * h, 1e-12);
  const NewtonState euler = predict(on_a_parabola(h, StepRule::implicit_euler), h, StepRule::implicit_euler);
  EXPECT_NEAR(euler.positions_m(0, 0), 3.0 + 2.0 * h + 5.0 * h * h, 1e-12);
  EXPECT_NEAR(euler.element_multipliers_pa[0], 8.0, 1e-12);
  EXPECT_EQ(euler.constraint_multipliers[0], 0.0);  // stops where it would change sign
  EXPECT_NEAR(euler.constraint_multipliers[1], 5.0, 1e-12);
}

// The others press as they did: what lets go or has just closed is no trend.
TEST(Prediction, FollowsThePressureOfWhatPressesOn) {
  const double h = 0.01;
  const NewtonState start = predict(on_a_parabola(h, StepRule::implicit_euler), h, StepRule::implicit_euler);
  EXPECT_LT((start.contact.pressures_pa - Eigen::Vector4d(6.0, 1.0, 2.0, 0.0)).norm(), 1e-12);
}

TEST(Prediction, TrustsOnlyTheVelocityWhereTheMotionIsNotSmooth) {
  const double h = 0.01;
  for (const char* what : {"start", "sudden", "longer"}) {
    SimulationState state = on_a_parabola(h, StepRule::implicit_euler);
    if (what[0] == 'l') state.previous_step_s = 0.2 * h;
    if (what[1] == 't') state.previous_step_s = 0.0;
    if (what[1] == 'u') state.previous_velocities_m_s.setZero();
    const NewtonState start = predict(state, h, StepRule::implicit_euler);
    EXPECT_EQ(start.positions_m, (state.positions_m + h * state.velocities_m_s).eval()) << what;
    EXPECT_EQ(start.constraint_multipliers, state.constraint_multipliers) << what;
    EXPECT_EQ(start.contact.pressures_pa, state.contact.pressures_pa) << what;
  }
}

// With as many past steps as unknowns, a linear system is solved whatever the preconditioner.
TEST(AndersonMixing, SolvesALinearSystemInAsManyStepsAsItHasUnknowns) {
  Eigen::Matrix3d matrix;
  matrix << 4, 1, 0, 1, 3, 1, 0, 1, 2;
  const Eigen::Vector3d right(1, 2, 3);
  Eigen::VectorXd x = Eigen::Vector3d::Zero();
  AndersonMixing mixing(3);
  for (int i = 0; i < 4; ++i) {
    const Eigen::VectorXd residual = matrix * x - right;
    x = mixing.next(x, -0.9 * residual, residual);  // on its own this diverges
  }
  EXPECT_LT((matrix * x - right).norm(), 1e-10);
}

}  // namespace
}  // namespace soft_robot_lab
