// SPDX-License-Identifier: BSD-3-Clause
#include "study/report.h"

#include <sstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "robot/scene/scene_files.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

ExperimentReport sample() {
  ExperimentReport report;
  report.name = "4.3.2";
  report.result.title = "Stiffness <k>";
  report.result.table = {{{"model"}, {"k [N/m]"}, {"length [mm]", 6}},
                         {{"sliding", 1000.0, 123.45678}, {"größer", 25000.0, 123.5}}};
  report.result.numbers["worst"] = 0.25;
  report.result.source_reports = "the cable oscillates.";
  report.result.we_differ = "our bar is chosen.";
  report.result.we_find = "it does not.";
  return report;
}

TEST(Report, PrintsColumnsUnderEachOther) {
  std::ostringstream out;
  print_table(sample().result.table, out);
  EXPECT_EQ(out.str(),
            "model    k [N/m]  length [mm]\n"
            "-------  -------  -----------\n"
            "sliding     1000      123.457\n"
            "größer   2.5e+04        123.5\n");
}

TEST(Report, RefusesARowOfAnotherLength) {
  std::ostringstream out;
  EXPECT_THROW(print_table({{{"one"}, {"two"}}, {{1.0}}}, out), std::invalid_argument);
}

TEST(Report, WritesTheTableAsJson) {
  const Json json = Json::parse(experiments_json({sample()}));
  EXPECT_EQ(json["title"], "Stiffness <k>");
  EXPECT_EQ(json["converged"], true);
  EXPECT_EQ(json["table"][0]["model"], "sliding");
  EXPECT_EQ(json["table"][1]["k [N/m]"], 25000.0);
  EXPECT_EQ(json["worst"], 0.25);
}

TEST(Report, NamesSeveralExperimentsInJson) {
  ExperimentReport other = sample();
  other.name = "cantilever";
  other.result.converged = false;
  const Json json = Json::parse(experiments_json({sample(), other}));
  EXPECT_EQ(json["4.3.2"]["converged"], true);
  EXPECT_EQ(json["cantilever"]["converged"], false);
}

TEST(Report, SaysInEveryRowOfItsOverviewWhatTheSourceReports) {
  ExperimentReport ours = sample();
  ours.name = "cantilever";
  ours.result.source_reports = "";
  const std::string page = experiments_html({sample(), ours});
  EXPECT_NE(page.find("<td>the cable oscillates.</td><td>it does not.</td><td>our bar is chosen.</td>"),
            std::string::npos);
  EXPECT_NE(page.find("<td>The source has no such experiment.</td>"), std::string::npos);
  const Json json = Json::parse(experiments_json({sample(), ours}));
  EXPECT_EQ(json["4.3.2"]["source_reports"], "the cable oscillates.");
  EXPECT_EQ(json["cantilever"]["source_reports"], "The source has no such experiment.");
}

TEST(Report, HoldsWordsAndPicturesInOnePage) {
  const SceneFolder folder;
  ExperimentReport report = sample();
  report.pictures.push_back({folder.write("a.svg", "<svg/>"), "", ""});
  const std::string page = experiments_html({report});
  for (const std::string words :
       {"Stiffness &lt;k&gt;", "<b>The source reports:</b> the cable oscillates.", "<b>We find:</b> it does not.",
        "<td class=\"number\">123.457</td>", "data:image/svg+xml;base64,PHN2Zy8+\""}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace soft_robot_lab
