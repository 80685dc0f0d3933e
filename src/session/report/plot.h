// SPDX-License-Identifier: BSD-3-Clause
// A picture of numbers: what is drawn, and writing it as SVG, PNG (both through the program gnuplot) and CSV.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace soft_robot_lab {

struct Axis {
  std::string label;  // with the unit: "tip sag [mm]"
  bool logarithmic = false;
  double min = std::numeric_limits<double>::quiet_NaN();  // not finite: chosen from the data
  double max = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::pair<double, std::string>> ticks = {};  // words at places, instead of numbers
  std::vector<double> guides = {};                         // thin grey lines across the picture
};

enum class SeriesStyle {
  lines,
  dashes,
  points,
  lines_points,
  dashes_points,
  bars,  // standing on the x axis; several series stand beside each other
  crosses,
  squares  // of half_size to each side of their places
};

struct Series {
  std::string label;  // in the legend; empty: none
  std::vector<double> x;
  std::vector<double> y;
  SeriesStyle style = SeriesStyle::lines_points;
  int colour = -1;                             // place in the palette of eight; -1: the series' own place
  std::vector<std::string> point_labels = {};  // none, or one beside each point
  std::vector<double> deviations = {};         // none, or half the length of an error bar at each point
  std::vector<double> values = {};             // none, or what colours each point or square, by Plot::colour_bar
  std::pair<double, double> half_size = {0.46, 0.46};  // of squares, in x and y: these fill a grid of unit steps
};

struct Plot {
  std::string name;  // of its files, without ending
  std::string title;
  Axis x;
  Axis y;
  std::vector<Series> series = {};
  int width_px = 960;
  int height_px = 600;
  bool equal_scale = false;     // a unit is as long on both axes
  std::string colour_bar = {};  // the label of the values' scale, with the unit; empty: none has values

  void validate() const;  // throws std::invalid_argument: series, and what is wrong with it
};

// Counts of values in `bins` equal bins from min to max, as bars; values outside count in the bins at the ends.
Series histogram(const std::string& label, const std::vector<double>& values, double min, double max, int bins);

struct PlotFiles {
  std::string svg;
  std::string png;
  std::string csv;  // "series,x,y": one line a point, x and y named as the axes; ",deviation" or the colour bar's label
                    // where any has one
};

// Writes FOLDER/NAME.csv, .svg and .png, the CSV first. Throws std::invalid_argument as validate does, and
// std::runtime_error where a file cannot be written, or gnuplot is missing or refuses.
PlotFiles write_plot(const Plot& plot, const std::string& folder);

}  // namespace soft_robot_lab
