// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <sstream>

#include "cable_experiments.h"
#include "marker_line.h"
#include "control/identification/simulated_now.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

const char* const kTiltedTo = "tilted to +y";
const char* const kTiltedFrom = "tilted to -y";

struct OrderRobot {
  std::string name, scene;
  double contraction = 1.0;
  std::vector<std::string> shape;
};

struct OrderSettings {
  std::vector<OrderRobot> robots;
  double gravity_m_s2 = 0.0;
  int stages = 1;         // of each pull, for equilibria
  double settle_s = 0.0;  // after each pull, for dynamics
  double tilt = 0.0;      // of gravity in y
};

// Which cables (of two) are pulled, one entry after the other.
struct Order {
  std::string name;
  std::vector<std::vector<int>> pulls;
};
const std::vector<Order> kOrders = {{"left first", {{0}, {1}}}, {"right first", {{1}, {0}}}, {"together", {{0, 1}}}};

struct OrderRun {
  std::string order, way;
  Eigen::Vector3d tip_m;
  std::vector<double> tensions_n;
  Series from_front, from_side;
  std::string trouble;  // empty where all went well
};

OrderRobot read_robot(const YamlNode& node, const ExperimentContext& context) {
  OrderRobot robot;
  robot.name = node.text("name");
  robot.scene = context.config_folder + "/" + node.text("scene");
  robot.contraction = node.number("contraction", AllowedRange::positive());
  for (const YamlNode& marker : node.sequence("shape")) robot.shape.push_back(marker.as_text());
  return robot;
}

OrderSettings read_order_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("6.3.3"));
  OrderSettings settings;
  for (const YamlNode& robot : node.sequence("robots")) settings.robots.push_back(read_robot(robot, context));
  settings.gravity_m_s2 = node.number("gravity_m_s2", AllowedRange::not_negative());
  settings.stages = static_cast<int>(node.number("stages", AllowedRange::positive()));
  settings.settle_s = node.number("settle_s", AllowedRange::not_negative());
  settings.tilt = node.number("tilt", AllowedRange::positive());
  if (settings.robots.empty()) node.fail("robots is empty");
  node.require_all_read();
  return settings;
}

void set(Simulation& simulation, const std::vector<int>& cables, double contraction) {
  for (const int cable : cables)
    simulation.set_command(simulation.actuators().at(static_cast<size_t>(cable))->name(), contraction);
}

// In small stages, each a rest state reached from the one before.
std::string pull_quasi_statically(Simulation& simulation, const OrderSettings& settings, const Order& order,
                                  double contraction) {
  for (const std::vector<int>& cables : order.pulls) {
    for (int stage = 1; stage <= settings.stages; ++stage) {
      set(simulation, cables, 1.0 - (1.0 - contraction) * stage / settings.stages);
      const SolveReport solve = simulation.solve_equilibrium();
      if (!solve.converged) return solve.message;
    }
  }
  return "";
}

// At the drives' speed, and on until they have rested for `settle_s`.
std::string pull_in_time(Simulation& simulation, const OrderSettings& settings, const Order& order,
                         double contraction) {
  for (const std::vector<int>& cables : order.pulls) {
    set(simulation, cables, contraction);
    for (double rested_s = 0.0; rested_s < settings.settle_s;) {
      const SolveReport solve = simulation.step();
      if (!solve.converged) return solve.message;
      rested_s = all_arrived(simulation) ? rested_s + simulation.options().time_step_s : 0.0;
    }
  }
  return "";
}

OrderRun observe(const Simulation& simulation, const OrderRobot& robot, const Order& order, const std::string& way) {
  OrderRun run;
  run.order = order.name;
  run.way = way;
  run.tip_m = simulation.marker_position(simulation.marker_index(kTip));
  for (int i = 0; i < 2; ++i) run.tensions_n.push_back(simulation.actuator_state(i).tension_n.value_or(0.0));
  run.from_front = marker_line(simulation, robot.shape, order.name + ", " + way, 0);
  run.from_side = marker_line(simulation, robot.shape, order.name + ", " + way, 1);
  if (way == "dynamics") run.from_front.style = run.from_side.style = SeriesStyle::dashes_points;
  return run;
}

Scene load(const ExperimentContext& context, const OrderSettings& settings, const OrderRobot& robot, double tilt) {
  const Eigen::Vector3d gravity_m_s2(0.0, settings.gravity_m_s2 * tilt, -settings.gravity_m_s2);
  return load_scene(robot.scene, context.scene_options(Overrides().set({"gravity_m_s2"}, gravity_m_s2)));
}

// Pulled while tilted, then put level again: the rest state that it keeps.
OrderRun run_tilted(const ExperimentContext& context, const OrderSettings& settings, const OrderRobot& robot,
                    double tilt) {
  const Scene tilted = load(context, settings, robot, tilt), level = load(context, settings, robot, 0.0);
  const Order& order = kOrders.back();
  tilted.simulation->solve_equilibrium();
  std::string trouble = pull_quasi_statically(*tilted.simulation, settings, order, robot.contraction);
  set(*level.simulation, {0, 1}, robot.contraction);
  level.simulation->set_state(tilted.simulation->state());
  const SolveReport solve = level.simulation->solve_equilibrium();
  if (trouble.empty() && !solve.converged) trouble = solve.message;
  OrderRun run = observe(*level.simulation, robot, order, tilt > 0.0 ? kTiltedTo : kTiltedFrom);
  run.trouble = trouble;
  return run;
}

std::vector<OrderRun> run_orders(const ExperimentContext& context, const OrderSettings& settings,
                                 const OrderRobot& robot) {
  const Scene scene = load(context, settings, robot, 0.0);
  Simulation& simulation = *scene.simulation;
  simulation.solve_equilibrium();
  const SimulationState hanging = simulation.state();
  std::vector<OrderRun> runs;
  const double count = 2.0 * double(kOrders.size() + 1);
  for (const std::string way : {"equilibria", "dynamics"}) {
    for (const Order& order : kOrders) {
      context.report(double(runs.size()) / count, robot.name + ", " + order.name + ", " + way);
      simulation.set_state(hanging);
      set(simulation, {0, 1}, 1.0);
      const auto& pull = way == "dynamics" ? pull_in_time : pull_quasi_statically;
      const std::string trouble = pull(simulation, settings, order, robot.contraction);
      runs.push_back(observe(simulation, robot, order, way));
      runs.back().trouble = trouble;
    }
  }
  for (const double tilt : {settings.tilt, -settings.tilt}) runs.push_back(run_tilted(context, settings, robot, tilt));
  return runs;
}

Plot shape_plot(const OrderRobot& robot, const std::vector<OrderRun>& runs, bool front) {
  std::ostringstream title;
  title << robot.name << " pulled to " << robot.contraction << " on both sides, from the "
        << (front ? "front" : "side");
  Plot plot{"6.3.3_" + robot.name + (front ? "_front" : "_side"), title.str(), {}, {}, {}};
  plot.x.label = front ? "x [mm]" : "y [mm]";
  plot.y.label = "z [mm]";
  for (const OrderRun& run : runs) plot.series.push_back(front ? run.from_front : run.from_side);
  return plot;
}

const OrderRun& find(const std::vector<OrderRun>& runs, const std::string& way, const std::string& order) {
  return *std::find_if(runs.begin(), runs.end(),
                       [&](const OrderRun& run) { return run.way == way && run.order == order; });
}

// Distance between the tips of "left first" and "right first".
double apart_m(const std::vector<OrderRun>& runs, const std::string& way) {
  return (find(runs, way, kOrders[0].name).tip_m - find(runs, way, kOrders[1].name).tip_m).norm();
}

// The same, one of them mirrored to the other side.
double mirrored_apart_m(const std::vector<OrderRun>& runs, const std::string& way) {
  const Eigen::Vector3d mirror(-1, 1, 1);
  return (find(runs, way, kOrders[0].name).tip_m - find(runs, way, kOrders[1].name).tip_m.cwiseProduct(mirror)).norm();
}

std::string words(const OrderRobot& robot, const std::vector<OrderRun>& runs) {
  std::ostringstream text;
  text.precision(3);
  text << robot.name << " at " << robot.contraction << ": ";
  for (const std::string way : {"equilibria", "dynamics"}) {
    const Eigen::Vector3d left_mm = 1e3 * find(runs, way, kOrders[0].name).tip_m;
    const Eigen::Vector3d right_mm = 1e3 * find(runs, way, kOrders[1].name).tip_m;
    text << "by " << way << " the tip rests at x = " << left_mm.x() << ", y = " << left_mm.y()
         << " mm left first and at x = " << right_mm.x() << ", y = " << right_mm.y() << " mm right first, "
         << 1e3 * apart_m(runs, way) << " mm apart, and " << 1e3 * mirrored_apart_m(runs, way)
         << " mm from each other's mirror image; ";
  }
  text << "tilted forwards or backwards while pulled, and then level again, it rests at y = "
       << 1e3 * find(runs, kTiltedTo, kOrders.back().name).tip_m.y() << " and "
       << 1e3 * find(runs, kTiltedFrom, kOrders.back().name).tip_m.y() << " mm. ";
  return text.str();
}

void add_robot(const OrderRobot& robot, const std::vector<OrderRun>& runs, ExperimentResult& result) {
  for (const OrderRun& run : runs) {
    result.table.rows.push_back({robot.name, robot.contraction, run.way, run.order, 1e3 * run.tip_m.x(),
                                 1e3 * run.tip_m.y(), 1e3 * run.tip_m.z(), run.tensions_n[0], run.tensions_n[1]});
    if (run.trouble.empty()) continue;
    result.converged = false;
    result.message = robot.name + ", " + run.way + ", " + run.order + ": " + run.trouble;
  }
  auto& numbers = result.numbers[robot.name];
  numbers["contraction"] = robot.contraction;
  for (const std::string way : {"equilibria", "dynamics"}) {
    numbers["apart_m"][way] = apart_m(runs, way);
    numbers["mirrored_apart_m"][way] = mirrored_apart_m(runs, way);
    for (const Order& order : kOrders) {
      const Eigen::Vector3d tip_m = find(runs, way, order.name).tip_m;
      numbers["tip_m"][way][order.name] = {tip_m.x(), tip_m.y(), tip_m.z()};
    }
  }
  for (const std::string way : {kTiltedTo, kTiltedFrom})
    numbers["branch_y_m"][way] = find(runs, way, kOrders.back().name).tip_m.y();
  for (const bool front : {true, false}) result.plots.push_back(shape_plot(robot, runs, front));
  result.we_find += words(robot, runs);
}

}  // namespace

ExperimentResult run_pull_order_experiment(const ExperimentContext& context) {
  const OrderSettings settings = read_order_settings(context);
  ExperimentResult result;
  result.title = "Order of pulling two cables: Spinebot and Hammerbot";
  result.table.columns = {{"robot"},         {"contraction"}, {"found by"},    {"order"},       {"tip x [mm]", 3},
                          {"tip y [mm]", 3}, {"tip z [mm]"},  {"left [N]", 3}, {"right [N]", 3}};
  for (const OrderRobot& robot : settings.robots) add_robot(robot, run_orders(context, settings, robot), result);
  result.we_find +=
      "A body without friction remembers an order only where it has several rest states to choose from; where it has, "
      "an "
      "imperfection chooses as well as an order does.";
  result.source_reports =
      "One cable is pulled, the robot comes to rest, and the other is pulled, to 0.8 on Spinebot and to 0.75 on "
      "Hammerbot. "
      "Spinebot ends as a skewed S, mirrored by the order; Hammerbot bends out of the cables' plane, forwards or "
      "backwards by the order, and differs more. No distances are given.";
  result.we_differ =
      "Both robots' dimensions but the cables' length are ours; besides steps in time at the drives' speed, as the "
      "source's, each order is also followed through rest states in small stages, and both cables are pulled at once "
      "with "
      "gravity tilted by a hundredth, to find branches.";
  return result;
}

}  // namespace soft_robot_lab
