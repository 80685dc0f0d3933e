// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuators/cable.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "dense_sink.h"
#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {
namespace {

class CableTest : public ::testing::Test {
 protected:
  CableTest() : body_(box_mesh({0, -0.01, -0.01}, {0.06, 0.01, 0.01}, {3, 2, 2}), Material{}), locator_(body_.mesh()) {
    body_.fix_nodes({-1, -1, -1}, {1e-9, 1, 1}, {true, true, true});
    bent_ = body_.mesh().nodes_m;
    for (Eigen::Index i = 0; i < bent_.cols(); ++i) {
      bent_(1, i) += 4.0 * bent_(0, i) * bent_(0, i) + 0.0004 * std::sin(3.0 * static_cast<double>(i));
      bent_(2, i) += 0.2 * bent_(0, i);
    }
  }

  std::unique_ptr<Cable> cable(const std::string& settings) const {
    auto made = std::make_unique<Cable>();
    made->initialise(YamlNode::parse(settings, "cable.yaml"), body_, locator_);
    return made;
  }
  std::unique_ptr<Cable> side_cable(const std::string& more = "") const {
    return cable("{name: side, points_m: [[0, 0.006, 0], [0.02, 0.006, 0.002], [0.04, 0.006, 0], [0.057, 0.006, 0]]" +
                 more + "}");
  }

  // The words of the error that the settings end in.
  std::string refusal(const std::string& settings) const {
    try {
      cable(settings);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  // Of a cable that is at rest, or has followed a command for a time.
  static DriveState drive_of(const Cable& cable, double command, double time_s) {
    DriveState drive = cable.rest_state();
    cable.set_command(command, drive);
    cable.advance(time_s, drive);
    return drive;
  }
  ActuatorReading rest_reading(const Cable& cable, const std::vector<double>& multipliers) const {
    return cable.observe(body_.mesh().nodes_m, multipliers, cable.rest_state());
  }

  Body body_;
  MeshLocator locator_;
  Eigen::Matrix3Xd bent_;
};

TEST_F(CableTest, GradientAgreesWithCentralDifferences) {
  const auto side = side_cable();
  const Constraint& length = *side->constraints()[0];
  const DriveState drive = side->rest_state();
  Eigen::Matrix3Xd exact = Eigen::Matrix3Xd::Zero(3, bent_.cols());
  length.add_gradient(bent_, drive, 1.0, exact);
  for (Eigen::Index i = 0; i < bent_.size(); ++i) {
    Eigen::Matrix3Xd plus = bent_, minus = bent_;
    plus.data()[i] += 1e-7;
    minus.data()[i] -= 1e-7;
    EXPECT_NEAR(exact.data()[i], (length.value(plus, drive) - length.value(minus, drive)) / 2e-7, 1e-7);
  }
}

TEST_F(CableTest, IsLongerThanCommandedByItsOffset) {
  for (const char* model : {", model: sliding", ", model: friction, friction_coefficient: 0.1"}) {
    const auto loose = side_cable(std::string(model) + ", length_offset_m: 0.001");
    const ActuatorReading at_rest = rest_reading(*loose, {0, 0, 0});
    EXPECT_NEAR(*at_rest.slack_m, 0.001, 1e-12);
    EXPECT_EQ(*at_rest.commanded_length_m, *at_rest.rest_length_m);
    const ActuatorReading pulled = loose->observe(body_.mesh().nodes_m, {0, 0, 0}, drive_of(*loose, 0.9, 1e9));
    EXPECT_NEAR(*pulled.stretch_m, 0.1 * *at_rest.rest_length_m - 0.001, 1e-12);
  }
}

TEST_F(CableTest, HessianAgreesWithCentralDifferences) {
  const auto side = side_cable();
  const Constraint& length = *side->constraints()[0];
  const DriveState drive = side->rest_state();
  // Also with a span that has all but closed.
  Eigen::Matrix3Xd closing = bent_;
  for (Eigen::Index i = 0; i < closing.cols(); ++i)
    if (body_.mesh().nodes_m(0, i) > 0.021) closing(0, i) = 0.02 + 0.05 * (closing(0, i) - 0.02);
  for (const Eigen::Matrix3Xd& positions : {bent_, closing}) {
    DenseSink exact(length, positions.cols());
    length.add_hessian(positions, drive, 2.0, exact);
    for (Eigen::Index i = 0; i < positions.size(); ++i) {
      Eigen::Matrix3Xd plus = positions, minus = positions, change = Eigen::Matrix3Xd::Zero(3, positions.cols());
      plus.data()[i] += 1e-8;
      minus.data()[i] -= 1e-8;
      length.add_gradient(plus, drive, 2.0 / 2e-8, change);
      length.add_gradient(minus, drive, -2.0 / 2e-8, change);
      EXPECT_LT((exact.hessian.col(i) - Eigen::Map<const Eigen::VectorXd>(change.data(), change.size())).norm(),
                1e-5 * exact.hessian.norm());
    }
  }
}

TEST_F(CableTest, ForcesSumToZeroAndTurnNothing) {
  const auto side = side_cable();
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, bent_.cols());
  side->constraints()[0]->add_gradient(bent_, side->rest_state(), -5.0, forces);
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < bent_.cols(); ++i) moment += bent_.col(i).cross(forces.col(i));
  EXPECT_GT(forces.norm(), 1.0);
  EXPECT_LT(forces.rowwise().sum().norm(), 1e-12);
  EXPECT_LT(moment.norm(), 1e-12);
}

TEST_F(CableTest, TensionDoesTheWorkOfItsShortening) {
  // Along a finite motion, the work of unit tension is the length lost.
  const auto side = side_cable();
  const Constraint& length = *side->constraints()[0];
  const DriveState drive = side->rest_state();
  const Eigen::Matrix3Xd& rest = body_.mesh().nodes_m;
  double work = 0.0;
  const int steps = 2000;
  for (int i = 0; i < steps; ++i) {
    const Eigen::Matrix3Xd at = rest + (bent_ - rest) * ((i + 0.5) / steps);
    Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, rest.cols());
    length.add_gradient(at, drive, -1.0, forces);
    work += forces.cwiseProduct((bent_ - rest) / steps).sum();
  }
  EXPECT_NEAR(work, length.value(rest, drive) - length.value(bent_, drive), 1e-9);
}

TEST_F(CableTest, RestLengthIsThatOfThePath) {
  const auto side = side_cable();
  const double expected = 2.0 * std::hypot(0.02, 0.002) + 0.017;
  EXPECT_NEAR(*rest_reading(*side, {0.0}).rest_length_m, expected, 1e-12);
}

TEST_F(CableTest, CommandsByContractionLengthOrTension) {
  const auto law_after = [&](const Cable& cable, double command, double length_m) {
    return cable.constraints()[0]->law(length_m, 0.0, drive_of(cable, command, 1.0));
  };
  const auto contraction = side_cable();
  const double rest = *rest_reading(*contraction, {0.0}).rest_length_m;
  EXPECT_NEAR(law_after(*contraction, 0.9, rest).offset, 0.1 * rest, 1e-12);
  EXPECT_EQ(law_after(*contraction, 0.9, rest).min_multiplier, 0.0);

  const auto length = side_cable(", command: length_m");
  EXPECT_NEAR(law_after(*length, 0.05, rest).offset, rest - 0.05, 1e-12);

  const auto tension = side_cable(", command: tension_n");
  EXPECT_TRUE(law_after(*tension, 3.0, rest).prescribed());
  EXPECT_EQ(law_after(*tension, 3.0, rest).min_multiplier, 3.0);
}

TEST_F(CableTest, MovesNoFasterThanItsDrive) {
  const auto slow = side_cable(", pull_speed_m_s: 0.02");
  const double rest = *rest_reading(*slow, {0.0}).rest_length_m;
  DriveState drive = drive_of(*slow, 0.8, 0.1);
  EXPECT_NEAR(drive.actuated_command, 1.0 - 0.02 * 0.1 / rest, 1e-12);
  slow->advance(100.0, drive);
  EXPECT_EQ(drive.actuated_command, 0.8);
}

TEST_F(CableTest, RefusesCommandsBeyondItsLimits) {
  const auto side = side_cable(", min_contraction: 0.7");
  DriveState drive = side->rest_state();
  for (const double wrong : {0.69, 1.6, -1.0, std::nan("")}) {
    EXPECT_THROW(side->set_command(wrong, drive), std::invalid_argument) << wrong;
    EXPECT_EQ(drive.command, 1.0);
  }
  try {
    side->set_command(0.5, drive);
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "command of actuator 'side': 0.5 is out of range [0.7, 1.5]");
  }
}

TEST_F(CableTest, MovesPointsJustOutsideOntoTheBody) {
  const auto near =
      cable("{name: n, points_m: [[0.01, 0.0105, 0], [0.05, 0.0105, 0]], sheath_radius_m: 0.001, plug_radius_m: 0}");
  for (const Eigen::Vector3d& point : rest_reading(*near, {0.0}).path_m) EXPECT_LE(point.y(), 0.01 + 1e-9);
  const std::vector<PathChange> changes = rest_reading(*near, {0.0}).path_changes;
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[1].point, 1);
  EXPECT_NEAR(changes[1].moved_m, 0.0005, 1e-9);
}

// Half of its sheath's disc is outside the body, and left out: it takes hold deeper than it was put.
TEST_F(CableTest, ReportsByHowMuchADiscThatReachesOutsideMovesIt) {
  const auto near = cable("{name: n, points_m: [[0.01, 0.01, 0], [0.05, 0.005, 0]], sheath_radius_m: 0.002}");
  const std::vector<PathChange> changes = rest_reading(*near, {0.0}).path_changes;
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].point, 0);
  EXPECT_GT(changes[0].moved_m, 0.3 * 0.002);
  EXPECT_LT(changes[0].moved_m, 0.5 * 0.002);
  EXPECT_NEAR(rest_reading(*near, {0.0}).path_m[0].y(), 0.01 - changes[0].moved_m, 1e-4);
}

TEST_F(CableTest, PointsOnHeldMaterialStayPoints) {
  const auto side = side_cable(", sheath_radius_m: 0.002");
  const EmbeddedPoint start = side->constraints()[0]->carried_points()[0];
  for (std::size_t k = 0; k < start.nodes.size(); ++k) {
    EXPECT_TRUE(std::abs(start.weights[k]) < 1e-9 || body_.fixed().col(start.nodes[k]).all());
  }
}

TEST_F(CableTest, RefusesBadSettings) {
  struct Case {
    std::string settings, words;
  };
  const Case cases[] = {
      {"{name: a, points_m: [[0, 0, 0]]}", "needs at least two points, this one has 1"},
      {"{name: a, points_m: [[0, 0, 0], [0, 0]]}", "a point is [x, y, z]"},
      {"{name: a, points_m: [[0, 0, 0], [0, 0, 0]]}", "repeats the point before it, (0, 0, 0) m"},
      {"{name: a, points_m: [[0, 0, 0], [0.05, 0.02, 0]]}",
       "point 1 at (0.05, 0.02, 0) m lies 0.01 m outside the body"},
      {"{name: a, points_m: [[0.01, 0.01, 0.01], [0.05, 0, 0]], sheath_radius_m: 0.002}",
       "point 0 at (0.01, 0.01, 0.01) m: its disc of radius 0.002 m lies so far outside the body that it takes hold"},
      {"{name: a, points_m: [[0, 0, 0], [0.05, 0, 0]], compliance_m_n: -1}", "compliance_m_n"},
      {"{name: a, points_m: [[0, 0, 0], [0.05, 0, 0]], plug_radius_m: 0.012}",
       "plug_radius_m: 0.012 is out of range [0, "},
      {"{name: a, points_m: [[0, 0, 0], [0.05, 0, 0]], model: glide}", "model"},
      {"{name: a, points_m: [[0, 0, 0], [0.05, 0, 0]], command: beta}", "command"},
      {"{name: '', points_m: [[0, 0, 0], [0.05, 0, 0]]}", "name: must not be empty"},
      {"{points_m: [[0, 0, 0], [0.05, 0, 0]]}", "name"},
  };
  for (const Case& wrong : cases)
    EXPECT_NE(refusal(wrong.settings).find(wrong.words), std::string::npos) << refusal(wrong.settings);
}

TEST(Factory, KnowsItsPlugins) {
  EXPECT_NE(make_actuator("soft_robot_lab/Cable"), nullptr);
  try {
    make_actuator("soft_robot_lab/Balloon");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "unknown actuator plugin 'soft_robot_lab/Balloon'; known: soft_robot_lab/Cable, soft_robot_lab/Chamber");
  }
}

}  // namespace
}  // namespace soft_robot_lab
