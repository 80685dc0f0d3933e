#include "soft_robot_lab/experiment/html_page.h"
#include "soft_robot_lab/experiment/report.h"

namespace soft_robot_lab {
namespace {

void add(const ExperimentReport& report, HtmlPage& page) {
  const ExperimentResult& result = report.result;
  page.heading(report.name + ": " + result.title, report.name);
  if (!result.converged) page.failure("Did not converge: " + result.message);
  page.table(result.table);
  if (!result.source_reports.empty()) page.paragraph(result.source_reports, "The source reports:");
  if (!result.we_find.empty()) page.paragraph(result.we_find, "We find:");
  for (const PlotFiles& files : report.pictures) page.pictures({files.svg});
}

}  // namespace

std::string experiments_html(const std::vector<ExperimentReport>& reports) {
  HtmlPage page("Experiments");
  for (const ExperimentReport& report : reports) page.link(report.name + ": " + report.result.title, report.name);
  for (const ExperimentReport& report : reports) add(report, page);
  return page.html();
}

}  // namespace soft_robot_lab
