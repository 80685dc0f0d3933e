#include "rig/pull_experiment.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <sstream>
#include <stdexcept>

#include "rig/emulated_session.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {
namespace {

// The law the lab measured: 50.4 ms for each mm, and 19.9 ms beside.
constexpr double thesis_slope_ms_per_mm = 50.4;
constexpr double thesis_offset_ms = 19.9;

struct Settings {
  std::string rig;
  std::vector<double> pulls_mm;
  int repeats;
  double fit_from_mm;
};

Settings read_settings(const ExperimentContext& context) {
  const SettingsNode node = SettingsNode::load_file(context.settings_file("4.3.1"));
  Settings settings;
  settings.rig = context.config_folder + "/" + node.text("rig");
  for (const SettingsNode& pull : node.sequence("pulls_mm")) {
    settings.pulls_mm.push_back(pull.as_number(AllowedRange::positive()));
  }
  settings.repeats = node.integer("repeats", 1, 1000);
  settings.fit_from_mm = node.number("fit_from_mm", AllowedRange::not_negative());
  node.require_all_read();
  return settings;
}

// From the command to the driver's word that the motor rests again.
double pull_once_s(EmulatedSession& session, double value) {
  const double start_s = session.rig.time_s();
  session.command({session.settings.motors[0].name}, {value});
  if (!session.run_until_rest()) throw std::runtime_error("the emulated motor does not come to rest");
  const double taken_s = session.rig.time_s() - start_s;
  const double asked_for = steps_of(session.settings.motors[0], value);
  if (session.shaft(0) != asked_for) throw std::runtime_error("the shaft is not where it was asked to go");
  return taken_s;
}

// The times of one pull, begun at random moments within the board's 20 ms round.
std::vector<double> pull_times_ms(EmulatedSession& session, double pull_mm, int repeats, std::mt19937_64& random) {
  const MotorSettings& motor = session.settings.motors[0];
  const double pulled = value_of(motor, motor.direction * std::round(1e-3 * pull_mm / motor.step_m));
  std::vector<double> times_ms;
  for (int i = 0; i < repeats; ++i) {
    session.run(0.02 * static_cast<double>(random() % 1000) / 1000.0 + 0.02);
    times_ms.push_back(1e3 * pull_once_s(session, pulled));
    session.run(0.02);
    pull_once_s(session, motor.rest_value);
  }
  return times_ms;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double middle = mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - middle) * (value - middle);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

// From rest to rest, speeding up and slowing down equally, fast enough to reach the top speed.
double time_by_speed_ms(const MotorSettings& motor, double pull_mm) {
  const double speed = driven_speed(motor.drive);
  return 1e3 * (std::round(1e-3 * pull_mm / motor.step_m) / speed + speed / driven_acceleration(motor.drive));
}

struct Line {
  double slope;
  double offset;
};

Line fit(const std::vector<double>& x, const std::vector<double>& y) {
  const double middle_x = mean(x), middle_y = mean(y);
  double xy = 0.0, xx = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - middle_x) * (y[i] - middle_y);
    xx += (x[i] - middle_x) * (x[i] - middle_x);
  }
  return {xy / xx, middle_y - xy / xx * middle_x};
}

Plot draw(const std::string& title, const std::vector<double>& pulls_mm, const std::vector<double>& means_ms) {
  Plot plot{"4.3.1", title, {"pull [mm]"}, {"time [ms]"}, {}};
  plot.x.min = plot.y.min = 0.0;
  Series thesis{"thesis: 50.4 x + 19.9", pulls_mm, {}, SeriesStyle::lines};
  for (const double pull_mm : pulls_mm) thesis.y.push_back(thesis_slope_ms_per_mm * pull_mm + thesis_offset_ms);
  plot.series = {thesis, {"emulated rig, mean", pulls_mm, means_ms, SeriesStyle::points}};
  return plot;
}

}  // namespace

ExperimentResult run_pull_experiment(const ExperimentContext& context) {
  const Settings settings = read_settings(context);
  EmulatedSession session(load_rig(settings.rig));
  if (!session.run_until_ready()) throw std::runtime_error("the emulated rig is not ready");
  const MotorSettings& motor = session.settings.motors[0];

  ExperimentResult result;
  result.title = "Time to pull a cable, " + std::to_string(settings.repeats) + " times each";
  result.table.columns = {
      {"pull [mm]"},  {"steps"},         {"mean [ms]", 5}, {"deviation [ms]", 2}, {"by speed and acceleration [ms]", 5},
      {"off [%]", 2}, {"thesis [ms]", 5}};
  std::mt19937_64 random(1);
  std::vector<double> means_ms, deviations_ms, fit_pulls_mm, fit_means_ms;
  double worst = 0.0;
  for (const double pull_mm : settings.pulls_mm) {
    context.tell(static_cast<double>(means_ms.size()) / static_cast<double>(settings.pulls_mm.size()),
                 std::to_string(std::lround(pull_mm)) + " mm");
    const auto times_ms = pull_times_ms(session, pull_mm, settings.repeats, random);
    means_ms.push_back(mean(times_ms));
    deviations_ms.push_back(deviation(times_ms));
    const double expected_ms = time_by_speed_ms(motor, pull_mm);
    const double off = means_ms.back() / expected_ms - 1.0;
    worst = std::max(worst, std::abs(off));
    result.table.rows.push_back({pull_mm, std::round(1e-3 * pull_mm / motor.step_m), means_ms.back(),
                                 deviations_ms.back(), expected_ms, 1e2 * off,
                                 thesis_slope_ms_per_mm * pull_mm + thesis_offset_ms});
    if (pull_mm < settings.fit_from_mm) continue;
    fit_pulls_mm.push_back(pull_mm);
    fit_means_ms.push_back(means_ms.back());
  }
  const Line line = fit(fit_pulls_mm, fit_means_ms);
  result.plots.push_back(draw(result.title, settings.pulls_mm, means_ms));
  result.numbers = {{"pull_mm", settings.pulls_mm},
                    {"mean_ms", means_ms},
                    {"sd_ms", deviations_ms},
                    {"fit", {{"slope_ms_per_mm", line.slope}, {"offset_ms", line.offset}}},
                    {"worst_relative_error", worst}};
  result.source_reports = "pulls of x mm took 50.4 x + 19.9 ms on the lab's rig.";
  std::ostringstream found;
  found.precision(3);
  found << "the real firmware on the emulated rig takes " << line.slope << " x + " << line.offset
        << " ms: the L6470 counts speeds in units of 15.26 steps/s, so 320.4 steps/s is as near as it comes. Speed and "
           "acceleration "
           "give each time within "
        << 1e2 * worst << " %.";
  result.we_find = found.str();
  return result;
}

}  // namespace soft_robot_lab
