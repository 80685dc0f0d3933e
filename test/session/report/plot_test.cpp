// SPDX-License-Identifier: BSD-3-Clause
#include "session/report/plot.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "robot/scene/scene_files.h"

namespace soft_robot_lab {
namespace {

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

Plot sample() {
  Plot plot{"sample", "Sag of a robot's arm", {"element size [mm]", true}, {"error, relative [%]"}};
  plot.series.push_back({"quadratic", {5, 10, 20}, {0.1, 0.5, 2.0}, SeriesStyle::lines_points});
  plot.series.push_back({"elsewhere", {10}, {3}, SeriesStyle::points, -1, {"Müller's 10_node"}});
  return plot;
}

TEST(Plot, WritesItsPointsAsCsv) {
  const SceneFolder folder;
  const PlotFiles files = write_plot(sample(), folder.path("pictures"));
  EXPECT_EQ(contents(files.csv),
            "series,element size [mm],\"error, relative [%]\"\n"
            "quadratic,5,0.1\nquadratic,10,0.5\nquadratic,20,2\nelsewhere: Müller's 10_node,10,3\n");
}

TEST(Plot, WritesAndDrawsDeviations) {
  const SceneFolder folder;
  Plot plot{"bars", "bars", {"marker"}, {"distance [px]"}};
  plot.series.push_back({"mean", {1, 2}, {0.5, 0.75}, SeriesStyle::bars, -1, {}, {0.25, 0.125}});
  const PlotFiles with = write_plot(plot, folder.path("with"));
  EXPECT_EQ(contents(with.csv), "series,marker,distance [px],deviation\nmean,1,0.5,0.25\nmean,2,0.75,0.125\n");
  plot.series.front().deviations.clear();
  const PlotFiles without = write_plot(plot, folder.path("without"));
  EXPECT_NE(contents(with.svg), contents(without.svg));
  EXPECT_EQ(contents(without.csv).find("deviation"), std::string::npos);
}

TEST(Plot, DrawsAllItsWords) {
  const SceneFolder folder;
  const PlotFiles files = write_plot(sample(), folder.path("pictures"));
  const std::string svg = contents(files.svg);
  for (const std::string word : {"Sag of a robot's arm", "element size [mm]", "error, relative [%]", "quadratic",
                                 "elsewhere", "Müller's 10_node"}) {
    EXPECT_NE(svg.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(contents(files.png).substr(1, 3), "PNG");
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path("pictures"))) {
    ++count;
    EXPECT_EQ(entry.path().stem(), "sample") << "nothing else is left behind";
  }
  EXPECT_EQ(count, 3);
}

// Names of a recording may hold anything.
TEST(Plot, DrawsLabelsOfAnyCharacters) {
  const SceneFolder folder;
  Plot plot = sample();
  for (Series& series : plot.series) {
    series.label = std::string("it's \"a\" \\ `b` \0 c\n\r d", 22);
    series.point_labels.assign(series.x.size(), series.label);
  }
  EXPECT_EQ(contents(write_plot(plot, folder.path("pictures")).png).substr(1, 3), "PNG");
}

// gnuplot reads two quotes in a row in its own way.
TEST(Plot, DrawsQuotesWhereverTheyStand) {
  const SceneFolder folder;
  for (const std::string name : {"'", "''", "'a", "a'", "a''b", "'a' 'b'", "\"'", "'`date`"}) {
    Plot plot = sample();
    plot.title = plot.x.label = plot.y.label = plot.series[0].label = name;
    plot.x.ticks = {{0.0, name}, {1.0, name}};
    const PlotFiles files = write_plot(plot, folder.path("it's ''here"));
    EXPECT_EQ(contents(files.png).substr(1, 3), "PNG") << name;
  }
}

TEST(Plot, DrawsEveryStyle) {
  const SceneFolder folder;
  Plot plot{"styles", "styles", {"x"}, {"y"}};
  for (const SeriesStyle style :
       {SeriesStyle::lines, SeriesStyle::dashes, SeriesStyle::points, SeriesStyle::lines_points,
        SeriesStyle::dashes_points, SeriesStyle::bars, SeriesStyle::crosses, SeriesStyle::squares}) {
    plot.series.push_back({"style " + std::to_string(plot.series.size()), {1, 2}, {1, 3}, style});
  }
  plot.x.ticks = {{1, "first"}, {2, "second"}};
  plot.y.guides = {2};
  const std::string svg = contents(write_plot(plot, folder.path("pictures")).svg);
  for (const std::string word : {"style 0", "style 5", "style 6", "first", "second"}) {
    EXPECT_NE(svg.find(word), std::string::npos) << word;
  }
}

// Beside one another they would overlap.
TEST(Plot, TurnsLabelsThatAreMany) {
  const SceneFolder folder;
  const auto turned = [&](int count, const std::string& how) {
    Plot plot{"labels", "labels", {"x"}, {"y"}};
    for (int i = 0; i < count; ++i) plot.x.ticks.emplace_back(i, "contraction 1 to 0.5 at once");
    plot.x.min = -0.5;
    plot.x.max = count - 0.5;
    plot.series.push_back({"all", {0, 1}, {0, 1}, SeriesStyle::squares});
    const std::string svg = contents(write_plot(plot, folder.path(std::to_string(count))).svg);
    int found = 0;
    for (std::size_t at = svg.find(how); at != std::string::npos; at = svg.find(how, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(turned(3, ") rotate("), 1) << "but for the word of the y axis";
  EXPECT_EQ(turned(8, ") rotate(-30)"), 8);
  EXPECT_GE(turned(25, ") rotate(-90)"), 25);
}

// Long words of the y axis push it to the right.
TEST(Plot, KeepsItsKeyInThePicture) {
  const SceneFolder folder;
  Plot plot{"key", "key", {}, {}};
  plot.width_px = 1336;
  plot.y.ticks = {{0, "cantilever: newton, linear elements"}};
  for (const std::string label : {"survived", "recovered", "failed and said so", "too slow"})
    plot.series.push_back({label, {0, 1}, {0, 1}, SeriesStyle::squares});
  const cv::Mat picture = cv::imread(write_plot(plot, folder.path("pictures")).png);
  ASSERT_EQ(picture.cols, plot.width_px);
  double darkest = 0.0;
  cv::minMaxLoc(picture.col(picture.cols - 1).clone().reshape(1), &darkest);
  EXPECT_EQ(darkest, 255) << "something goes on beyond the picture's edge";
}

TEST(Plot, ColoursPointsAndSquaresByTheirValues) {
  const SceneFolder folder;
  Plot plot{"values", "values", {"x"}, {"y"}};
  plot.colour_bar = "tension [N]";
  plot.equal_scale = true;
  plot.series = {{"squares", {1, 2}, {1, 1}, SeriesStyle::squares}, {"", {1, 2}, {2, 2}, SeriesStyle::points}};
  plot.series[0].values = {0, 5};
  plot.series[1].values = {1, 4};
  const PlotFiles files = write_plot(plot, folder.path("pictures"));
  const std::string svg = contents(files.svg);
  for (const std::string word : {"tension [N]", "rgb( 68,   1,  84)", "rgb(253, 231,  37)"})
    EXPECT_NE(svg.find(word), std::string::npos) << word;
  EXPECT_EQ(contents(files.csv).substr(0, 37), "series,x,y,tension [N]\nsquares,1,1,0\n");
}

TEST(Plot, RefusesWhatCannotBeDrawn) {
  const SceneFolder folder;
  const auto refusal = [&](const auto& change) -> std::string {
    Plot plot = sample();
    change(plot);
    try {
      write_plot(plot, folder.path("refused"));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string start = "plot 'sample': ", quadratic = start + "series 'quadratic' ";
  EXPECT_EQ(refusal([](Plot& p) { p.series.clear(); }), start + "has no series");
  EXPECT_EQ(refusal([](Plot& p) { p.series[0].x.clear(); }), quadratic + "is empty");
  EXPECT_EQ(refusal([](Plot& p) { p.series[0].y.pop_back(); }), quadratic + "has unequal numbers of x and y");
  EXPECT_EQ(refusal([](Plot& p) { p.series[0].y[1] = std::numeric_limits<double>::quiet_NaN(); }),
            start + "series 'quadratic': y is not finite");
  EXPECT_EQ(refusal([](Plot& p) {
              p.colour_bar = "v";
              p.series[0].values = {1};
            }),
            quadratic + "has values for some of its points only, or labels beside them");
  EXPECT_EQ(refusal([](Plot& p) { p.series[0].values = p.series[0].y; }),
            start + "has values, but no label of their colour bar");
  EXPECT_NE(refusal([](Plot& p) { p.series[0].x[1] = 0.0; }).find("must be above 0 on a logarithmic axis"),
            std::string::npos);
  EXPECT_NE(refusal([](Plot& p) { p.name = "a/b"; }).find("must be that of a file"), std::string::npos);
  EXPECT_NE(refusal([](Plot& p) { p.series[0].point_labels = {"one"}; }).find("for some of its points only"),
            std::string::npos);
}

TEST(Plot, SaysWhatToInstallWhereGnuplotIsMissing) {
  const SceneFolder folder;
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  std::string message;
  try {
    write_plot(sample(), folder.path("pictures"));
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(message.find("apt-get install gnuplot-nox"), std::string::npos) << message;
  EXPECT_TRUE(std::filesystem::exists(folder.path("pictures/sample.csv"))) << "the numbers are kept";
}

TEST(Histogram, CountsEveryValueOnce) {
  const Series bars = histogram("quality", {-1.0, 0.0, 0.24, 0.25, 0.6, 1.0, 1.0, 7.0}, 0.0, 1.0, 4);
  EXPECT_EQ(bars.x, (std::vector<double>{0.125, 0.375, 0.625, 0.875}));
  EXPECT_EQ(bars.y, (std::vector<double>{3, 1, 1, 3}));
  EXPECT_THROW(histogram("quality", {0.5}, 1.0, 1.0, 4), std::invalid_argument);
  EXPECT_THROW(histogram("quality", {0.5}, 0.0, 1.0, 0), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
