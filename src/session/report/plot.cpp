// SPDX-License-Identifier: BSD-3-Clause
#include "plot.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "gnuplot_script.h"
#include "robot/design/timed_process.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

constexpr double kDrawingLimit_s = 60.0;

void require(bool ok, const Plot& plot, const std::string& what) {
  if (!ok) throw std::invalid_argument("plot '" + plot.name + "': " + what);
}

void check_axis(const Plot& plot, const std::string& series, const char* name, const Axis& axis,
                const std::vector<double>& values) {
  for (const double value : values) {
    require(std::isfinite(value), plot, "series '" + series + "': " + name + " is not finite");
    require(
        !axis.logarithmic || value > 0.0, plot,
        "series '" + series + "': " + name + " = " + std::to_string(value) + " must be above 0 on a logarithmic axis");
  }
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
  return cell + "\"";
}

std::string csv(const Plot& plot) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(10);
  const bool deviate = std::any_of(plot.series.begin(), plot.series.end(),
                                   [](const Series& series) { return !series.deviations.empty(); });
  const bool valued = !plot.colour_bar.empty();
  text << "series," << csv_cell(plot.x.label) << "," << csv_cell(plot.y.label) << (deviate ? ",deviation" : "")
       << (valued ? "," + csv_cell(plot.colour_bar) : "") << "\n";
  for (const Series& series : plot.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const bool named = !series.point_labels.empty() && !series.point_labels[i].empty();
      const std::string name = named ? series.label + ": " + series.point_labels[i] : series.label;
      text << csv_cell(name) << "," << series.x[i] << "," << series.y[i];
      if (deviate) text << ",";
      if (!series.deviations.empty()) text << series.deviations[i];
      if (valued) text << ",";
      if (!series.values.empty()) text << series.values[i];
      text << "\n";
    }
  }
  return text.str();
}

std::string find_gnuplot() {
  std::istringstream path(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(path, folder, ':');) {
    const std::string program = folder + "/gnuplot";
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  throw std::runtime_error("pictures are drawn by gnuplot, which is not on PATH: apt-get install gnuplot-nox");
}

// The script stays beside the picture where gnuplot refuses it.
void draw(const Plot& plot, const std::string& terminal, const std::string& picture) {
  const std::string gnuplot = find_gnuplot();
  const std::string script = picture + ".gnuplot", errors = picture + ".errors";
  write_file(script, gnuplot_script(plot, terminal, picture));
  const ProcessEnd end = run_with_limit({gnuplot, script}, errors, kDrawingLimit_s);
  std::ostringstream words;
  words << std::ifstream(errors).rdbuf();
  fs::remove(errors);
  if (end.kind != ProcessEnd::Kind::exited || end.value != 0 || !fs::exists(picture)) {
    throw std::runtime_error("gnuplot did not draw " + script + ": " + words.str());
  }
  fs::remove(script);
}

}  // namespace

void Plot::validate() const {
  require(!name.empty() && name.find('/') == std::string::npos, *this, "its name must be that of a file");
  require(!series.empty(), *this, "has no series");
  for (const Series& one : series) {
    require(!one.x.empty(), *this, "series '" + one.label + "' is empty");
    require(one.x.size() == one.y.size(), *this, "series '" + one.label + "' has unequal numbers of x and y");
    require(one.point_labels.empty() || one.point_labels.size() == one.x.size(), *this,
            "series '" + one.label + "' has a label for some of its points only");
    require(one.deviations.empty() || one.deviations.size() == one.x.size(), *this,
            "series '" + one.label + "' has a deviation for some of its points only");
    for (const double deviation : one.deviations)
      require(deviation >= 0 && std::isfinite(deviation), *this,
              "series '" + one.label + "': a deviation is negative or not finite");
    require(one.values.empty() || (one.values.size() == one.x.size() && one.point_labels.empty()), *this,
            "series '" + one.label + "' has values for some of its points only, or labels beside them");
    require(one.values.empty() || !colour_bar.empty(), *this, "has values, but no label of their colour bar");
    for (const double value : one.values)
      require(std::isfinite(value), *this, "series '" + one.label + "': a value is not finite");
    check_axis(*this, one.label, "x", x, one.x);
    check_axis(*this, one.label, "y", y, one.y);
  }
}

Series histogram(const std::string& label, const std::vector<double>& values, double min, double max, int bins) {
  if (!(max > min) || bins < 1)
    throw std::invalid_argument("histogram '" + label + "': needs max > min, one bin or more");
  Series series{label, {}, std::vector<double>(static_cast<std::size_t>(bins), 0.0), SeriesStyle::bars};
  const double width = (max - min) / bins;
  for (int i = 0; i < bins; ++i) series.x.push_back(min + (i + 0.5) * width);
  for (const double value : values) {
    if (!std::isfinite(value)) throw std::invalid_argument("histogram '" + label + "': a value is not finite");
    const double bin = std::clamp(std::floor((value - min) / width), 0.0, bins - 1.0);
    series.y[static_cast<std::size_t>(bin)] += 1.0;
  }
  return series;
}

PlotFiles write_plot(const Plot& plot, const std::string& folder) {
  plot.validate();
  fs::create_directories(folder);
  const std::string stem = (fs::path(folder) / plot.name).string();
  const PlotFiles files{stem + ".svg", stem + ".png", stem + ".csv"};
  write_file(files.csv, csv(plot));
  draw(plot, "svg", files.svg);
  draw(plot, "png", files.png);
  return files;
}

}  // namespace soft_robot_lab
