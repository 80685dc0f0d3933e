// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "emulated_lab.h"
#include "control/identification/simulated_now.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {
namespace {

constexpr double kLongestWay_s = 60.0;

void follow(Simulation& model, const std::vector<double>& commands) {
  for (std::size_t i = 0; i < commands.size(); ++i) model.set_command(model.actuators()[i]->name(), commands[i]);
  const double latest_s = model.state().time_s + kLongestWay_s;
  while (!all_arrived(model) && model.state().time_s < latest_s) model.step();
  const SolveReport report = model.solve_equilibrium();
  if (!report.converged) throw std::runtime_error("the model finds no rest: " + report.message);
}

// Each node moves as its mirror image has moved.
Eigen::Matrix3Xd mirrored(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m, int axis) {
  const MeshLocator locator(mesh);
  const Eigen::Matrix3Xd moved_m = positions_m - mesh.nodes_m;
  Eigen::Matrix3Xd result_m = mesh.nodes_m;
  for (Eigen::Index node = 0; node < result_m.cols(); ++node) {
    Eigen::Vector3d image_m = mesh.nodes_m.col(node);
    image_m[axis] = -image_m[axis];
    Eigen::Vector3d move_m = locator.embed(image_m).at(moved_m);
    move_m[axis] = -move_m[axis];
    result_m.col(node) += move_m;
  }
  return result_m;
}

}  // namespace

MarkerPlaces marker_places(const Simulation& simulation) {
  MarkerPlaces places_m;
  for (const Marker& marker : simulation.markers())
    places_m[marker.name()] = marker.position(simulation.state().positions_m);
  return places_m;
}

RestRecord record_at_rest(EmulatedLab& lab, Simulation& model, const std::vector<double>& commands) {
  RestRecord record;
  for (const auto& actuator : model.actuators()) record.actuators.push_back(actuator->name());
  if (commands.size() != record.actuators.size())
    throw std::invalid_argument("the model has " + std::to_string(record.actuators.size()) + " actuators, not " +
                                std::to_string(commands.size()));
  record.commands = commands;
  lab.go(record.actuators, commands);
  follow(model, commands);
  record.true_m = lab.plant().markers_m();
  record.simulated_m = marker_places(model);
  record.measured_m = lab.measure(record.simulated_m);
  return record;
}

std::optional<MarkerPlaces> rest_from_mirror_image(Simulation& model, int axis) {
  const SimulationState here = model.state();
  SimulationState there = here;
  there.positions_m = mirrored(model.body().mesh(), here.positions_m, axis);
  there.velocities_m_s.setZero();
  there.rest_residual.reset();
  there.linearisation.reset();
  model.set_state(there);
  const bool rests = model.solve_equilibrium().converged;
  const MarkerPlaces places_m = marker_places(model);
  model.set_state(here);
  return rests ? std::optional(places_m) : std::nullopt;
}

}  // namespace soft_robot_lab
