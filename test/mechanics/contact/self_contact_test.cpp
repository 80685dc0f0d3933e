// SPDX-License-Identifier: BSD-3-Clause
// Bodies that touch themselves: references, derivatives, thin walls, and states that are restored.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "compare_with_reference.h"
#include "contact_bodies.h"
#include "mechanics/carved_mesh.h"
#include "mechanics/contact/contact_term.h"
#include "reference_table.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

// Plane strain, from above and from below.
void press(Body& body, const Vector3d& from_m, const Vector3d& to_m, double traction_pa) {
  body.add_traction(from_m, to_m, {0, -traction_pa, 0});
  body.add_traction({from_m.x(), -to_m.y(), from_m.z()}, {to_m.x(), -from_m.y(), to_m.z()}, {0, traction_pa, 0});
}

// Elements of 2 mm, unless others are asked for.
Simulation pressed_slot(double traction_pa, const Eigen::Vector3i& cells = {30, 16, 2},
                        const SolverOptions& options = {}) {
  Body body(carved({-0.03, -0.012, 0}, {0.03, 0.012, 0.01}, cells,
                   [](const Vector3d& at) { return std::abs(at.x()) > 0.022 || std::abs(at.y()) > 0.003; }),
            kSilicone);
  body.fix_nodes({-1, -1, -1}, {-0.029999, 1, 1}, {true, true, true});
  body.fix_nodes({0.029999, -1, -1}, {1, 1, 1}, {true, true, true});
  hold_slab(body);
  press(body, {-0.010001, 0.011999, -1}, {0.010001, 0.012001, 1}, traction_pa);
  body.let_touch_itself();
  std::vector<Marker> markers;
  markers.emplace_back("inner_mid", Vector3d(0, 0.003, 0.005), body.mesh(), MeshLocator(body.mesh()));
  markers.emplace_back("top_mid", Vector3d(0, 0.012, 0.005), body.mesh(), MeshLocator(body.mesh()));
  return Simulation(std::move(body), {}, std::move(markers), options);
}

TetMesh clip_mesh(const Eigen::Vector3i& cells) {
  return carved({0, -0.014, 0}, {0.06, 0.014, 0.01}, cells,
                [](const Vector3d& at) { return at.x() < 0.01 || std::abs(at.y()) > 0.006; });
}

Simulation pressed_clip(const Eigen::Vector3i& cells, double traction_pa, double friction = 0.0) {
  Body body(clip_mesh(cells), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  hold_slab(body);
  press(body, {0.049999, 0.013999, -1}, {1, 0.014001, 1}, traction_pa);
  body.let_touch_itself(friction);
  std::vector<Marker> markers;
  markers.emplace_back("upper", Vector3d(0.06, 0.014, 0.005), body.mesh(), MeshLocator(body.mesh()));
  markers.emplace_back("lower", Vector3d(0.06, -0.014, 0.005), body.mesh(), MeshLocator(body.mesh()));
  return Simulation(std::move(body), {}, std::move(markers), SolverOptions{});
}

ReferenceRow reference_at(const std::string& table, double traction_pa) {
  for (const ReferenceRow& row : read_reference(table))
    if (row.text("law") == "design" && row.number("nu") == 0.49 &&
        std::abs(row.number("traction_Pa") - traction_pa) < 1e-9)
      return row;
  throw std::runtime_error("no such row");
}

// R9.
TEST(SelfContact, ASlotIsPressedShutAsInTheReference) {
  for (const double traction_pa : {6000.0, 14000.0}) {
    Simulation simulation = pressed_slot(traction_pa);
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const ReferenceRow row = reference_at("r9_slot_selfcontact", traction_pa);
    const ContactReading contact = simulation.contacts().back();
    const double force_n = row.number("contact_force_N");
    const std::string what = "R9, slot, " + rounded(traction_pa) + " Pa | 2 mm | ";
    expect_near_reference(what + "force [N]", contact.normal_force_n, force_n, 0.01 * force_n);
    EXPECT_NEAR(simulation.marker_position(0).y(), 0.0, 1e-5);
    expect_near_reference(what + "top [m]", simulation.marker_position(1).y() - 0.012, row.number("top_mid_uy_m"),
                          2e-5);
    EXPECT_LT(contact.largest_penetration_m, 3e-6);  // guards let in 5e-4 of a face's size
    EXPECT_TRUE(contact.force_n.isZero(0.0));
  }
}

// R9. Just below the traction of the first touch nothing presses, just above it something does; 3 % are asked.
TEST(SelfContact, FirstTouchIsWhereTheReferenceHasIt) {
  const auto touches = [](Simulation simulation) {
    const SolveReport report = simulation.solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
    return simulation.contacts().back().normal_force_n > 0.0;
  };
  const auto first_touch_pa = [](const std::string& table) {
    for (const ReferenceRow& row : read_reference(table))
      if (row.text("law") == "design" && row.number("nu") == 0.49 && row.text("state") == "first_touch")
        return row.number("traction_Pa");
    throw std::runtime_error("no such row");
  };
  const double slot_pa = first_touch_pa("r9_slot_selfcontact"), clip_pa = first_touch_pa("r9_clip_selfcontact");
  EXPECT_FALSE(touches(pressed_slot(0.97 * slot_pa)));
  EXPECT_TRUE(touches(pressed_slot(1.03 * slot_pa)));
  EXPECT_FALSE(touches(pressed_clip({30, 14, 2}, 0.97 * clip_pa)));
  EXPECT_TRUE(touches(pressed_clip({30, 14, 2}, 1.03 * clip_pa)));
}

// By symmetry nothing rubs there, so friction must not change it. The corners touch first, where points inside the
// faces alone miss 28 % of the force at 400 Pa. Of force and tips 2 % is asked. Without friction corner on corner is no
// firm stand on this mesh: both legs sway to one side, at 400 Pa by 185 um (3 %), at the others by 81 um at most, so
// the test looks at how near the legs come to one another.
TEST(SelfContact, TheLegsOfAClipMeetAsInTheReference) {
  for (const auto& [traction_pa, friction] : {std::pair(400.0, 0.0), {1000.0, 0.0}, {1000.0, 0.5}, {4000.0, 0.0}}) {
    Simulation simulation = pressed_clip({30, 14, 2}, traction_pa, friction);
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const ReferenceRow row = reference_at("r9_clip_selfcontact", traction_pa);
    const ContactReading contact = simulation.contacts().back();
    const double force_n = row.number("contact_force_N"), tip_m = row.number("tip_out_uy_m");
    const std::string what = "R9, clip, " + rounded(traction_pa) + " Pa, friction " + rounded(friction) + " | 2 mm | ";
    expect_near_reference(what + "force [N]", contact.normal_force_n, force_n, 0.02 * force_n);
    EXPECT_LT(contact.largest_penetration_m, 3e-6);
    const double upper_m = simulation.marker_position(0).y(), lower_m = simulation.marker_position(1).y();
    expect_near_reference(what + "tips [m]", 0.5 * (upper_m - lower_m) - 0.014, tip_m, 0.003 * std::abs(tip_m));
    EXPECT_LT(std::abs(upper_m + lower_m) / 2.0, 0.035 * std::abs(tip_m)) << traction_pa;
    EXPECT_LT(report.iterations, 60) << traction_pa;
  }
}

// Of pressures that are -gap / compliance everywhere. Without guards: those of an edge that meets just the edge of
// other skin find a place that cannot move on, which the matrix does not know.
struct Pressed {
  ContactSums sums;
  Eigen::Matrix3Xd forces_n;
};

Pressed pressed_at(const ContactTerm& term, const ContactState& untouched, const Eigen::Matrix3Xd& positions_m,
                   double compliance_m_pa_per_size) {
  Pressed at{term.sums(positions_m, untouched), Eigen::Matrix3Xd::Zero(3, positions_m.cols())};
  std::vector<ContactTouch>& touches = at.sums.touches;
  const auto guards = [&](const ContactTouch& touch) { return term.skin().points().guards(touch.pair); };
  touches.erase(std::remove_if(touches.begin(), touches.end(), guards), touches.end());
  for (ContactTouch& touch : touches)
    touch.pressure_pa = -touch.gap_m / (compliance_m_pa_per_size * term.face_size_m(touch));
  term.add_forces(at.sums, at.forces_n);
  return at;
}

// Legs that overlap by 20 um, with rough inner sides. The curved part of the matrix counts a hundredth of the whole.
TEST(SelfContact, ItsMatrixIsTheDerivativeOfItsForces) {
  Body body(clip_mesh({6, 14, 1}), kSilicone);
  body.let_touch_itself();
  const ContactTerm term(body);
  Eigen::Matrix3Xd x = body.mesh().nodes_m;
  const ContactState untouched = term.untouched(x, 0.0);
  for (Eigen::Index node = 0; node < x.cols(); ++node) {
    if (x(0, node) < 0.02 || std::abs(x(1, node)) < 0.005) continue;
    x(1, node) -= std::copysign(0.00601 + 4e-6 * std::sin(97.0 * double(node)), x(1, node));
  }
  const double per_size = 0.002 / kSilicone.youngs_modulus_pa;
  const Pressed here = pressed_at(term, untouched, x, per_size);
  ASSERT_GT(here.sums.touches.size(), 20u);
  const auto matrix = [&](bool convex) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(x.size(), x.size());
    for (const ContactTouch& touch : here.sums.touches) {
      const std::vector<int> nodes = term.skin().pairs().nodes(term.skin().faces_of(touch));
      const Eigen::MatrixXd dense = term.skin().hessian(touch, convex, false);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < nodes.size(); ++b)
          sum.block<3, 3>(3 * nodes[a], 3 * nodes[b]) += dense.block<3, 3>(3 * Eigen::Index(a), 3 * Eigen::Index(b));
    }
    return sum;
  };
  const Eigen::MatrixXd whole = matrix(false), flat = matrix(true);
  EXPECT_TRUE(whole.isApprox(whole.transpose(), 1e-12));
  const Eigen::Index some = x.size() / 7;
  Eigen::MatrixXd wrong(x.size(), some), curved(x.size(), some);
  for (Eigen::Index column = 0; column < some; ++column) {
    const Eigen::Index i = 7 * column;
    Eigen::Matrix3Xd more = x, less = x;
    more.data()[i] += 1e-9;
    less.data()[i] -= 1e-9;
    const Eigen::Matrix3Xd forces_n =
        (pressed_at(term, untouched, more, per_size).forces_n - pressed_at(term, untouched, less, per_size).forces_n) /
        2e-9;
    wrong.col(column) = Eigen::Map<const Eigen::VectorXd>(forces_n.data(), forces_n.size()) - whole.col(i);
    curved.col(column) = whole.col(i) - flat.col(i);
  }
  ASSERT_GT(curved.norm(), 1e-4 * whole.norm());
  EXPECT_LT(wrong.norm(), 0.05 * curved.norm());
  EXPECT_LT(here.forces_n.rowwise().sum().norm(), 1e-12 * here.forces_n.norm());
}

// Legs that overlap by 20 um; the upper one is moved along the other by some part of what friction holds, and by more.
TEST(SelfContact, FrictionTiesSkinToSkinUpToItsLimit) {
  constexpr double kFriction = 0.5, kPressure = 1e4;
  Body body(clip_mesh({6, 14, 1}), kSilicone);
  body.let_touch_itself(kFriction);
  const ContactTerm term(body);
  Eigen::Matrix3Xd x = body.mesh().nodes_m;
  const auto leg = [&](Eigen::Index node) {
    return x(0, node) > 0.02 && std::abs(body.mesh().nodes_m(1, node)) > 0.005;
  };
  for (Eigen::Index node = 0; node < x.cols(); ++node)
    if (leg(node)) x(1, node) -= std::copysign(0.00601, x(1, node));
  ContactState state = term.untouched(x, 0.0);
  for (const ContactTouch& touch : term.sums(x, state).touches) state.pressures_pa[touch.pair] = kPressure;
  const ContactSums start = term.sums(x, state);
  ASSERT_GT(start.touches.size(), 20u);
  const auto moved = [&](double by_m) {
    Eigen::Matrix3Xd there = x;
    for (Eigen::Index node = 0; node < x.cols(); ++node)
      if (leg(node) && body.mesh().nodes_m(1, node) > 0.0) there(2, node) += by_m;
    return there;
  };
  // The tractions of those that press, where the legs have moved as a whole.
  const auto expect_tractions = [&](const ContactState& from, double at_m, double away_m) {
    int counted = 0;
    for (const ContactTouch& touch : term.sums(moved(at_m), from).touches) {
      if (!touch.rubs() || !touch.on_skin() || touch.pressure_pa == 0.0 || touch.anchor_m.x() < 0.035) continue;
      const double tie_m_pa = FrictionLaw::compliance_of_skin(term.face_size_m(touch), kSilicone.youngs_modulus_pa);
      const double limit_pa = kFriction * kPressure;
      EXPECT_NEAR(touch.friction.traction_pa(touch.away_m).norm(), std::min(limit_pa, away_m / tie_m_pa),
                  0.02 * limit_pa);
      ++counted;
    }
    EXPECT_GT(counted, 20);
  };
  const double tie_m_pa = FrictionLaw::compliance_of_skin(0.01, kSilicone.youngs_modulus_pa);
  const double at_limit_m = kFriction * kPressure * tie_m_pa;  // of faces of this size
  expect_tractions(state, 0.0, 0.0);
  expect_tractions(state, 0.4 * at_limit_m, 0.4 * at_limit_m);
  expect_tractions(state, 3.0 * at_limit_m, 3.0 * at_limit_m);
  // The anchors follow what slipped, and only that.
  ContactState stuck = state, slid = state;
  term.commit(moved(0.2 * at_limit_m), stuck);
  expect_tractions(stuck, 0.0, 0.0);
  term.commit(moved(20.0 * at_limit_m), slid);
  expect_tractions(slid, 20.0 * at_limit_m, 20.0 * at_limit_m);
  expect_tractions(slid, 0.0, 20.0 * at_limit_m);
  // What the one side gets the other gives, and the forces do work against the way.
  Eigen::Matrix3Xd forces_n = Eigen::Matrix3Xd::Zero(3, x.cols());
  term.add_forces(term.sums(moved(3.0 * at_limit_m), state), forces_n);
  EXPECT_LT(forces_n.rowwise().sum().norm(), 1e-10 * forces_n.norm());
  EXPECT_GT(forces_n.cwiseProduct(moved(1.0) - x).sum(), 0.0);
}

// Legs that come nearer in steps of 6 um until they overlap by 40 um, and tremble, while the body swings and flies
// away. What was found on the way serves as long as nothing has moved far, but all alike, and changes nothing.
TEST(SelfContact, WhatTouchesDoesNotDependOnTheWayThere) {
  Body body(clip_mesh({30, 14, 2}), kSilicone);
  body.let_touch_itself();
  const ContactTerm all_the_way(body);
  const ContactState untouched = all_the_way.untouched(body.mesh().nodes_m, 0.0);
  std::vector<std::size_t> touching;
  for (int step = 0; step < 30; ++step) {
    Eigen::Matrix3Xd x = body.mesh().nodes_m;
    for (Eigen::Index node = 0; node < x.cols(); ++node) {
      const double nearer_m = 0.00586 + 6e-6 * step + 4e-6 * std::sin(97.0 * double(node) + step);
      if (x(0, node) > 0.02 && std::abs(x(1, node)) > 0.005) x(1, node) -= std::copysign(nearer_m, x(1, node));
    }
    x = Eigen::AngleAxisd(1e-4 * step, Vector3d::UnitZ()).toRotationMatrix() * x;
    x.colwise() += step * Vector3d(0.02, -0.01, 0.005);
    const std::vector<ContactTouch> found = all_the_way.sums(x, untouched).touches;
    const std::vector<ContactTouch> anew = ContactTerm(body).sums(x, untouched).touches;
    ASSERT_EQ(found.size(), anew.size()) << step;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].pair, anew[i].pair) << step;
      EXPECT_EQ(found[i].met.face, anew[i].met.face) << step;
      EXPECT_EQ(found[i].gap_m, anew[i].gap_m) << step;
    }
    touching.push_back(found.size());
  }
  EXPECT_GT(touching.back(), touching.front() + 20);
}

// A strip that is folded right over, its legs 0.2 mm into one another: of what lies in one plane at rest its inner side
// meets itself, its outer side does not, though the strip is thin.
TEST(SelfContact, AFoldedStripTouchesItselfInsideAndNotOutside) {
  constexpr double kThick = 0.001, kHinge = 0.005, kRadius = 0.001, kTurn = 1.8;
  const Body body = [] {
    Body strip(box_mesh({-0.01, -kThick, 0}, {0.01, 0, 0.005}, {4, 1, 1}), kSilicone);
    strip.let_touch_itself();
    return strip;
  }();
  const Eigen::Matrix3Xd& rest_m = body.mesh().nodes_m;
  const auto folded_m = [&](const Vector3d& at_m) {
    const double side = at_m.x() < 0.0 ? -1.0 : 1.0, along_m = std::abs(at_m.x()), radius_m = kRadius - at_m.y();
    const double angle = kTurn * std::min(1.0, along_m / kHinge), leg_m = std::max(0.0, along_m - kHinge);
    return Vector3d(side * (radius_m * std::sin(angle) + leg_m * std::cos(angle)),
                    kRadius - radius_m * std::cos(angle) + leg_m * std::sin(angle), at_m.z());
  };
  Eigen::Matrix3Xd x = rest_m;
  for (Eigen::Index node = 0; node < x.cols(); ++node) x.col(node) = folded_m(rest_m.col(node));
  const ContactTerm term(body);
  int inside = 0, outside = 0;
  for (const ContactTouch& touch : term.sums(x, term.untouched(rest_m, 0.0)).touches) {
    const std::vector<int> nodes = term.skin().pairs().nodes(term.skin().faces_of(touch));
    const auto all_at = [&](double height_m) { return (rest_m(1, nodes).array() - height_m).abs().maxCoeff() < 1e-9; };
    inside += all_at(0.0);
    outside += all_at(-kThick);
  }
  EXPECT_GT(inside, 10);
  EXPECT_EQ(outside, 0);
}

// Its two sides are nearer than a face is wide, and face away from one another.
TEST(SelfContact, TheSidesOfAThinWallDoNotTouch) {
  const auto bent = [](bool touches_itself) {
    Body body(box_mesh({0, 0, 0}, {0.06, 0.001, 0.02}, {8, 1, 3}), kSilicone);
    body.fix_nodes({-1, -1, -1}, {1e-9, 1, 1}, {true, true, true});
    body.set_gravity({0, -9.81, 0});
    if (touches_itself) body.let_touch_itself();
    Simulation simulation(std::move(body), {}, {}, SolverOptions{});
    EXPECT_TRUE(simulation.solve_equilibrium().converged);
    if (touches_itself) {
      EXPECT_EQ(simulation.contacts().back().area_m2, 0.0);
    }
    return simulation.state().positions_m;
  };
  EXPECT_TRUE(bent(true) == bent(false));
}

TEST(SelfContact, ARestoredStateGoesOnAsIfItHadNeverStopped) {
  Simulation one = pressed_clip({12, 14, 1}, 1000.0), other = pressed_clip({12, 14, 1}, 1000.0);
  int touching = 0;
  for (int i = 0; i < 12; ++i) {
    one.step();
    if (one.contacts().back().area_m2 > 0.0) ++touching;
  }
  EXPECT_GT(touching, 0);
  other.set_state(one.state());
  for (int i = 0; i < 4; ++i) {
    one.step();
    other.step();
  }
  EXPECT_TRUE(one.state() == other.state());
}

// The slot of R9, wider, as few elements have it.
TEST(SelfContact, WithXpbdASlotIsPressedShutAsWithNewton) {
  Simulation newton = pressed_slot(4000.0, {12, 4, 2}), local = pressed_slot(4000.0, {12, 4, 2}, xpbd(160));
  for (Simulation* simulation : {&newton, &local}) {
    const SolveReport report = simulation->solve_equilibrium();
    EXPECT_TRUE(report.converged) << report.message;
  }
  const Eigen::Matrix3Xd &expected_m = newton.state().positions_m, &found_m = local.state().positions_m;
  const double way_m = (expected_m - newton.body().mesh().nodes_m).colwise().norm().maxCoeff();
  EXPECT_GT(way_m, 0.003);
  EXPECT_LT((found_m - expected_m).colwise().norm().maxCoeff(), 0.01 * way_m);
  const double push_n = newton.contacts().back().normal_force_n;
  EXPECT_GT(push_n, 0.1);
  EXPECT_NEAR(local.contacts().back().normal_force_n, push_n, 0.01 * push_n);
}

}  // namespace
}  // namespace soft_robot_lab
