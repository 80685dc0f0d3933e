// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/simulation/modal.h"

#include <cmath>

#include <gtest/gtest.h>

#include "reference_table.h"
#include "box_mesh.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kNowhere = Eigen::Vector3d::Constant(-10.0), kEverywhere = Eigen::Vector3d::Constant(10.0);

// The bar of reference R1, clamped at x = 0.
Body cantilever(double poissons_ratio, const Eigen::Vector3i& cells = {15, 3, 3}) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, cells), {264200.0, poissons_ratio, 1070.0});
  body.fix_nodes(kNowhere, {1e-6, 10, 10}, {true, true, true});
  return body;
}

TEST(ModalAnalysis, BendsAsTheReference) {
  for (const ReferenceRow& row : read_reference("r6_modal")) {
    const ModalResult result = modal_analysis(cantilever(row.number("nu")), 2);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.iterations, 40);
    // About y and about z: the mesh is not quite symmetric, so the pair is not quite equal.
    for (const double f : result.frequencies_hz)
      EXPECT_NEAR(f, row.number("f1_bend_Hz"), 0.01 * row.number("f1_bend_Hz"));
  }
}

TEST(ModalAnalysis, BendsWithinHalfAPerCentOnAFinerMesh) {
  const ReferenceRow row = read_reference("r6_modal").at(2);
  const ModalResult result = modal_analysis(cantilever(row.number("nu"), {20, 4, 4}), 2);
  ASSERT_TRUE(result.converged);
  for (const double f : result.frequencies_hz)
    EXPECT_NEAR(f, row.number("f1_bend_Hz"), 0.005 * row.number("f1_bend_Hz"));
}

TEST(ModalAnalysis, FindsTheHigherModesOfTheReference) {
  const ReferenceRow row = read_reference("r6_modal").at(2);
  const Body body = cantilever(row.number("nu"));
  const ModalResult result = modal_analysis(body, 9);
  ASSERT_TRUE(result.converged);
  // Two first bends, torsion, two second bends, along the axis, torsion, two third bends.
  EXPECT_NEAR(result.frequencies_hz[3], row.number("f2_Hz"), 0.02 * row.number("f2_Hz"));
  EXPECT_NEAR(result.frequencies_hz[5], row.number("f3_Hz"), 0.02 * row.number("f3_Hz"));
  const Eigen::Map<const Eigen::Matrix3Xd> along(result.shapes.col(5).data(), 3, body.mesh().node_count());
  const Eigen::Vector3d momentum = along * body.node_masses_kg();
  EXPECT_GT(std::abs(momentum.x()), 100.0 * momentum.tail<2>().norm());
}

TEST(ModalAnalysis, ShapesAreOrthogonalAndHeldWhereTheBodyIs) {
  const Body body = cantilever(0.49, {4, 1, 1});
  const ModalResult result = modal_analysis(body, 12);
  ASSERT_TRUE(result.converged);
  const Eigen::Matrix3Xd masses = Eigen::Vector3d::Ones() * body.node_masses_kg().transpose();
  const Eigen::Map<const Eigen::VectorXd> m(masses.data(), masses.size());
  const Eigen::MatrixXd products = result.shapes.transpose() * m.asDiagonal() * result.shapes;
  EXPECT_LT((products - Eigen::MatrixXd::Identity(12, 12)).cwiseAbs().maxCoeff(), 1e-9);
  for (Eigen::Index mode = 0; mode < 12; ++mode)
    for (int node = 0; node < body.mesh().node_count(); ++node)
      EXPECT_EQ(result.shapes.col(mode).segment<3>(3 * node).norm() == 0.0, body.fixed()(0, node));
}

// Guided on all sides the bar can only vibrate along its axis, with the modulus of the plane wave.
TEST(ModalAnalysis, GuidedBarVibratesAlongItsAxis) {
  const Material material{264200.0, 0.3, 1070.0};
  const double speed_m_s =
      std::sqrt((material.lame_lambda_pa() + 2.0 * material.lame_mu_pa()) / material.density_kg_m3);
  for (const bool clamped : {true, false}) {
    Body body(box_mesh({0, 0, 0}, {0.1, 0.004, 0.004}, {24, 1, 1}), material);
    body.fix_nodes(kNowhere, kEverywhere, {false, true, true});
    if (clamped) body.fix_nodes(kNowhere, {1e-6, 10, 10}, {true, false, false});
    const ModalResult result = modal_analysis(body, 3);
    ASSERT_TRUE(result.converged);
    const double quarter_hz = speed_m_s / (4.0 * 0.1);
    for (int mode = 0; mode < 3; ++mode) {
      const double expected_hz = quarter_hz * (clamped ? 2 * mode + 1 : 2 * mode);  // free: it floats, then n / 2L
      EXPECT_NEAR(result.frequencies_hz[mode], expected_hz, 0.005 * expected_hz + 0.02) << clamped << " " << mode;
    }
  }
}

TEST(ModalAnalysis, ABodyThatNothingHoldsHasSixMotionsWithoutFrequency) {
  const Body body(box_mesh({0, 0, 0}, {0.1, 0.02, 0.02}, {5, 1, 1}), {264200.0, 0.4999, 1070.0});
  const ModalResult result = modal_analysis(body, 7);
  ASSERT_TRUE(result.converged);
  EXPECT_LT(result.frequencies_hz.head(6).maxCoeff(), 0.02);
  EXPECT_GT(result.frequencies_hz[6], 10.0);
}

TEST(ModalAnalysis, IsTheSameEveryTime) {
  const Body body = cantilever(0.499, {4, 1, 1});
  EXPECT_EQ(modal_analysis(body, 4).frequencies_hz, modal_analysis(body, 4).frequencies_hz);
}

TEST(ModalAnalysis, RefusesModesThatThereAreNot) {
  const Body body = cantilever(0.499, {2, 1, 1});
  for (const int modes : {-1, 0, 101}) EXPECT_THROW(modal_analysis(body, modes), std::invalid_argument) << modes;
  Body held(box_mesh({0, 0, 0}, {0.01, 0.01, 0.01}, {1, 1, 1}), Material{});
  held.fix_nodes(kNowhere, kEverywhere, {true, true, true});
  try {
    modal_analysis(held, 1);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "modes: 1 is out of range [1, 0]");
  }
}

}  // namespace
}  // namespace soft_robot_lab
