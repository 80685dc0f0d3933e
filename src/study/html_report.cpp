// SPDX-License-Identifier: BSD-3-Clause
#include "session/report/html_page.h"
#include "report.h"

namespace soft_robot_lab {
namespace {

void add(const ExperimentReport& report, HtmlPage& page) {
  const ExperimentResult& result = report.result;
  page.heading(report.name + ": " + result.title, report.name);
  if (!result.converged) page.failure("Did not converge: " + result.message);
  page.table(result.table);
  page.paragraph(source_column(result), "The source reports:");
  if (!result.we_differ.empty()) page.paragraph(result.we_differ, "Our set-up differs:");
  if (!result.we_find.empty()) page.paragraph(result.we_find, "We find:");
  for (const PlotFiles& files : report.pictures) page.pictures({files.svg});
}

// What the source reports beside what we find, one experiment a row.
Table overview(const std::vector<ExperimentReport>& reports) {
  Table table{{{"experiment"}, {"the source reports"}, {"we find"}, {"our set-up differs"}}, {}};
  for (const ExperimentReport& report : reports) {
    const ExperimentResult& result = report.result;
    table.rows.push_back({report.name, source_column(result), result.we_find, result.we_differ});
  }
  return table;
}

}  // namespace

std::string experiments_html(const std::vector<ExperimentReport>& reports) {
  HtmlPage page("Experiments");
  for (const ExperimentReport& report : reports) page.link(report.name + ": " + report.result.title, report.name);
  if (reports.size() > 1) page.table(overview(reports));
  for (const ExperimentReport& report : reports) add(report, page);
  return page.html();
}

}  // namespace soft_robot_lab
