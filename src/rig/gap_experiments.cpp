// Tables 6.4 and 6.5: the robot on the rig beside its simulation, at rest over the contractions of both cables.
#include "rig/gap_experiments.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "rig/lab_settings.h"
#include "soft_robot_lab/scene/scene.h"

namespace soft_robot_lab {
namespace {

struct GapSettings {
  LabFiles files;
  std::vector<double> contractions;
  std::vector<std::string> shape;
  std::vector<std::string> leans;  // gravity of models that buckle to one side
};

GapSettings read_settings(const ExperimentContext& context, const std::string& name) {
  const SettingsNode node = SettingsNode::load_file(context.settings_file(name));
  GapSettings settings{read_lab_files(node, context), {}, {}, {}};
  for (const SettingsNode& c : node.sequence("contractions"))
    settings.contractions.push_back(c.as_number(AllowedRange::positive()));
  for (const SettingsNode& marker : node.sequence("shape")) settings.shape.push_back(marker.as_text());
  for (const SettingsNode& lean : node.optional_sequence("leaning_gravity_m_s2"))
    settings.leans.push_back("gravity_m_s2: " + lean.dump());
  node.require_all_read();
  return settings;
}

std::string label(const RestRecord& record) {
  std::ostringstream text;
  for (const double contraction : record.contractions) text << (text.tellp() > 0 ? " / " : "") << contraction;
  return text.str();
}

// Root mean square distance of the markers of `places` from where `from` has them; of no marker 0.
double rms_m(const MarkerPlaces& places, const MarkerPlaces& from) {
  double sum_m2 = 0.0;
  for (const auto& [name, place_m] : places) sum_m2 += (place_m - from.at(name)).squaredNorm();
  return places.empty() ? 0.0 : std::sqrt(sum_m2 / static_cast<double>(places.size()));
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

class GapTable {
 public:
  explicit GapTable(const Simulation& model) {
    for (const auto& actuator : model.actuators()) result.table.columns.push_back({actuator->name()});
    for (const Marker& marker : model.markers()) {
      markers_.push_back(marker.name());
      result.table.columns.push_back({marker.name() + " [mm]", 3});
    }
    for (const char* column : {"rms gap [mm]", "true rms gap [mm]", "rms measuring error [mm]"})
      result.table.columns.push_back({column, 3});
  }

  void add(const RestRecord& record) {
    std::vector<TableCell> row(record.contractions.begin(), record.contractions.end());
    auto& numbers = result.numbers["configurations"].emplace_back();
    numbers["contractions"] = record.contractions;
    for (const std::string& marker : markers_) {
      const auto seen = record.measured_m.find(marker);
      if (seen == record.measured_m.end()) {
        row.emplace_back("");
        continue;
      }
      const double gap_m = (seen->second - record.simulated_m.at(marker)).norm();
      row.emplace_back(1e3 * gap_m);
      numbers["gap_m"][marker] = gap_m;
      numbers["measured_m"][marker] = {seen->second.x(), seen->second.y(), seen->second.z()};
    }
    gaps_m_.push_back(rms_m(record.measured_m, record.simulated_m));
    true_gaps_m_.push_back(rms_m(record.true_m, record.simulated_m));
    errors_m_.push_back(rms_m(record.measured_m, record.true_m));
    numbers["rms_gap_m"] = gaps_m_.back();
    numbers["true_rms_gap_m"] = true_gaps_m_.back();
    for (const double value_m : {gaps_m_.back(), true_gaps_m_.back(), errors_m_.back()})
      row.emplace_back(1e3 * value_m);
    result.table.rows.push_back(std::move(row));
    labels_.push_back(label(record));
  }

  void finish(const std::string& name) {
    result.numbers["rms_gap_m"] = rms(gaps_m_);
    result.numbers["true_rms_gap_m"] = rms(true_gaps_m_);
    result.numbers["rms_measuring_error_m"] = rms(errors_m_);
    const std::size_t worst =
        static_cast<std::size_t>(std::max_element(gaps_m_.begin(), gaps_m_.end()) - gaps_m_.begin());
    std::ostringstream text;
    text.precision(3);
    text << "Over all configurations the markers rest " << 1e3 * rms(gaps_m_)
         << " mm (root mean square) from where the simulation expects them, at worst " << 1e3 * gaps_m_[worst]
         << " mm at " << labels_[worst] << "; by reality's own markers it is " << 1e3 * rms(true_gaps_m_)
         << " mm. The cameras, calibrated by balls at the start, measure them within " << 1e3 * rms(errors_m_)
         << " mm. Reality differs as config/reality says; the simulation is not told.";
    result.we_find = text.str();
    result.plots.push_back(bars(name));
  }

  ExperimentResult result;

 private:
  Plot bars(const std::string& name) const {
    Plot plot{name + "_gap", "Root mean square gap between simulation and emulated rig", {}, {}};
    plot.x.label = "contractions";
    plot.y.label = "gap [mm]";
    plot.y.min = 0;
    Series measured{"measured", {}, {}, SeriesStyle::bars}, truth{"true", {}, {}, SeriesStyle::bars};
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      plot.x.ticks.emplace_back(double(i), labels_[i]);
      measured.x.push_back(double(i));
      measured.y.push_back(1e3 * gaps_m_[i]);
      truth.x.push_back(double(i));
      truth.y.push_back(1e3 * true_gaps_m_[i]);
    }
    plot.series = {measured, truth};
    plot.width_px = 1280;
    return plot;
  }

  std::vector<std::string> markers_, labels_;
  std::vector<double> gaps_m_, true_gaps_m_, errors_m_;
};

Series line(const MarkerPlaces& places, const std::vector<std::string>& markers, const std::string& name,
            SeriesStyle style, int colour) {
  Series series{name, {}, {}, style, colour};
  for (const std::string& marker : markers) {
    const auto place = places.find(marker);
    if (place == places.end()) continue;
    series.x.push_back(1e3 * place->second.x());
    series.y.push_back(1e3 * place->second.z());
  }
  return series;
}

Plot shapes(const std::string& name, const std::string& robot, const std::vector<std::string>& markers,
            const std::vector<RestRecord>& records) {
  Plot plot{name + "_shapes", robot + " from the front: simulated (lines) and measured (points)", {}, {}};
  plot.x.label = "x [mm]";
  plot.y.label = "z [mm]";
  plot.height_px = plot.width_px;
  int colour = 0;
  for (const RestRecord& record : records) {
    const double first = record.contractions.front(), last = record.contractions.back();
    if (first != 1.0 && first != last) continue;
    plot.series.push_back(line(record.simulated_m, markers, label(record), SeriesStyle::lines, colour));
    plot.series.push_back(line(record.measured_m, markers, "", SeriesStyle::points, colour));
    colour = (colour + 1) % 8;
  }
  return plot;
}

ExperimentResult run_gap(const ExperimentContext& context, const std::string& name, const std::string& robot) {
  const GapSettings settings = read_settings(context, name);
  const Scene model = load_scene(settings.files.robot, context.scene_options());
  std::vector<Scene> leaning;
  for (const std::string& lean : settings.leans)
    leaning.push_back(load_scene(settings.files.robot, context.scene_options(lean)));
  std::vector<Simulation*> leaning_models;
  for (const Scene& one : leaning) leaning_models.push_back(one.simulation.get());

  context.tell(0, "calibrating the cameras");
  EmulatedLab lab(settings.files.lab, context.scene_options());
  lab.calibrate(settings.files.balls);
  GapTable table(*model.simulation);
  std::vector<RestRecord> records;
  const double count = std::pow(double(settings.contractions.size()), 2);
  for (const double left : settings.contractions) {
    for (const double right : settings.contractions) {
      records.push_back(record_at_rest(lab, *model.simulation, {left, right}, leaning_models));
      table.add(records.back());
      context.tell(double(records.size()) / count, label(records.back()));
    }
  }
  table.finish(name);
  table.result.title = robot + " on the emulated rig and in simulation, over the contractions of both cables";
  table.result.plots.push_back(shapes(name, robot, settings.shape, records));
  table.result.converged = lab.reality().failed_steps() == 0;
  if (!table.result.converged)
    table.result.message = std::to_string(lab.reality().failed_steps()) + " time steps of reality did not converge";
  return table.result;
}

}  // namespace

ExperimentResult run_hammerbot_gap_experiment(const ExperimentContext& context) {
  return run_gap(context, "6.4.1", "Hammerbot");
}

ExperimentResult run_spinebot_gap_experiment(const ExperimentContext& context) {
  return run_gap(context, "6.4.2", "Spinebot");
}

}  // namespace soft_robot_lab
