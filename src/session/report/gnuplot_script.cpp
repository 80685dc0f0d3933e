// SPDX-License-Identifier: BSD-3-Clause
#include "gnuplot_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

namespace soft_robot_lab {
namespace {

// Okabe & Ito's palette (Wong 2011, Nature Methods 8:441): distinguished by colour-blind readers too.
constexpr std::array<const char*, 8> kPalette = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#E69F00", "#56B4E9", "#000000", "#B8A800"};
// Viridis (van der Walt and Smith 2015) at ninths: even in lightness, so it can be read in grey too.
constexpr const char* kScale =
    "0 '#440154', 1 '#472d7b', 2 '#3b528b', 3 '#2c728e', 4 '#21918c', 5 '#28ae80', 6 '#5ec962', 7 '#addc30', 8 "
    "'#fde725'";
constexpr std::array<int, 8> kMarks = {7, 5, 9, 11, 13, 6, 4, 8};  // of gnuplot: circle, square, triangles, ...
constexpr std::size_t kMostBeside = 5, kMostSlanted = 12;          // words below the x axis
constexpr int kMostBelow = 6;                                      // a longer legend stands beside the picture

// Names of recordings may hold anything: a NUL or a line's end would end the script.
char printable(char c) { return static_cast<unsigned char>(c) < ' ' || c == 127 ? ' ' : c; }

// gnuplot takes two quotes in a row for one only where neither the first sign nor another such pair stands before them,
// so a quote is a string of its own. It runs what stands in backquotes, but not within single quotes.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'.\"'\".'" : std::string(1, printable(c));
  return result + "'";
}

std::string colour(const Series& series, std::size_t place) {
  const std::size_t index = series.colour < 0 ? place : static_cast<std::size_t>(series.colour);
  return series.values.empty() ? std::string("rgb '") + kPalette[index % kPalette.size()] + "'" : "palette";
}

std::string mark(std::size_t place) { return std::to_string(kMarks[place % kMarks.size()]); }

bool is_bars(const Series& series) { return series.style == SeriesStyle::bars; }

// The width of one bar: the smallest distance of two places, shared by the series that have bars.
double bar_width(const Plot& plot) {
  std::vector<double> places;
  double count = 0.0;
  for (const Series& series : plot.series) {
    if (!is_bars(series)) continue;
    places.insert(places.end(), series.x.begin(), series.x.end());
    ++count;
  }
  std::sort(places.begin(), places.end());
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i] - places[i - 1] > 1e-9 * std::abs(places[i]))
      distance = std::min(distance, places[i] - places[i - 1]);
  }
  return (std::isfinite(distance) ? distance : 1.0) * 0.85 / std::max(count, 1.0);
}

void write_axis(std::ostream& script, const char* name, const Axis& axis) {
  script << "set " << name << "label " << quoted(axis.label) << "\n";
  if (axis.logarithmic) script << "set logscale " << name << "\nset format " << name << " '%g'\n";
  script << "set " << name << "range [";
  if (std::isfinite(axis.min)) script << axis.min;
  script << ":";
  if (std::isfinite(axis.max)) script << axis.max;
  script << "]\n";
  if (axis.ticks.empty()) return;
  script << "set " << name << "tics (";
  for (std::size_t i = 0; i < axis.ticks.size(); ++i) {
    script << (i ? ", " : "") << quoted(axis.ticks[i].second) << " " << axis.ticks[i].first;
  }
  const bool many = axis.ticks.size() > kMostBeside, crowded = axis.ticks.size() > kMostSlanted;
  script << ")" << (name[0] != 'x' || !many ? "" : crowded ? " rotate by 90 right" : " rotate by 30 right") << "\n";
}

void write_guides(std::ostream& script, const Plot& plot) {
  for (const double x : plot.x.guides) {
    script << "set arrow from " << x << ", graph 0 to " << x << ", graph 1 nohead back lc '#888888' dt 3\n";
  }
  for (const double y : plot.y.guides) {
    script << "set arrow from graph 0, first " << y << " to graph 1, first " << y << " nohead back lc '#888888' dt 3\n";
  }
}

std::string look(const Series& series, std::size_t place) {
  const std::string line = "lc " + colour(series, place) + " lw 2.5";
  const std::string points = " pt " + mark(place) + " ps 1";
  switch (series.style) {
    case SeriesStyle::lines:
      return "with lines " + line;
    case SeriesStyle::dashes:
      return "with lines dt 2 " + line;
    case SeriesStyle::points:
      return "with points " + line + " pt " + mark(place) + " ps 1.4";
    case SeriesStyle::crosses:
      return "with points " + line + " pt 2 ps 0.8";
    case SeriesStyle::lines_points:
      return "with linespoints " + line + points;
    case SeriesStyle::dashes_points:
      return "with linespoints dt 2 " + line + points;
    case SeriesStyle::bars:
      return "with boxes fs solid 0.85 noborder lc " + colour(series, place);
    case SeriesStyle::squares:
      return "with boxxyerror fs solid 0.9 noborder lc " + colour(series, place);
  }
  return "";
}

// Columns of a series' data block: x, y, deviation, label or value.
std::string columns(const Series& series, double offset) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  if (is_bars(series)) {
    text << "($1+" << offset << "):2";
  } else if (series.style == SeriesStyle::squares) {
    text << "1:2:(" << series.half_size.first << "):(" << series.half_size.second << ")";
  } else {
    text << "1:2";
  }
  if (!series.values.empty()) text << ":4";
  return text.str();
}

void write_data(std::ostream& script, const Series& series, std::size_t place) {
  script << "$series" << place << " << END_OF_SERIES\n";
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    script << series.x[i] << " " << series.y[i] << " " << (series.deviations.empty() ? 0 : series.deviations[i]);
    if (!series.values.empty()) script << " " << series.values[i];
    if (!series.point_labels.empty()) {
      std::string label = series.point_labels[i];
      std::replace(label.begin(), label.end(), '"', '\'');
      std::replace(label.begin(), label.end(), '\\', '/');
      std::transform(label.begin(), label.end(), label.begin(), printable);
      script << " \"" << label << "\"";
    }
    script << "\n";
  }
  script << "END_OF_SERIES\n";
}

void write_curves(std::ostream& script, const Plot& plot) {
  const double width = bar_width(plot);
  const auto bar_series = static_cast<double>(std::count_if(plot.series.begin(), plot.series.end(), is_bars));
  if (bar_series > 0.0) script << "set offsets 0, 0, graph 0.05, 0\n";
  script << "set boxwidth " << width << " absolute\nplot ";
  double bar = 0.0;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Series& series = plot.series[i];
    const double offset = is_bars(series) ? (bar++ - 0.5 * (bar_series - 1.0)) * width : 0.0;
    script << (i ? ", \\\n     " : "") << "$series" << i << " using " << columns(series, offset) << " "
           << look(series, i) << (series.label.empty() ? " notitle" : " title " + quoted(series.label));
    if (!series.deviations.empty())
      script << ", \\\n     $series" << i << " using ($1+" << offset << "):2:3 with yerrorbars lc '#444444' lw 2 pt 0"
             << " notitle";
    if (series.point_labels.empty()) continue;
    script << ", \\\n     $series" << i << " using 1:2:4 with labels offset 0.9,0.6 left font ',11' tc "
           << colour(series, i) << " notitle";
  }
  script << "\n";
}

}  // namespace

std::string gnuplot_script(const Plot& plot, const std::string& terminal, const std::string& output_file) {
  std::ostringstream script;
  script.imbue(std::locale::classic());
  script.precision(12);
  for (std::size_t i = 0; i < plot.series.size(); ++i) write_data(script, plot.series[i], i);
  script << "set encoding utf8\nset terminal " << (terminal == "svg" ? "svg noenhanced" : "pngcairo noenhanced")
         << " size " << plot.width_px << "," << plot.height_px << " font 'DejaVu Sans,13' background rgb 'white'\n"
         << "set output " << quoted(output_file) << "\nset title " << quoted(plot.title) << " font ',16'\n"
         << "set border 3 lc '#444444'\nset tics nomirror\nset grid lc '#dddddd' lt 1 lw 1\nset pointsize 1\n"
         << (plot.series.size() <= kMostBelow ? "set key below center horizontal maxcols 3 height 1 samplen 3\n"
                                              : "set key outside right top vertical\n");
  if (!plot.colour_bar.empty())
    script << "set palette defined (" << kScale << ")\nset cblabel " << quoted(plot.colour_bar) << "\n";
  if (plot.equal_scale) script << "set size ratio -1\n";
  write_axis(script, "x", plot.x);
  write_axis(script, "y", plot.y);
  write_guides(script, plot);
  write_curves(script, plot);
  return script.str();
}

}  // namespace soft_robot_lab
