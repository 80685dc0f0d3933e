// SPDX-License-Identifier: BSD-3-Clause
#include "verdict_page.h"

#include <cmath>
#include <filesystem>
#include <sstream>

#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

constexpr Paint kSilicone{0.95, 0.85, 0.72}, kBlocked{0.90, 0.15, 0.12}, kThin{0.98, 0.62, 0.10};

std::string numbers_of(const CastingTest& test) {
  std::ostringstream text;
  text.precision(4);
  for (const auto& [name, value] : test.numbers)
    if (std::isfinite(value)) text << (text.tellp() > 0 ? ", " : "") << name << " " << value;
  return text.str();
}

std::string row_of(const CastingTest& test) {
  const std::string by = test.by.empty() ? "" : " by " + test.by;
  const std::string verdict = test.passed ? "<td>passed" + by + "</td>" : "<td class=\"failed\">failed</td>";
  const std::string place = test.at_m ? place_text(*test.at_m) : "";
  return "<tr><td>" + test.name + "</td>" + verdict + "<td>" + html_escaped(test.why) + "</td><td>" + place +
         "</td><td>" + numbers_of(test) + "</td></tr>\n";
}

}  // namespace

std::vector<Paint> verdict_paints(const CastingVerdict& verdict, double min_thickness_m) {
  std::vector<Paint> paints;
  paints.reserve(verdict.thickness_m.size());
  for (const double thickness_m : verdict.thickness_m)
    paints.push_back(thickness_m < min_thickness_m * (1 - 1e-3) ? kThin : kSilicone);
  for (const int t : verdict.blocked) paints[static_cast<size_t>(t)] = kBlocked;
  return paints;
}

std::string verdict_picture_png(const CastingVerdict& verdict, double min_thickness_m, bool turned_over) {
  const std::vector<Paint> paints = verdict_paints(verdict, min_thickness_m);
  const auto paint_of = [&](int t) { return paints[static_cast<size_t>(t)]; };
  const Eigen::Matrix3d frame = frame_along(turned_over ? (-verdict.direction).eval() : verdict.direction);
  const Surface& judged = verdict.judged;
  return picture_png(make_surface(frame.transpose() * judged.vertices_m, judged.triangles), paint_of);
}

std::string verdict_html(const CastingVerdict& verdict, const std::string& robot_name) {
  std::ostringstream page;
  page << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" << html_escaped(robot_name)
       << "</title><style>td, th {padding: 0.2em 0.6em; text-align: left; vertical-align: top} "
          ".failed {color: #c01010; font-weight: bold}</style></head><body>\n<h1>"
       << html_escaped(robot_name) << (verdict.castable ? " can" : " cannot")
       << " be cast</h1>\n<p>Out of its mould along [" << (verdict.direction + Eigen::Vector3d::Zero()).transpose()
       << "]. Red: skin that the mould holds. Orange: silicone that is too thin.</p>\n"
          "<img src=\"from_above.png\" alt=\"from above\"> <img src=\"from_below.png\" alt=\"from below\">\n"
          "<table><tr><th>test</th><th></th><th>why</th><th>where</th><th>numbers</th></tr>\n";
  for (const CastingTest& test : verdict.tests) page << row_of(test);
  page << "</table></body></html>\n";
  return page.str();
}

void write_verdict(const CastingVerdict& verdict, const std::string& robot_name, double min_thickness_m,
                   const std::string& folder) {
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);  // where it fails, so does the first file
  write_file(folder + "/from_above.png", verdict_picture_png(verdict, min_thickness_m, false));
  write_file(folder + "/from_below.png", verdict_picture_png(verdict, min_thickness_m, true));
  write_file(folder + "/verdict.json", verdict_json(verdict));
  write_file(folder + "/verdict.html", verdict_html(verdict, robot_name));
}

}  // namespace soft_robot_lab
