// SPDX-License-Identifier: BSD-3-Clause
// Tables 6.4 to 6.6: the robot on the rig beside its simulation, both taken through the source's configurations in its
// order.
#include "gap_experiments.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "gap_settings.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

constexpr double kAnotherRest_m = 0.002;
constexpr double kLeastMove_m = 0.0002;  // a tip that moves less is not judged

enum class MirrorImage { not_asked, itself, another_rest, no_rest };

struct GapRecord {
  std::string name;
  RestRecord rest;
  std::vector<double> steps;  // of the motors
  MirrorImage mirror_image = MirrorImage::not_asked;
  MarkerPlaces mirrored_m;                    // where the model rests as well; empty where there is no other rest
  std::vector<ActuatorReading> model, robot;  // the actuators, truly

  const MarkerPlaces& truth() const { return rest.true_m; }
};

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<ActuatorReading> readings(const Simulation& simulation) {
  std::vector<ActuatorReading> all;
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i)
    all.push_back(simulation.actuator_state(static_cast<int>(i)));
  return all;
}

std::vector<double> motor_steps(const RigSettings& rig, const RestRecord& rest) {
  std::vector<double> steps;
  for (std::size_t i = 0; i < rest.actuators.size(); ++i)
    for (const MotorSettings& motor : rig.motors)
      if (motor.name == rest.actuators[i])
        steps.push_back(0.0 + motor.direction * steps_of(motor, rest.commands[i]));  // no -0
  return steps;
}

void ask_mirror_image(Simulation& model, int axis, GapRecord& record) {
  const auto there_m = rest_from_mirror_image(model, axis);
  if (!there_m) {
    record.mirror_image = MirrorImage::no_rest;
    return;
  }
  const bool another = farthest_m(record.rest.simulated_m, *there_m) > kAnotherRest_m;
  record.mirror_image = another ? MirrorImage::another_rest : MirrorImage::itself;
  if (another) record.mirrored_m = *there_m;
}

std::vector<GapRecord> run_table(const GapSettings& settings, const ExperimentContext& context, EmulatedLab& lab,
                                 Simulation& model) {
  std::vector<GapRecord> records;
  for (const Configuration& configuration : settings.configurations) {
    context.report(double(records.size()) / double(settings.configurations.size()), configuration.name);
    GapRecord record{configuration.name, record_at_rest(lab, model, configuration.commands), {}, {}, {}, {}, {}};
    record.steps = motor_steps(settings.files.lab.rig, record.rest);
    record.model = readings(model);
    record.robot = readings(lab.plant().simulation());
    if (settings.mirror_axis) ask_mirror_image(model, *settings.mirror_axis, record);
    records.push_back(std::move(record));
  }
  return records;
}

const GapRecord& find(const std::vector<GapRecord>& records, const std::string& name) {
  return *std::find_if(records.begin(), records.end(), [&](const GapRecord& one) { return one.name == name; });
}

// From where it was in the first configuration.
double tip_moved_m(const std::vector<GapRecord>& records, const GapRecord& record, const GapSettings& settings,
                   MarkerPlaces RestRecord::*places) {
  return ((record.rest.*places).at(settings.tip()) - (records.front().rest.*places).at(settings.tip())).norm();
}

std::string words(MirrorImage mirror_image) {
  switch (mirror_image) {
    case MirrorImage::itself:
      return "no other rest";
    case MirrorImage::another_rest:
      return "rests too";
    case MirrorImage::no_rest:
      return "finds no rest";
    case MirrorImage::not_asked:
      break;
  }
  return "";
}

Table gap_table(const std::vector<GapRecord>& records, const GapSettings& settings) {
  Table table;
  table.columns = {{"configuration"}};
  const RestRecord& first = records.front().rest;
  for (const std::string& actuator : first.actuators)
    table.columns.push_back({actuator + (settings.pneumatic ? " [ml]" : "")});
  for (const std::string& actuator : first.actuators) table.columns.push_back({actuator + " [steps]", 5});
  for (const auto& marker : first.true_m) table.columns.push_back({marker.first + " [mm]", 3});
  for (const char* column : {"rms gap [mm]", "true rms gap [mm]", "rms measuring error [mm]", "tip moves, robot [mm]",
                             "tip moves, simulation [mm]"})
    table.columns.push_back({column, 3});
  if (settings.mirror_axis) table.columns.push_back({"mirror image"});
  for (const GapRecord& record : records) {
    std::vector<TableCell> row = {record.name};
    row.insert(row.end(), record.rest.commands.begin(), record.rest.commands.end());
    row.insert(row.end(), record.steps.begin(), record.steps.end());
    for (const auto& [marker, position_m] : record.rest.simulated_m) {
      const auto seen = record.rest.measured_m.find(marker);
      row.emplace_back(seen == record.rest.measured_m.end() ? TableCell("") : 1e3 * (seen->second - position_m).norm());
    }
    for (const double value_m :
         {rms_m(record.rest.measured_m, record.rest.simulated_m), rms_m(record.truth(), record.rest.simulated_m),
          rms_m(record.rest.measured_m, record.truth()), tip_moved_m(records, record, settings, &RestRecord::true_m),
          tip_moved_m(records, record, settings, &RestRecord::simulated_m)})
      row.emplace_back(1e3 * value_m);
    if (settings.mirror_axis) row.emplace_back(words(record.mirror_image));
    table.rows.push_back(std::move(row));
  }
  return table;
}

nlohmann::ordered_json numbers_of(const std::vector<ActuatorReading>& actuators) {
  nlohmann::ordered_json numbers;
  for (const ActuatorReading& actuator : actuators) {
    if (actuator.tension_n) numbers[actuator.name]["tension_n"] = *actuator.tension_n;
    if (!actuator.volume_m3) continue;
    numbers[actuator.name]["volume_ml"] = 1e6 * *actuator.volume_m3;
    numbers[actuator.name]["gauge_pressure_pa"] = *actuator.gauge_pressure_pa;
  }
  return numbers;
}

nlohmann::ordered_json places_of(const std::map<std::string, Eigen::Vector3d>& places_m) {
  nlohmann::ordered_json places;
  for (const auto& [name, at_m] : places_m) places[name] = {at_m.x(), at_m.y(), at_m.z()};
  return places;
}

nlohmann::ordered_json numbers_of(const std::vector<GapRecord>& records, const GapRecord& record,
                                  const GapSettings& settings) {
  nlohmann::ordered_json numbers = {
      {"name", record.name},
      {settings.pneumatic ? "syringe_ml" : "contractions", record.rest.commands},
      {"motor_steps", record.steps},
      {"rms_gap_m", rms_m(record.rest.measured_m, record.rest.simulated_m)},
      {"true_rms_gap_m", rms_m(record.truth(), record.rest.simulated_m)},
      {"tip_moves_m",
       {{"robot", tip_moved_m(records, record, settings, &RestRecord::true_m)},
        {"simulation", tip_moved_m(records, record, settings, &RestRecord::simulated_m)}}},
      {"measured_m", places_of(record.rest.measured_m)},
      {"true_m", places_of(record.rest.true_m)},
      {"simulated_m", places_of(record.rest.simulated_m)},
      {"robot", numbers_of(record.robot)},
      {"simulation", numbers_of(record.model)}};
  if (settings.mirror_axis) numbers["mirror_image"] = words(record.mirror_image);
  if (!record.mirrored_m.empty()) {
    numbers["mirrored_m"] = places_of(record.mirrored_m);
    numbers["true_rms_gap_to_mirror_image_m"] = rms_m(record.truth(), record.mirrored_m);
  }
  return numbers;
}

// What does not come back where a configuration asks for the same again: distances from the first of `come_back`.
nlohmann::ordered_json come_back(const std::vector<GapRecord>& records, const GapSettings& settings) {
  nlohmann::ordered_json numbers = nlohmann::ordered_json::object();
  const RestRecord& before = find(records, settings.come_back.front()).rest;
  for (std::size_t i = 1; i < settings.come_back.size(); ++i) {
    const RestRecord& again = find(records, settings.come_back[i]).rest;
    numbers[settings.come_back[i]] = {
        {"measured_rms_m", rms_m(again.measured_m, before.measured_m)},
        {"true_rms_m", rms_m(again.true_m, before.true_m)},
        {"true_tip_m", (again.true_m.at(settings.tip()) - before.true_m.at(settings.tip())).norm()},
        {"simulated_rms_m", rms_m(again.simulated_m, before.simulated_m)}};
  }
  return numbers;
}

Plot bars(const std::string& name, const std::vector<GapRecord>& records) {
  Plot plot{name + "_gap", "Root mean square gap between simulation and emulated rig", {}, {}};
  plot.x.label = "configuration";
  plot.y.label = "gap [mm]";
  plot.y.min = 0;
  Series measured{"measured", {}, {}, SeriesStyle::bars}, truth{"true", {}, {}, SeriesStyle::bars};
  for (std::size_t i = 0; i < records.size(); ++i) {
    const RestRecord& rest = records[i].rest;
    plot.x.ticks.emplace_back(double(i), records[i].name);
    measured.x.push_back(double(i));
    measured.y.push_back(1e3 * rms_m(rest.measured_m, rest.simulated_m));
    truth.x.push_back(double(i));
    truth.y.push_back(1e3 * rms_m(rest.true_m, rest.simulated_m));
  }
  plot.series = {measured, truth};
  return plot;
}

Series line(const MarkerPlaces& places, const GapSettings& settings, const std::string& name, SeriesStyle style,
            int colour) {
  Series series{name, {}, {}, style, colour};
  const int across = settings.seen_along == 1 ? 0 : 1;
  for (const std::string& marker : settings.shape) {
    const auto place = places.find(marker);
    if (place == places.end()) continue;
    series.x.push_back(1e3 * place->second[across]);
    series.y.push_back(1e3 * place->second.z());
  }
  return series;
}

Plot shapes(const std::string& name, const std::string& robot, const GapSettings& settings,
            const std::vector<GapRecord>& records) {
  Plot plot{name + "_shapes", robot + ": simulated (lines) and measured on the emulated rig (points)", {}, {}};
  plot.x.label = settings.seen_along == 1 ? "x [mm]" : "y [mm]";
  plot.y.label = "z [mm]";
  plot.height_px = plot.width_px;
  int colour = 0;
  for (const GapRecord& record : records) {
    const auto drawn = std::find(settings.drawn.begin(), settings.drawn.end(), record.name);
    if (!settings.drawn.empty() && drawn == settings.drawn.end()) continue;
    plot.series.push_back(line(record.rest.simulated_m, settings, record.name, SeriesStyle::lines, colour));
    const Series measured = line(record.rest.measured_m, settings, "", SeriesStyle::points, colour);
    if (!measured.x.empty()) plot.series.push_back(measured);  // some shapes hide them all
    colour = (colour + 1) % 8;
  }
  return plot;
}

void describe_gaps(const std::vector<GapRecord>& records, ExperimentResult& result, std::ostream& text) {
  std::vector<double> gaps_m, true_gaps_m, errors_m;
  for (const GapRecord& record : records) {
    gaps_m.push_back(rms_m(record.rest.measured_m, record.rest.simulated_m));
    true_gaps_m.push_back(rms_m(record.truth(), record.rest.simulated_m));
    errors_m.push_back(rms_m(record.rest.measured_m, record.truth()));
  }
  result.numbers["rms_gap_m"] = rms(gaps_m);
  result.numbers["true_rms_gap_m"] = rms(true_gaps_m);
  result.numbers["rms_measuring_error_m"] = rms(errors_m);
  const auto worst = static_cast<std::size_t>(std::max_element(gaps_m.begin(), gaps_m.end()) - gaps_m.begin());
  text << "Over all configurations the markers rest " << 1e3 * rms(gaps_m)
       << " mm (root mean square) from where the simulation rests after the same commands in the same order, at worst "
       << 1e3 * gaps_m[worst] << " mm in " << records[worst].name << "; by plant's own markers it is "
       << 1e3 * rms(true_gaps_m) << " mm. The cameras, calibrated by balls at the start, measure them within "
       << 1e3 * rms(errors_m) << " mm. ";
}

void describe_come_back(const GapSettings& settings, const nlohmann::ordered_json& numbers, std::ostream& text) {
  for (const auto& [name, distances] : numbers.items())
    text << "In " << name << " the robot rests " << 1e3 * distances["true_rms_m"].get<double>() << " mm (measured "
         << 1e3 * distances["measured_rms_m"].get<double>() << " mm, tip "
         << 1e3 * distances["true_tip_m"].get<double>() << " mm) from where it was in " << settings.come_back.front()
         << ", the simulation " << 1e3 * distances["simulated_rms_m"].get<double>() << " mm. ";
}

void describe_branches(const std::vector<GapRecord>& records, std::ostream& text) {
  for (const GapRecord& record : records) {
    if (record.mirrored_m.empty()) continue;
    text << "In " << record.name << " the model's mirror image is a rest state as well: plant is "
         << 1e3 * rms_m(record.truth(), record.rest.simulated_m)
         << " mm from the one that the commands led the model to, " << 1e3 * rms_m(record.truth(), record.mirrored_m)
         << " mm from the other. ";
  }
}

void describe_bending(const std::vector<GapRecord>& records, const GapSettings& settings, std::ostream& text) {
  std::string more, less;
  for (const GapRecord& record : records) {
    const double robot_m = tip_moved_m(records, record, settings, &RestRecord::true_m);
    const double model_m = tip_moved_m(records, record, settings, &RestRecord::simulated_m);
    if (std::max(robot_m, model_m) < kLeastMove_m) continue;
    std::string& list = model_m > robot_m ? more : less;
    list += (list.empty() ? "" : ", ") + record.name;
  }
  text << "The simulation's tip moves farther than the robot's in " << (more.empty() ? "none" : more)
       << ", less far in " << (less.empty() ? "none" : less) << ". ";
}

// At the configuration with the highest pressure: amounts of gas as the source counts them, over that at rest.
void describe_pressures(const std::vector<GapRecord>& records, std::ostream& text) {
  const GapRecord* highest = nullptr;
  std::size_t chamber = 0;
  for (const GapRecord& record : records) {
    for (std::size_t i = 0; i < record.robot.size(); ++i) {
      if (!record.robot[i].gauge_pressure_pa) continue;
      if (highest && *record.robot[i].gauge_pressure_pa <= *highest->robot[chamber].gauge_pressure_pa) continue;
      highest = &record;
      chamber = i;
    }
  }
  if (!highest) return;
  const ActuatorReading& robot = highest->robot[chamber];
  text << "The highest pressure is that of chamber " << robot.name << " in " << highest->name << ": "
       << *robot.gauge_pressure_pa << " Pa above the air on the robot, " << *highest->model[chamber].gauge_pressure_pa
       << " Pa in simulation, at " << *robot.volume_m3 / *robot.initial_volume_m3 << " times the chamber's volume. ";
}

ExperimentResult run_gap(const ExperimentContext& context, const std::string& name, const std::string& robot) {
  const GapSettings settings = read_gap_settings(context, name);
  const Scene model = load_scene(settings.files.robot, context.scene_options());
  const SolveReport hanging = model.simulation->solve_equilibrium();
  if (!hanging.converged) throw std::runtime_error("the model finds no rest: " + hanging.message);
  context.report(0, "calibrating the cameras");
  EmulatedLab lab(settings.files.lab, context.scene_options());
  lab.calibrate(settings.files.balls);
  const std::vector<GapRecord> records = run_table(settings, context, lab, *model.simulation);

  ExperimentResult result;
  result.title = robot + " on the emulated rig and in simulation, through the source's configurations";
  result.table = gap_table(records, settings);
  for (const GapRecord& record : records)
    result.numbers["configurations"].push_back(numbers_of(records, record, settings));
  result.numbers["come_back"] = come_back(records, settings);
  std::ostringstream text;
  text.precision(3);
  describe_gaps(records, result, text);
  describe_come_back(settings, result.numbers["come_back"], text);
  describe_bending(records, settings, text);
  describe_branches(records, text);
  describe_pressures(records, text);
  result.we_find = text.str();
  result.plots = {bars(name, records), shapes(name, robot, settings, records)};
  result.converged = lab.plant().failed_steps() == 0;
  if (!result.converged)
    result.message = std::to_string(lab.plant().failed_steps()) + " time steps of plant did not converge";
  return result;
}

const char* const kOwnModel =
    "the robot on the emulated rig is our own model with other parameters, as config/plant says, so its gaps measure "
    "the tool chain, not silicone";

}  // namespace

ExperimentResult run_hammerbot_gap_experiment(const ExperimentContext& context) {
  ExperimentResult result = run_gap(context, "6.4.1", "Hammerbot");
  result.source_reports =
      "Pictures without distances. In (b), (c) and (e) the simulation bends less than the robot; in (f) the robot does "
      "not come back to (a); (g) agrees well; in (e) the idle right cable catches on the beam and turns the robot "
      "slightly.";
  result.we_differ = std::string("In ours ") + kOwnModel + ", and its cables do not touch the beam.";
  return result;
}

ExperimentResult run_spinebot_gap_experiment(const ExperimentContext& context) {
  ExperimentResult result = run_gap(context, "6.4.2", "Spinebot");
  result.source_reports =
      "Pictures without distances. The simulation overshoots and bends mostly near the tip, the robot all along; (a), "
      "(c) and (f), which ask for the same, differ; plugs that do not fit bend the robot to the right at rest.";
  result.we_differ = std::string("In ours ") + kOwnModel + ", and its plugs fit.";
  return result;
}

ExperimentResult run_bubblebot_gap_experiment(const ExperimentContext& context) {
  ExperimentResult result = run_gap(context, "6.4.3", "Bubblebot");
  result.source_reports =
      "Pictures without distances. The robot needs much less pressure than the simulation for large deformations; (b), "
      "(c) and (d) are drawn over the simulation of 6.3.5, which hardly moves.";
  result.we_differ =
      std::string("In ours ") + kOwnModel +
      "; motors drive the syringes where the source has an operator, the chambers' shape is ours, and (b), "
      "(c) and (d) are drawn over a simulation of the same ml, not of five times the gas.";
  return result;
}

}  // namespace soft_robot_lab
