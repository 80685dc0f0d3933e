// SPDX-License-Identifier: BSD-3-Clause
// What the chart of stability shows: bodies, methods, hard cases.
#include "stability_starts.h"
#include "stability.h"

namespace soft_robot_lab {
namespace {

using Start = std::function<void(const Body&, Eigen::Matrix3Xd&)>;

constexpr double kSlowDuration_s = 0.6;  // of methods that take most of the chart's time; drives arrive in 0.5 s

HardCase moderate(const std::string& name) {
  HardCase hard_case;
  hard_case.name = name;
  hard_case.contractions = {0.9};
  hard_case.betas = {1.3};
  return hard_case;
}

HardCase with_poissons_ratio(const std::string& ratio) {
  HardCase hard_case = moderate("Poisson's ratio " + ratio);
  hard_case.overrides.set({"body", "material", "poissons_ratio"}, std::stod(ratio));
  return hard_case;
}

HardCase with_time_step(const std::string& step) {
  HardCase hard_case = moderate("time step " + step + " s");
  hard_case.overrides.set({"solver", "time_step_s"}, std::stod(step));
  return hard_case;
}

HardCase with_compliance(const std::string& compliance) {
  HardCase hard_case = moderate("compliance " + compliance + " m/N");
  hard_case.betas.clear();
  hard_case.drive_changes.set({"compliance_m_n"}, std::stod(compliance));
  return hard_case;
}

// So far that bodies buckle, one way or another.
HardCase pulled_at_once(const std::string& name, const std::vector<double>& contractions, double compliance_m_n) {
  HardCase hard_case;
  hard_case.name = name;
  hard_case.contractions = contractions;
  hard_case.drive_changes.set({"pull_speed_m_s"}, 0).set({"min_contraction"}, 0.5);
  hard_case.drive_changes.set({"compliance_m_n"}, compliance_m_n);
  hard_case.unique = false;
  return hard_case;
}

HardCase filled_at_once(const std::string& name, double element_size_m) {
  HardCase hard_case;
  hard_case.name = name;
  hard_case.betas = {5.0};
  hard_case.overrides.set({"body", "element_size_m"}, element_size_m);
  hard_case.unique = false;
  return hard_case;
}

HardCase with_slivers(const std::string& height) {
  HardCase hard_case = moderate("slivers, height " + height);
  const double fraction = std::stod(height);
  hard_case.change_mesh = [fraction](TetMesh& mesh) { add_slivers(mesh, fraction, 10); };
  return hard_case;
}

// Bodies whose parts have passed through one another may come to rest so: skin does not touch skin here.
HardCase from(const std::string& name, const Start& start, bool driven) {
  HardCase hard_case = moderate(name);
  if (!driven) hard_case.contractions = hard_case.betas = {1.0};
  hard_case.start_from = start;
  hard_case.unique = false;
  return hard_case;
}

using Motion = std::vector<std::pair<double, double>>;  // time [s], way along y [m]

// Of one obstacle.
Overrides obstacle(const std::string& shape, const Overrides& sizes, const Motion& motion) {
  Overrides one;
  one.set({"name"}, "obstacle").set({shape}, sizes);
  std::vector<OverrideValue> poses;
  for (const auto& [time_s, way_m] : motion)
    poses.emplace_back(Overrides().set({"time_s"}, time_s).set({"translation_m"}, Eigen::Vector3d(0.0, way_m, 0.0)));
  if (!poses.empty()) one.set({"motion"}, poses);
  return Overrides().set({"contact", "obstacles"}, std::vector<OverrideValue>{one}).set({"contact", "friction"}, 0.3);
}

constexpr double kBall_m = 0.012;  // radius

// It stands before the body and moves into it.
HardCase with_ball(const std::string& name, double before_m, double into_m, double duration_s) {
  HardCase hard_case = moderate(name);
  hard_case.unique = false;
  hard_case.touches = [=](const StabilityBody& body) {
    const Eigen::Vector3d at_m = body.middle_m - (body.half_depth_m + kBall_m + before_m) * Eigen::Vector3d::UnitY();
    return obstacle("sphere", Overrides().set({"center_m"}, at_m).set({"radius_m"}, kBall_m),
                    {{0.0, 0.0}, {duration_s, before_m + into_m}});
  };
  return hard_case;
}

// Just behind the body.
Overrides wall(const StabilityBody& body) {
  const Eigen::Vector3d at_m(0.0, -body.half_depth_m - 0.0005, 0.0);
  return obstacle("plane", Overrides().set({"point_m"}, at_m).set({"normal"}, Eigen::Vector3d(0, 1, 0)), {});
}

HardCase with_wall(HardCase hard_case) {
  hard_case.name += ", at a wall";
  hard_case.touches = wall;
  return hard_case;
}

HardCase dropped_on_wall() {
  HardCase hard_case = moderate("dropped on a wall by 3 g");
  hard_case.overrides.set({"gravity_m_s2"}, Eigen::Vector3d(0, -29.43, 0));
  hard_case.touches = wall;
  hard_case.unique = false;
  return hard_case;
}

}  // namespace

std::vector<StabilityBody> stability_bodies(bool quick) {
  Overrides coarse;
  if (quick) coarse.set({"body", "element_size_m"}, 0.03);
  return {{"cantilever", "scenes/cantilever_cables.yaml", coarse, false, {0.09, 0, 0}, 0.01},
          // Pulled to its half, elements of 30 mm turn over.
          {"Hammerbot", "robots/hammerbot/robot.yaml", {}, false, {0, 0, -0.0925}, 0.01},
          {"Spinebot", "robots/spinebot/robot.yaml", {}, false, {0, 0, -0.0805}, 0.008},
          {"cuboid", "scenes/hollow_cuboid.yaml", coarse, true, {0, 0, 0}, 0.015}};
}

std::vector<StabilityMethod> stability_methods(bool quick) {
  const Overrides linear = Overrides().set({"body", "element"}, "linear");
  const Overrides bdf2 = Overrides().set({"solver", "integrator"}, "bdf2");
  const Overrides substeps = Overrides().set({"solver", "method"}, "xpbd").set({"solver", "substeps"}, 50);
  const Overrides explicit_cables = Overrides().set({"model"}, "explicit");
  const std::vector<StabilityMethod> ours = {{"newton, equilibrium", {}, {}, true, true},
                                             {"newton, in time", {}, {}, false, true},
                                             {"newton, in time, bdf2", {}, bdf2, false, true}};
  if (quick) return ours;
  return {ours[0],
          ours[1],
          ours[2],
          {"newton, linear elements", linear, {}, false, false, {}, {}, 2.0, 20.0},
          {"xpbd", {}, substeps, false, false, {}, {}, kSlowDuration_s, 15.0, true},
          {"xpbd, linear", linear, substeps, false, false, {}, {}, kSlowDuration_s, 10.0, true},
          {"explicit coupling", {}, {}, false, false, {}, explicit_cables, kSlowDuration_s, 6.0}};
}

std::vector<HardCase> hard_cases(bool quick) {
  using Names = std::vector<const char*>;
  std::vector<HardCase> cases;
  for (const char* ratio : quick ? Names{"0.499999"} : Names{"0.45", "0.499", "0.4999", "0.499999"})
    cases.push_back(with_poissons_ratio(ratio));
  for (const char* step : quick ? Names{"1"} : Names{"0.001", "0.01", "0.1", "1"})
    cases.push_back(with_time_step(step));
  for (const char* compliance : quick ? Names{"0"} : Names{"1.0e-2", "1.0e-3", "1.0e-4", "0"})
    cases.push_back(with_compliance(compliance));
  cases.push_back(pulled_at_once("contraction 1 to 0.5 at once", {0.5}, 1.0e-5));
  if (!quick) cases.push_back(pulled_at_once("the same, rigid cable", {0.5}, 0.0));
  cases.push_back(pulled_at_once("the same, both cables", {0.5, 0.5}, 1.0e-5));
  cases.push_back(filled_at_once("beta 1 to 5 at once, coarse", 0.03));
  if (!quick) cases.push_back(filled_at_once("beta 1 to 5 at once, fine", 0.0075));
  for (const char* height : quick ? Names{"1.0e-3"} : Names{"1.0e-2", "1.0e-4"}) cases.push_back(with_slivers(height));
  cases.push_back(from("scrambled nodes, driven", scramble, true));
  if (!quick) {
    cases.push_back(from("scrambled nodes", scramble, false));
    cases.push_back(from("collapsed to a plane", collapse_to_plane, false));
    cases.push_back(from("collapsed to a line", collapse_to_line, false));
    cases.push_back(from("collapsed to a point", collapse_to_point, false));
  }
  cases.push_back(from("collapsed to a point, driven", collapse_to_point, true));
  cases.push_back(from("turned inside out", mirror, false));
  cases.push_back(from("cable spans of no length", collapse_spans, true));
  cases.back().betas.clear();
  cases.push_back(with_ball("pressed by a ball, 8 mm", 0.001, 0.008, 0.5));
  cases.push_back(with_ball("hit by a ball at 3 m/s", 0.042, 0.008, 0.0167));
  cases.push_back(dropped_on_wall());
  cases.push_back(with_wall(from("scrambled nodes", scramble, false)));
  if (!quick) cases.push_back(with_wall(from("collapsed to a point", collapse_to_point, false)));
  return cases;
}

}  // namespace soft_robot_lab
