#include <algorithm>
#include <cmath>
#include <sstream>

#include "experiment/cable_experiments.h"
#include "experiment/marker_line.h"
#include "soft_robot_lab/scene/scene.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {
namespace {

const char* const kTip = "tip";
const char* const kTiltedTo = "tilted to +y";
const char* const kTiltedFrom = "tilted to -y";

struct OrderSettings {
  std::string robot;
  std::vector<double> contractions;
  int stages = 1;         // of each pull, for equilibria
  double settle_s = 0.0;  // after each pull, for dynamics
  double tilt = 0.0;      // of gravity in y
  std::vector<std::string> shape;
};

// Which cables (of two) are pulled, one entry after the other.
struct Order {
  std::string name;
  std::vector<std::vector<int>> pulls;
};
const std::vector<Order> kOrders = {{"left first", {{0}, {1}}}, {"right first", {{1}, {0}}}, {"together", {{0, 1}}}};

struct OrderRun {
  std::string order, way;
  double contraction = 1.0;
  Eigen::Vector3d tip_m;
  std::vector<double> tensions_n;
  Series line;
  std::string trouble;  // empty where all went well
};

OrderSettings read_settings(const ExperimentContext& context) {
  const SettingsNode node = SettingsNode::load_file(context.settings_file("6.3.3"));
  OrderSettings settings;
  settings.robot = context.config_folder + "/" + node.text("robot");
  for (const SettingsNode& c : node.sequence("contractions"))
    settings.contractions.push_back(c.as_number(AllowedRange::positive()));
  settings.stages = static_cast<int>(node.number("stages", AllowedRange::positive()));
  settings.settle_s = node.number("settle_s", AllowedRange::not_negative());
  settings.tilt = node.number("tilt", AllowedRange::positive());
  for (const SettingsNode& marker : node.sequence("shape")) settings.shape.push_back(marker.as_text());
  if (settings.contractions.empty()) node.fail("contractions is empty");
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

bool drives_rest(const Simulation& simulation) {
  for (size_t i = 0; i < simulation.actuators().size(); ++i) {
    const ActuatorReading cable = simulation.actuator_state(static_cast<int>(i));
    if (std::abs(cable.actuated_command - cable.command) > 1e-9) return false;
  }
  return true;
}

// At the drives' speed, and on until they have rested for `settle_s`.
std::string pull_in_time(Simulation& simulation, const OrderSettings& settings, const Order& order,
                         double contraction) {
  for (const std::vector<int>& cables : order.pulls) {
    set(simulation, cables, contraction);
    for (double rested_s = 0.0; rested_s < settings.settle_s;) {
      const SolveReport solve = simulation.step();
      if (!solve.converged) return solve.message;
      rested_s = drives_rest(simulation) ? rested_s + simulation.options().time_step_s : 0.0;
    }
  }
  return "";
}

OrderRun observe(const Simulation& simulation, const OrderSettings& settings, const Order& order,
                 const std::string& way, double contraction) {
  OrderRun run;
  run.order = order.name;
  run.way = way;
  run.contraction = contraction;
  run.tip_m = simulation.marker_position(simulation.marker_index(kTip));
  for (int i = 0; i < 2; ++i) run.tensions_n.push_back(simulation.actuator_state(i).tension_n.value_or(0.0));
  run.line = marker_line(simulation, settings.shape, order.name + ", " + way, 1);
  if (way == "dynamics") run.line.style = SeriesStyle::dashes_points;
  return run;
}

Scene load(const ExperimentContext& context, const OrderSettings& settings, double tilt) {
  std::ostringstream gravity;
  gravity << "gravity_m_s2: [0, " << 9.81 * tilt << ", -9.81]\n";
  return load_scene(settings.robot, context.scene_options(gravity.str()));
}

// Pulled while tilted, then put level again: the rest state that it keeps.
OrderRun run_tilted(const ExperimentContext& context, const OrderSettings& settings, double tilt, double contraction) {
  const Scene tilted = load(context, settings, tilt), level = load(context, settings, 0.0);
  const Order& order = kOrders.back();
  tilted.simulation->solve_equilibrium();
  std::string trouble = pull_quasi_statically(*tilted.simulation, settings, order, contraction);
  set(*level.simulation, {0, 1}, contraction);
  level.simulation->set_state(tilted.simulation->state());
  const SolveReport solve = level.simulation->solve_equilibrium();
  if (trouble.empty() && !solve.converged) trouble = solve.message;
  OrderRun run = observe(*level.simulation, settings, order, tilt > 0.0 ? kTiltedTo : kTiltedFrom, contraction);
  run.trouble = trouble;
  return run;
}

std::vector<OrderRun> run_orders(const ExperimentContext& context, const OrderSettings& settings) {
  const Scene scene = load(context, settings, 0.0);
  Simulation& simulation = *scene.simulation;
  simulation.solve_equilibrium();
  const SimulationState hanging = simulation.state();
  std::vector<OrderRun> runs;
  const double count = 2.0 * double(settings.contractions.size() * (kOrders.size() + 1));
  for (const double contraction : settings.contractions) {
    for (const std::string way : {"equilibria", "dynamics"}) {
      for (const Order& order : kOrders) {
        context.tell(double(runs.size()) / count, order.name + ", " + way);
        simulation.set_state(hanging);
        set(simulation, {0, 1}, 1.0);
        const auto& pull = way == "dynamics" ? pull_in_time : pull_quasi_statically;
        const std::string trouble = pull(simulation, settings, order, contraction);
        runs.push_back(observe(simulation, settings, order, way, contraction));
        runs.back().trouble = trouble;
      }
    }
    for (const double tilt : {settings.tilt, -settings.tilt})
      runs.push_back(run_tilted(context, settings, tilt, contraction));
  }
  return runs;
}

Plot shape_plot(const std::vector<OrderRun>& runs, double contraction) {
  std::ostringstream percent;
  percent << 100.0 * contraction;
  Plot plot{
      "6.3.3_" + percent.str(), "Hammerbot pulled to " + percent.str() + " % on both sides, from the side", {}, {}, {}};
  plot.x.label = "y [mm]";
  plot.y.label = "z [mm]";
  for (const OrderRun& run : runs)
    if (run.contraction == contraction) plot.series.push_back(run.line);
  return plot;
}

const OrderRun& find(const std::vector<OrderRun>& runs, double contraction, const std::string& way,
                     const std::string& order) {
  return *std::find_if(runs.begin(), runs.end(), [&](const OrderRun& run) {
    return run.contraction == contraction && run.way == way && run.order == order;
  });
}

// Distance between the tips of "left first" and "right first".
double apart_m(const std::vector<OrderRun>& runs, double contraction, const std::string& way) {
  return (find(runs, contraction, way, kOrders[0].name).tip_m - find(runs, contraction, way, kOrders[1].name).tip_m)
      .norm();
}

std::string words(const OrderSettings& settings, const std::vector<OrderRun>& runs) {
  std::ostringstream text;
  text.precision(3);
  for (const double contraction : settings.contractions) {
    const Eigen::Vector3d there_m = find(runs, contraction, kTiltedTo, kOrders.back().name).tip_m;
    const Eigen::Vector3d here_m = find(runs, contraction, kTiltedFrom, kOrders.back().name).tip_m;
    text << "At " << contraction << " the tips after pulling left first and right first lie "
         << 1e3 * apart_m(runs, contraction, "equilibria") << " mm apart by equilibria and "
         << 1e3 * apart_m(runs, contraction, "dynamics")
         << " mm by dynamics; tilted one way or the other while pulled, and then level again, the tip rests at y = "
         << 1e3 * there_m.y() << " and " << 1e3 * here_m.y() << " mm. ";
  }
  text << "The model buckles across the plane of its cables, so where the order makes no difference, an imperfection "
          "chooses the branch; our dimensions are chosen, the source's robot may buckle in the plane.";
  return text.str();
}

}  // namespace

ExperimentResult run_pull_order_experiment(const ExperimentContext& context) {
  const OrderSettings settings = read_settings(context);
  const std::vector<OrderRun> runs = run_orders(context, settings);
  ExperimentResult result;
  result.title = "Order of pulling Hammerbot's two cables";
  result.table.columns = {{"contraction"},   {"found by"},   {"order"},       {"tip x [mm]"},
                          {"tip y [mm]", 2}, {"tip z [mm]"}, {"left [N]", 3}, {"right [N]", 3}};
  for (const OrderRun& run : runs) {
    result.table.rows.push_back({run.contraction, run.way, run.order, 1e3 * run.tip_m.x(), 1e3 * run.tip_m.y(),
                                 1e3 * run.tip_m.z(), run.tensions_n[0], run.tensions_n[1]});
    if (run.trouble.empty()) continue;
    result.converged = false;
    result.message = run.way + ", " + run.order + ": " + run.trouble;
  }
  for (const double contraction : settings.contractions) {
    result.plots.push_back(shape_plot(runs, contraction));
    std::ostringstream key;
    key << contraction;
    for (const std::string way : {"equilibria", "dynamics"})
      result.numbers["apart_m"][way][key.str()] = apart_m(runs, contraction, way);
    for (const std::string way : {kTiltedTo, kTiltedFrom})
      result.numbers["branch_y_m"][way][key.str()] = find(runs, contraction, way, kOrders.back().name).tip_m.y();
  }
  result.source_reports =
      "The source pulls to 0.8 / 0.8 and to 0.75 / 0.75 and reports that the final shape depends on the order, because "
      "the body buckles. No number of it is known here.";
  result.we_find = words(settings, runs);
  return result;
}

}  // namespace soft_robot_lab
