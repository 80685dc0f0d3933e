#include "soft_robot_lab/rig/emulated_lab.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

constexpr double kAnotherRest_m = 0.002;

// Mean square distance of the markers that both have; of none that is infinite.
double apart_m2(const MarkerPlaces& measured_m, const MarkerPlaces& simulated_m) {
  double sum_m2 = 0.0;
  for (const auto& [name, place_m] : measured_m) sum_m2 += (simulated_m.at(name) - place_m).squaredNorm();
  return measured_m.empty() ? std::numeric_limits<double>::infinity() : sum_m2 / static_cast<double>(measured_m.size());
}

void pull_from_hanging(Simulation& simulation, const std::vector<std::string>& actuators,
                       const std::vector<double>& contractions) {
  simulation.reset();
  simulation.solve_equilibrium();
  for (std::size_t i = 0; i < actuators.size(); ++i) simulation.set_command(actuators[i], contractions[i]);
  const SolveReport report = simulation.solve_equilibrium();
  if (!report.converged) throw std::runtime_error("the model finds no rest: " + report.message);
}

double farthest_m(const MarkerPlaces& one, const MarkerPlaces& other) {
  double most_m = 0.0;
  for (const auto& [name, place_m] : one) most_m = std::max(most_m, (other.at(name) - place_m).norm());
  return most_m;
}

// Where the model rests: from hanging, and where those that lean end at another place.
std::vector<MarkerPlaces> rest_places(Simulation& model, const std::vector<Simulation*>& leaning,
                                      const std::vector<std::string>& actuators,
                                      const std::vector<double>& contractions) {
  pull_from_hanging(model, actuators, contractions);
  std::vector<MarkerPlaces> places = {marker_places(model)};
  for (Simulation* other : leaning) {
    pull_from_hanging(*other, actuators, contractions);
    SimulationState state = other->state();
    state.rest_residual.reset();  // it rested under another gravity
    model.set_state(state);
    if (!model.solve_equilibrium().converged) continue;
    const MarkerPlaces there_m = marker_places(model);
    if (std::all_of(places.begin(), places.end(),
                    [&](const MarkerPlaces& known) { return farthest_m(known, there_m) > kAnotherRest_m; }))
      places.push_back(there_m);
  }
  return places;
}

}  // namespace

MarkerPlaces marker_places(const Simulation& simulation) {
  MarkerPlaces places_m;
  for (const Marker& marker : simulation.markers())
    places_m[marker.name()] = marker.position(simulation.state().positions_m);
  return places_m;
}

RestRecord record_at_rest(EmulatedLab& lab, Simulation& model, const std::vector<double>& contractions,
                          const std::vector<Simulation*>& leaning) {
  RestRecord record;
  for (const auto& actuator : model.actuators()) record.actuators.push_back(actuator->name());
  if (contractions.size() != record.actuators.size())
    throw std::invalid_argument("the model has " + std::to_string(record.actuators.size()) + " actuators, not " +
                                std::to_string(contractions.size()));
  record.contractions = contractions;
  lab.go(record.actuators, contractions);
  record.true_m = lab.reality().markers_m();
  double nearest_m2 = 0.0;
  for (const MarkerPlaces& simulated_m : rest_places(model, leaning, record.actuators, contractions)) {
    const MeasuredMarkers measured_m = lab.measure(simulated_m);
    const double m2 = apart_m2(measured_m, simulated_m);
    const bool better = record.simulated_m.empty() || measured_m.size() > record.measured_m.size() ||
                        (measured_m.size() == record.measured_m.size() && m2 < nearest_m2);
    if (!better) continue;
    nearest_m2 = m2;
    record.measured_m = measured_m;
    record.simulated_m = simulated_m;
  }
  return record;
}

}  // namespace soft_robot_lab
