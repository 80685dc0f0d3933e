// SPDX-License-Identifier: BSD-3-Clause
// The laws of a contact point, and the term they make for Newton's method, against central differences.
#include <cmath>

#include <gtest/gtest.h>

#include "mechanics/box_mesh.h"
#include "mechanics/contact/contact_step.h"
#include "mechanics/contact/contact_term.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

const NormalLaw kNormal = NormalLaw::of_skin(0.01, 264200.0);

TEST(NormalLaw, SinksInByWhatItsComplianceSays) {
  EXPECT_NEAR(kNormal.compliance_m_pa * 20e3, 1.5e-6, 0.02e-6);
  EXPECT_NEAR(kNormal.pressure_pa(-1.5e-6), 20e3, 0.02 * 20e3);
  EXPECT_EQ(kNormal.pressure_pa(1e-6), 0.0);
}

TEST(NormalLaw, KnowsWhatIsOffAndWhatIsNot) {
  EXPECT_EQ(kNormal.mismatch_m(1e-3, 0.0), 0.0);                                     // open
  EXPECT_NEAR(kNormal.mismatch_m(-1e3 * kNormal.compliance_m_pa, 1e3), 0.0, 1e-18);  // closed
  EXPECT_EQ(kNormal.mismatch_m(-1e-5, 0.0), -1e-5);                                  // sunk in
  EXPECT_GT(kNormal.mismatch_m(1e-5, 1e3), 1e-5);                                    // pushes from afar
  EXPECT_TRUE(kNormal.closed(0.0, 0.0));
  EXPECT_FALSE(kNormal.closed(1e-9, 0.0));
  EXPECT_TRUE(kNormal.closed(1e-9, 1e3));
  EXPECT_FALSE(kNormal.closed(1e-3, 1e3));
}

TEST(NormalLaw, MeritFallsByWhatItPushes) {
  for (const double pressure : {0.0, 2e3})
    for (const double gap : {-1e-5, -1e-7, 1e-7, 3e-6, 1e-4}) {
      const double step = 1e-9;
      const double slope =
          (kNormal.merit_j_m2(gap + step, pressure) - kNormal.merit_j_m2(gap - step, pressure)) / (2 * step);
      EXPECT_NEAR(slope, -kNormal.merit_pa(gap, pressure), 1e-6 * (1.0 + std::abs(slope))) << gap << " " << pressure;
    }
}

TEST(FrictionLaw, SticksThenSlidesAgainstTheMotion) {
  const FrictionLaw law{1e-9, 500.0};  // at the limit 0.5 um away
  EXPECT_TRUE(law.traction_pa({0.2e-6, 0, 0}).isApprox(Vector3d(200, 0, 0)));
  EXPECT_FALSE(law.slips({0.2e-6, 0, 0}));
  EXPECT_TRUE(law.traction_pa({3e-6, 4e-6, 0}).isApprox(Vector3d(300, 400, 0)));
  EXPECT_TRUE(law.slips({3e-6, 4e-6, 0}));
  EXPECT_TRUE((FrictionLaw{1e-9, 0.0}.traction_pa({1e-3, 0, 0}).isZero(0.0)));
}

TEST(FrictionLaw, TractionAndStiffnessAreDerivativesOfItsPotential) {
  const FrictionLaw law{1e-9, 500.0};
  const Vector3d normal = Vector3d::UnitZ();
  for (const Vector3d& away : {Vector3d(0.2e-6, 0.1e-6, 0), Vector3d(3e-6, -4e-6, 0)}) {
    for (int axis = 0; axis < 2; ++axis) {
      const Vector3d step = 1e-11 * Vector3d::Unit(axis);
      const double slope = (law.potential_j_m2(away + step) - law.potential_j_m2(away - step)) / 2e-11;
      EXPECT_NEAR(slope, law.traction_pa(away)[axis], 1e-4 * 500.0);
      const Vector3d change = (law.traction_pa(away + step) - law.traction_pa(away - step)) / 2e-11;
      EXPECT_LT((change - law.stiffness_pa_m(away, normal).col(axis)).norm(), 1e-5 / 1e-9);
    }
  }
}

TEST(FrictionLaw, SecantStiffnessIsThatOfAParabolaOverThePotential) {
  FrictionLaw law{1e-9, 500.0};
  law.secant = true;
  const Vector3d normal = Vector3d::UnitZ();
  for (const Vector3d& away : {Vector3d(0.2e-6, 0.1e-6, 0), Vector3d(3e-6, -4e-6, 0), Vector3d(0, 0.6e-6, 0)})
    for (const Vector3d& step : {Vector3d(-1e-5, 0, 0), Vector3d(-2e-6, 3e-6, 0), Vector3d(0, 1e-4, 0)}) {
      const double over = law.potential_j_m2(away) + law.traction_pa(away).dot(step) +
                          0.5 * step.dot(law.stiffness_pa_m(away, normal) * step);
      EXPECT_GE(over * (1.0 + 1e-12), law.potential_j_m2(away + step));
    }
}

Body block(const Eigen::Vector3i& cells, bool quadratic = true) {
  Body body(box_mesh({-0.01, 0, -0.01}, {0.01, 0.02, 0.01}, cells, quadratic), {264200.0, 0.49, 1070.0});
  body.fix_nodes({-1, 0.02 - 1e-6, -1}, {1, 1, 1}, {true, true, true});
  return body;
}

TEST(ContactPoints, WeighTheSkinThatCanMove) {
  const Body body = block({2, 2, 2});
  const ContactPoints points(body);
  EXPECT_EQ(points.face_count(), 5 * 8);  // not the clamped top
  for (const bool flat : {false, true}) {
    double area = 0.0, moment = 0.0, foot = 0.0;
    for (int point = 0; point < points.count(); ++point) {
      if (!points.serves(point, flat)) continue;
      area += points.weight_m2(point);
      const Vector3d at = points.at(point, body.mesh().nodes_m);
      const bool below = points.looks_most(point, -Vector3d::UnitY(), 0.05, body.mesh().nodes_m) && at.y() < 1e-9;
      if (below) moment += points.weight_m2(point) * at.x() * at.x();
      if (below) foot = std::max(foot, at.x());
      EXPECT_NEAR(points.shape(point).sum(), 1.0, 1e-14);
      EXPECT_NEAR(points.present_area_m2(point, 2.0 * body.mesh().nodes_m), 4.0 * points.weight_m2(point), 1e-12);
    }
    EXPECT_NEAR(area, 5 * 4e-4, 1e-12);
    EXPECT_NEAR(moment, 0.02 * std::pow(0.02, 3) / 12.0, 1e-15);
    EXPECT_EQ(flat, foot == 0.01) << foot;
  }
}

// Takes the blocks of a clique where every face has the same few nodes as the whole body.
class DenseSink : public CliqueSink {
 public:
  DenseSink(std::vector<Clique> cliques, int nodes)
      : matrix(Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes)), cliques_(std::move(cliques)) {}
  void add_outer(int clique, const std::vector<double>& coefficients, const Eigen::Matrix3d& block) override {
    const Clique& nodes = cliques_[static_cast<std::size_t>(clique)];
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = 0; b < nodes.size(); ++b)
        matrix.block<3, 3>(3 * nodes[a], 3 * nodes[b]) += coefficients[a] * coefficients[b] * block;
  }
  void add_dense(int, const Eigen::MatrixXd&) override { FAIL(); }

  Eigen::MatrixXd matrix;

 private:
  std::vector<Clique> cliques_;
};

// Pressed against a ball, with pressures that fit no gap, and friction about to slip at some points.
TEST(ContactTerm, ItsMatrixIsTheDerivativeOfItsForces) {
  for (const double friction : {0.0, 0.5}) {
    Body body = block({1, 1, 1});
    body.set_obstacles({{"ball", Sphere{{0.002, -0.03, 0.001}, 0.03}, {}, friction}});
    const ContactTerm term(body);
    Eigen::Matrix3Xd x = body.mesh().nodes_m;
    ContactState state = term.untouched(x, 0.0);
    x.row(1).array() -= 0.004;
    x.row(0).array() += 2e-9;
    for (Eigen::Index i = 0; i < state.pressures_pa.size(); ++i) state.pressures_pa[i] = 2e3 + 100.0 * double(i % 7);
    const auto forces = [&](const Eigen::Matrix3Xd& at) {
      Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, at.cols());
      const ContactSums sums = term.sums(at, state);
      term.add_forces(sums, sum);
      // l = -g / a follows the gap: what condensation stands for.
      for (const ContactTouch& touch : sums.touches)
        if (!touch.closed) ADD_FAILURE() << "a point is open";
      add_mismatch_forces(term, sums.touches, sums, true, sum);
      return sum;
    };
    // With pressure -g / a, which the matrix takes at its present value in its geometric part only.
    ContactSums here = term.sums(x, state);
    std::vector<ContactTouch> closed;
    for (const ContactTouch& touch : here.touches)
      if (touch.gap_m < 0.0) closed.push_back(touch);
    state.pressures_pa.setZero();
    for (const ContactTouch& touch : closed) state.pressures_pa[touch.pair] = -touch.gap_m / (0.002 * 0.02 / 264200.0);
    here = term.sums(x, state);
    ASSERT_GT(here.touches.size(), 3u);
    DenseSink sink(term.cliques(), body.mesh().node_count());
    term.add_hessian(here.touches, false, false, sink);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Eigen::Matrix3Xd more = x, less = x;
      more.data()[i] += 1e-10;
      less.data()[i] -= 1e-10;
      const Eigen::Matrix3Xd change = (forces(more) - forces(less)) / 2e-10;
      worst = std::max(worst,
                       (Eigen::Map<const Eigen::VectorXd>(change.data(), change.size()) - sink.matrix.col(i)).norm());
    }
    if (friction == 0.0) {
      EXPECT_LT(worst, 1e-4 * sink.matrix.norm());
    }
    EXPECT_TRUE(sink.matrix.isApprox(sink.matrix.transpose(), 1e-12));
  }
}

// A soft block on a stiff one: obstacles meet each with its own stiffness, and skin on skin has that of the softer.
TEST(ContactTerm, TakesTheStiffnessOfTheElementBehindEachFace) {
  constexpr double kStiff = 20e6, kSoft = 10e3, kSunk = 1e-6;
  TetMesh mesh = box_mesh({-0.01, 0, -0.01}, {0.01, 0.02, 0.01}, {2, 2, 2});
  add_body("soft", box_mesh({-0.01, 0.02, -0.01}, {0.01, 0.04, 0.01}, {2, 2, 2}), mesh);
  Body body(std::move(mesh), {{kStiff, 0.45, 1070.0}, {kSoft, 0.45, 1070.0}});
  body.let_skin_touch({{0, 1, 0.0}});
  body.set_obstacles(
      {{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, {}, 0.0}, {"lid", Plane{{0, 0.04, 0}, {0, -1, 0}}, {}, 0.0}});
  const ContactTerm term(body);
  ContactState state = term.untouched(body.mesh().nodes_m, 0.0);
  Eigen::Matrix3Xd x = body.mesh().nodes_m;
  for (Eigen::Index node = 0; node < x.cols(); ++node) x(1, node) += body.body_of_node(int(node)) == 0 ? -kSunk : kSunk;
  const auto compliance = [&](const ContactTouch& touch) {
    return law_of(term, touch).compliance * term.weight_m2(touch.pair) / term.face_size_m(touch);
  };
  for (const ContactTouch& touch : term.sums(x, state).touches)
    EXPECT_NEAR(compliance(touch), 0.002 / (touch.normal.y() > 0.0 ? kStiff : kSoft), 1e-12);
  for (Eigen::Index node = 0; node < x.cols(); ++node)
    x(1, node) -= body.body_of_node(int(node)) == 0 ? 0.0 : 4 * kSunk;
  int on_skin = 0;
  for (const ContactTouch& touch : term.sums(x, state).touches) {
    if (!touch.on_skin()) continue;
    ++on_skin;
    EXPECT_NEAR(compliance(touch), 0.002 / kSoft, 1e-12);
  }
  EXPECT_GT(on_skin, 0);
}

TEST(ContactTerm, AnAnchorStaysWhereTheSkinSticksAndFollowsWhereItSlips) {
  Body body = block({1, 1, 1});
  body.set_obstacles({{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, {}, 0.5}});
  const ContactTerm term(body);
  Eigen::Matrix3Xd x = body.mesh().nodes_m;
  ContactState state = term.untouched(x, 0.0);
  for (const ContactTouch& touch : term.sums(x, state).touches) state.pressures_pa[touch.pair] = 1e3;
  const FrictionLaw law{FrictionLaw::compliance_of_skin(0.02, 264200.0), 500.0};
  const double at_limit_m = law.limit_pa * law.compliance_m_pa;
  const Eigen::Matrix3Xd before = state.anchors_m;
  const auto moved = [&](double by_m) {
    Eigen::Matrix3Xd there = x;
    there.row(0).array() += by_m;
    ContactState after = state;
    term.commit(there, after);
    for (const ContactTouch& touch : term.sums(x, state).touches)
      return after.anchors_m(0, touch.pair) - before(0, touch.pair);
    return -1.0;
  };
  EXPECT_NEAR(moved(0.9 * at_limit_m), 0.0, 1e-15);
  EXPECT_NEAR(moved(3.0 * at_limit_m), 2.0 * at_limit_m, 1e-15);
  EXPECT_NEAR(moved(-1e-3), -1e-3 + at_limit_m, 1e-15);
}

// Of obstacles among themselves, some of them free, whose ties pull at a share of their limit along x and z.
struct RigidScene {
  std::vector<Obstacle> obstacles;
  FreeObstacles free;
  RigidContact contact;
  ContactState state;

  RigidScene(std::vector<Obstacle> all, double share)
      : obstacles(std::move(all)), free(obstacles, {0, -9.81, 0}), contact(obstacles, free) {
    state.free = state.free_before = free.at_start();
    state.rigid_ties_m.setZero(3, contact.pair_count());
    press();
    for (const RigidTouch& touch : contact.touches(state))
      state.rigid_ties_m.col(touch.pair) = share * touch.friction.limit_pa * touch.friction.compliance_m_pa *
                                           touch.along(Vector3d(1.0, 0.0, 0.5)).normalized();
  }
  // Forces that fit the gaps.
  void press() {
    state.rigid_forces_n.setZero(contact.pair_count());
    for (const RigidTouch& touch : contact.touches(state))
      state.rigid_forces_n[touch.pair] = contact.law_of(touch.pair).pressure_pa(touch.gap_m);
  }
  RigidTouches moved_by(const FreeColumns& motion) const {
    RigidScene scene = *this;
    scene.state.free = moved(state.free, motion);
    scene.press();
    return scene.contact.touches(scene.state);
  }
  FreeColumns forces(const RigidTouches& at) const {
    FreeColumns all = FreeColumns::Zero(3, 2 * free.count());
    contact.add_forces(at, all);
    return all;
  }
};

Obstacle rubbing(const std::string& name, const ObstacleShape& shape, double mass_kg, const std::string& on) {
  Obstacle one{name, shape, {}, 0.0};
  one.mass_kg = mass_kg;
  one.friction_on[on] = 0.4;
  return one;
}

// Ball on a ball that is held or free, box on a floor and on a free box, bar, capsule and cylinder across a bar.
TEST(RigidContact, DerivativesAreThoseOfForcesAndOfWhatIsBeyondTheLimit) {
  const Obstacle floor{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, {}, 0.0};
  Obstacle held{"ball", Sphere{{0, -0.01, 0}, 0.01}, {}, 0.0}, loose = held;
  loose.mass_kg = 0.02;
  const Obstacle ball = rubbing("on", Sphere{{0.002, 0.00879, 0.001}, 0.009}, 0.01, "ball");
  const Obstacle box = rubbing("box", RoundedBox{{0, 0.01, 0}, {0.02, 0.02001, 0.03}, 0.001}, 0.01, "floor");
  const Obstacle above = rubbing("above", RoundedBox{{0.001, 0.025, 0}, {0.01, 0.01, 0.01}, 0.001}, 0.01, "box");
  const Obstacle bar{"bar", RoundedBox{{0, -0.005, 0}, {0.01, 0.01, 0.1}, 0.001}, {}, 0.0};
  const Obstacle across = rubbing("across", RoundedBox{{0, 0.00499, 0}, {0.1, 0.01, 0.012}, 0.001}, 0.01, "bar");
  const Vector3d end_m(0.04, 0.00399, 0.03), other_m(-0.03, 0.00399, -0.02);
  const Obstacle capsule = rubbing("across", Capsule{end_m, other_m, 0.004}, 0.01, "bar");
  const Obstacle cylinder = rubbing("across", Cylinder{end_m, other_m, 0.004, 0.001}, 0.01, "bar");
  for (const std::vector<Obstacle>& obstacles : {std::vector{held, ball},
                                                 {loose, ball},
                                                 {floor, box},
                                                 {floor, box, above},
                                                 {bar, across},
                                                 {bar, capsule},
                                                 {bar, cylinder}}) {
    SCOPED_TRACE(obstacles.back().name + " on " + obstacles.front().name);
    for (const double share : {0.5, 1.0}) {
      const RigidScene scene(obstacles, share);
      RigidTouches touches = scene.contact.touches(scene.state);
      ASSERT_GT(scene.state.rigid_forces_n.maxCoeff(), 0.0);
      for (RigidTouch& touch : touches) touch.friction.held = share == 1.0;
      const FreeColumns motion = 1e-9 * FreeColumns::Random(3, 2 * scene.free.count());
      const RigidTouches after = scene.moved_by(motion), before = scene.moved_by(-motion);
      ASSERT_EQ(after.size(), touches.size());
      ASSERT_EQ(before.size(), touches.size());
      for (std::size_t i = 0; i < touches.size(); ++i) {
        const RigidTouch& touch = touches[i];
        if (touch.force_n == 0.0) continue;
        const auto beyond_m = [](const RigidTouch& at) {
          return at.along(at.off_m).norm() - at.friction.compliance_m_pa * at.friction.limit_pa;
        };
        const double measured_m = 0.5 * (beyond_m(after[i]) - beyond_m(before[i]));
        EXPECT_NEAR(scene.contact.beyond_limit_m(touch, motion), measured_m, 1e-5 * std::abs(measured_m));
      }
      if (share == 1.0) continue;
      const FreeColumns measured = 0.5 * (scene.forces(after) - scene.forces(before));
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(motion.size(), motion.size());
      scene.contact.add_hessian(touches, false, matrix);
      FreeColumns exact = (matrix * motion.reshaped()).reshaped(3, motion.cols());
      scene.contact.add_turned(touches, motion, exact);
      EXPECT_LT((exact - measured).norm(), 1e-6 * measured.norm());
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
