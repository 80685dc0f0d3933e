// SPDX-License-Identifier: BSD-3-Clause
#include "surface_file.h"

#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "mesher_run.h"

namespace soft_robot_lab {
namespace {

void check(const SurfaceRequest& request) {
  if (!std::isfinite(request.largest_edge_m) || request.largest_edge_m <= 0)
    throw std::invalid_argument("largest_edge_m: " + std::to_string(request.largest_edge_m) +
                                " is out of range (0, inf)");
  if (!(request.edges_across >= 0 && request.edges_across <= 1000))
    throw std::invalid_argument("edges_across: " + std::to_string(request.edges_across) + " is out of range [0, 1000]");
  if (!(request.smallest_edge_m >= 0 && request.smallest_edge_m <= request.largest_edge_m))
    throw std::invalid_argument("smallest_edge_m: " + std::to_string(request.smallest_edge_m) +
                                " is out of range [0, largest_edge_m]");
  if (request.circle_segments < 6 || request.circle_segments > 360)
    throw std::invalid_argument("circle_segments: " + std::to_string(request.circle_segments) +
                                " is out of range [6, 360]");
}

}  // namespace

std::string surface_file_for(const SurfaceRequest& request, const MesherOptions& options) {
  check(request);
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);
  text << "solid: " << to_yaml(request.solid) << "\nsurface: {";
  if (request.edges_across > 0)
    text << "edges_across: " << request.edges_across;
  else
    text << "largest_edge_m: " << request.largest_edge_m;
  text << ", circle_segments: " << request.circle_segments;
  if (request.smallest_edge_m > 0) text << ", smallest_edge_m: " << request.smallest_edge_m;
  text << "}\n";
  return run_mesher(text.str(), referenced_files(request.solid), ".off", options);
}

std::string step_file_for(const Solid& solid, const MesherOptions& options) {
  return run_mesher("solid: " + to_yaml(solid) + "\nstep: true\n", referenced_files(solid), ".step", options);
}

}  // namespace soft_robot_lab
