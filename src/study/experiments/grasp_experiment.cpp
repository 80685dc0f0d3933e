// SPDX-License-Identifier: BSD-3-Clause
#include "grasp_experiment.h"

#include <sstream>

#include "grasp.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct GraspSettings {
  GraspTask task;
  double friction = 0.0, duration_s = 0.0;  // of the run that holds
  std::vector<double> of_the_least;         // frictions of the short runs, over the least that holds
  double short_s = 0.0;
};

GraspSettings read_grasp_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("grasp"));
  GraspSettings settings;
  GraspTask& task = settings.task;
  task.scene = context.config_folder + "/" + node.text("scene");
  task.contraction = node.number("contraction", AllowedRange::positive());
  task.lift_m = node.number("lift_m", AllowedRange::positive());
  task.amplitude_m = node.number("amplitude_m", AllowedRange::positive());
  task.frequency_hz = node.number("frequency_hz", AllowedRange::positive());
  task.time_step_s = node.number("time_step_s", AllowedRange::positive());
  settings.friction = node.number("friction", AllowedRange::positive());
  settings.duration_s = node.number("duration_s", AllowedRange::positive());
  settings.short_s = node.number("short_s", AllowedRange::positive());
  for (const YamlNode& item : node.sequence("of_the_least"))
    settings.of_the_least.push_back(item.as_number(AllowedRange::positive()));
  node.require_all_read();
  return settings;
}

struct GraspRuns {
  GraspSettings settings;
  LiftedBall lifted;
  std::vector<ShakenBall> balls;  // the first one is held for the whole duration

  // By N while the first one is shaken: the shaken fingers press now more, now less.
  double least_friction() const { return balls.front().least_friction; }
  bool should_hold(const ShakenBall& ball) const { return ball.friction > least_friction(); }
};

GraspRuns shake_all(const ExperimentContext& context, const GraspSettings& settings) {
  GraspRuns runs{settings, {}, {}};
  context.report(0.0, "closes and lifts");
  runs.lifted = lift_ball(context, settings.task, settings.friction);
  if (!runs.lifted.converged) return runs;
  const double all_s = static_cast<double>(settings.of_the_least.size()) * settings.short_s + settings.duration_s;
  double done_s = 0.0;
  const auto add = [&](double friction, double shaken_s) {
    std::ostringstream what;
    what << "friction " << friction;
    context.report(done_s / all_s, what.str());
    runs.balls.push_back(shake_ball(context, settings.task, runs.lifted, friction, shaken_s));
    done_s += shaken_s;
  };
  add(settings.friction, settings.duration_s);
  for (const double factor : settings.of_the_least) add(factor * runs.least_friction(), settings.short_s);
  return runs;
}

Table table_of(const GraspRuns& runs) {
  Table table{{{"friction", 3},
               {"of the least by 2 mu N > m (g + a)", 3},
               {"shaken [s]"},
               {"so it"},
               {"and it"},
               {"least N [N]", 3},
               {"moved in the hand [um]", 3},
               {"slip [um]", 3},
               {"drift [um]", 3}},
              {}};
  for (const ShakenBall& ball : runs.balls)
    table.rows.push_back({ball.friction, ball.friction / runs.least_friction(), ball.shaken_s,
                          runs.should_hold(ball) ? "holds" : "drops", ball.held ? "holds" : "drops",
                          0.5 * ball.least_squeeze_n, ball.held ? TableCell(1e6 * ball.moved_m) : TableCell(""),
                          ball.held ? TableCell(1e6 * ball.slip_m) : TableCell(""),
                          ball.held ? TableCell(1e6 * ball.drift_m) : TableCell("")});
  return table;
}

Plot way_plot(const GraspRuns& runs) {
  Plot plot{"grasp", "The ball in the hand that shakes it", {"time [s]"}, {"way in the hand [mm]"}};
  plot.y.max = 1.0;
  for (const ShakenBall& ball : runs.balls) {
    std::ostringstream label;
    label.precision(3);
    label << "friction " << ball.friction;
    Series series{label.str(), {}, {}, SeriesStyle::lines};
    for (std::size_t i = 0; i < ball.time_s.size() && ball.time_s[i] - ball.time_s[0] < runs.settings.short_s; ++i) {
      series.x.push_back(ball.time_s[i] - ball.time_s[0]);
      series.y.push_back(1e3 * ball.way_m[i]);
    }
    plot.series.push_back(series);
  }
  return plot;
}

nlohmann::ordered_json numbers_of(const GraspRuns& runs) {
  nlohmann::ordered_json balls = nlohmann::ordered_json::array();
  for (const ShakenBall& ball : runs.balls)
    balls.push_back({{"friction", ball.friction},
                     {"shaken_s", ball.shaken_s},
                     {"should_hold", runs.should_hold(ball)},
                     {"held", ball.held},
                     {"least_squeeze_n", ball.least_squeeze_n},
                     {"moved_m", ball.moved_m},
                     {"slip_m", ball.slip_m},
                     {"drift_m", ball.drift_m}});
  return {{"squeeze_n", runs.lifted.squeeze_n},
          {"acceleration_m_s2", runs.settings.task.acceleration_m_s2()},
          {"least_friction", runs.least_friction()},
          {"least_friction_by_rest", runs.lifted.least_friction(runs.settings.task.acceleration_m_s2())},
          {"runs", balls}};
}

std::string words_for(const GraspRuns& runs) {
  const ShakenBall& held = runs.balls.front();
  long agree = 0;
  for (const ShakenBall& ball : runs.balls) agree += ball.held == runs.should_hold(ball);
  std::ostringstream words;
  words.precision(3);
  words << "Each finger presses with N = " << 0.5 * runs.lifted.squeeze_n << " N at rest, so that friction above "
        << runs.lifted.least_friction(runs.settings.task.acceleration_m_s2())
        << " should hold; by N while it is shaken, above " << runs.least_friction() << ". It does in " << agree
        << " of " << runs.balls.size() << " runs as 2 mu N > m (g + a) says. With friction " << held.friction
        << " the ball is " << (held.held ? "held" : "dropped") << " within " << held.shaken_s << " s of shaking by "
        << runs.settings.task.acceleration_m_s2() << " m/s^2.";
  if (held.held)
    words << " At rest it then stands " << 1e6 * held.moved_m
          << " um from where it stood in the hand, the skin has slipped " << 1e6 * held.slip_m
          << " um along it, and from period to period it drifts by no more than " << 1e6 * held.drift_m << " um.";
  return words.str();
}

}  // namespace

ExperimentResult run_grasp_experiment(const ExperimentContext& context) {
  const GraspRuns runs = shake_all(context, read_grasp_settings(context));
  ExperimentResult result;
  result.title = "A ball in the gripper's hand, shaken";
  if (!runs.lifted.converged) {
    result.converged = false;
    result.message = "a step of the lift found no solution";
    return result;
  }
  for (const ShakenBall& ball : runs.balls) {
    if (ball.converged) continue;
    result.converged = false;
    result.message = "a step found no solution at friction " + std::to_string(ball.friction);
  }
  result.table = table_of(runs);
  result.plots = {way_plot(runs)};
  result.numbers = numbers_of(runs);
  result.we_find = words_for(runs);
  return result;
}

}  // namespace soft_robot_lab
