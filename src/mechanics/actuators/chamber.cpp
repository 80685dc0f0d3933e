// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuators/chamber.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {
namespace {

constexpr double kMillilitre = 1e-6;   // m^3
constexpr double kFlattest = 1e-6;     // of the surface's size cubed: less counts as no volume
constexpr double kClosed = -1.0;       // in place of a step's length
constexpr double kLeastAmount = 0.05;  // of the initial amount of gas: what may be left when it is pumped out
constexpr double kLeastVolume = 1e-3;  // of the initial volume: a smaller one before a step counts as this one

std::vector<int> faces_of(const YamlNode& settings, const std::string& surface, const TetMesh& mesh) {
  std::string known;
  for (std::size_t i = 0; i < mesh.surface_names.size(); ++i) {
    known += (i == 0 ? "" : ", ") + mesh.surface_names[i];
    if (mesh.surface_names[i] != surface) continue;
    std::vector<int> faces;
    for (std::size_t face = 0; face < mesh.face_surface.size(); ++face)
      if (mesh.face_surface[face] == static_cast<int>(i)) faces.push_back(static_cast<int>(face));
    if (!faces.empty()) return faces;
  }
  settings.child("surface").fail("the mesh has no surface '" + surface +
                                 "'; known: " + (known.empty() ? "none" : known));
}

double size_m(const TetMesh& mesh, const std::vector<int>& faces) {
  Eigen::Vector3d least = mesh.nodes_m.col(mesh.faces(0, faces[0])), most = least;
  for (const int face : faces) {
    for (Eigen::Index i = 0; i < mesh.faces.rows(); ++i) {
      least = least.cwiseMin(mesh.nodes_m.col(mesh.faces(i, face)));
      most = most.cwiseMax(mesh.nodes_m.col(mesh.faces(i, face)));
    }
  }
  return (most - least).norm();
}

std::vector<int> nodes_of(const TetMesh& mesh, const std::vector<int>& faces) {
  std::set<int> nodes;
  for (const int face : faces) nodes.insert(mesh.faces.col(face).begin(), mesh.faces.col(face).end());
  return {nodes.begin(), nodes.end()};
}

}  // namespace

// A surface given by its solid bears the chamber's name (scene/mesh_section.cpp); one of a further body has that body's
// name before its own (add_body).
void Chamber::bind(const YamlNode& settings, const TetMesh& mesh) {
  const YamlNode surface = settings.child("surface");
  surface_ = surface.is_map() ? name() : settings.text("surface");
  const std::string body = settings.text_or("body", mesh.bodies.front());
  if (body != mesh.bodies.front()) surface_.insert(0, body + "/");
  const std::vector<int> faces = faces_of(settings, surface_, mesh);
  nodes_ = nodes_of(mesh, faces);
  try {
    const Supply& supply = *this;
    volume_ = std::make_unique<ChamberVolume>(EnclosedVolume(mesh, faces), supply);
  } catch (const std::invalid_argument& error) {
    surface.fail(error.what());
  }
  initial_volume_m3_ = volume_->volume_m3(mesh.nodes_m);
  const double least_m3 = kFlattest * std::pow(size_m(mesh, faces), 3);
  if (initial_volume_m3_ >= least_m3) return;
  std::ostringstream message;
  message << "encloses a volume of " << initial_volume_m3_ << " m^3; must be above " << least_m3
          << " m^3: the surface bounds a hollow of the body from outside it";
  surface.fail(message.str());
}

// What is connected to the chamber: other commands leave it unused, so that a robot's file can be laid over with them.
void Chamber::read_syringe(const YamlNode& settings, bool required) {
  if (!required && !settings.has("syringe_volume_ml")) return;
  syringe_volume_m3_ = kMillilitre * settings.number("syringe_volume_ml", AllowedRange::positive());
  tube_volume_m3_ = kMillilitre * settings.number_or("tube_volume_ml", 0.0, AllowedRange::not_negative());
}

void Chamber::read_command(const YamlNode& settings) {
  const std::string command =
      settings.choice_or("command", "beta", {"beta", "syringe", "volume_offset", "gauge_pressure"});
  const double initial_ml = initial_volume_m3_ / kMillilitre;
  const double flow_ml_s = settings.number_or("flow_ml_s", 0.0, AllowedRange::not_negative());
  flow_m3_s_ = flow_ml_s * kMillilitre;
  command_speed_ = flow_ml_s;
  const double infinite = std::numeric_limits<double>::infinity();
  read_syringe(settings, command == "syringe");
  if (command == "beta") {
    kind_ = Command::beta;
    limits_ = {1.0, settings.number_or("min_beta", kLeastAmount, {0.0, 1.0, true}),
               settings.number_or("max_beta", 5.0, {1.0, infinite}), "1"};
    command_speed_ = flow_ml_s / initial_ml;
  } else if (command == "syringe") {
    kind_ = Command::syringe;
    limits_ = {0.0, 0.0 - settings.number_or("max_pull_ml", 0.0, AllowedRange::not_negative()),
               syringe_volume_m3_ / kMillilitre, "ml"};
  } else if (command == "volume_offset") {
    kind_ = Command::volume_offset;
    const double least_ml = -(1.0 - kLeastAmount) * initial_ml;
    limits_ = {0.0, settings.number_or("min_offset_ml", least_ml, {least_ml, 0.0}),
               settings.number_or("max_offset_ml", 4.0 * initial_ml, AllowedRange::not_negative()), "ml"};
  } else {
    kind_ = Command::gauge_pressure;
    const double least_pa = -(1.0 - kLeastAmount) * initial_pressure_pa_;
    limits_ = {0.0, settings.number_or("min_gauge_pressure_pa", 0.0, {least_pa, 0.0}),
               settings.number_or("max_gauge_pressure_pa", 20000.0, AllowedRange::not_negative()), "Pa"};
    command_speed_ = 0.0;  // the flow's limit bounds the amount of gas
  }
}

void Chamber::on_initialise(const YamlNode& settings, const Body& body, const MeshLocator&) {
  explicit_ = settings.choice_or("model", "implicit", {"implicit", "explicit"}) == "explicit";
  initial_pressure_pa_ = settings.number_or("initial_pressure_pa", initial_pressure_pa_, AllowedRange::positive());
  bind(settings, body.mesh());
  node_count_ = body.mesh().node_count();
  read_command(settings);
  if (explicit_ && kind_ == Command::gauge_pressure)
    settings.child("model").fail("a regulated pressure does not depend on the volume; must be implicit");
}

IsothermalGas Chamber::gas_at(double command) const {
  IsothermalGas gas;
  gas.outside_pressure_pa = initial_pressure_pa_;
  gas.amount_j = initial_pressure_pa_ * initial_volume_m3_;
  switch (kind_) {
    case Command::beta:
      gas.amount_per_command = gas.amount_j;
      gas.amount_j *= command;
      break;
    case Command::volume_offset:
      gas.amount_per_command = initial_pressure_pa_ * kMillilitre;
      gas.amount_j += command * gas.amount_per_command;
      break;
    case Command::syringe:
      gas.dead_volume_per_command = -kMillilitre;
      gas.amount_j += initial_pressure_pa_ * (syringe_volume_m3_ + tube_volume_m3_);
      gas.dead_volume_m3 = syringe_volume_m3_ + tube_volume_m3_ - command * kMillilitre;
      break;
    case Command::gauge_pressure:
      break;
  }
  return gas;
}

// The length of the step (0 in a search for a rest state, kClosed with a closed valve); then where it began the amount
// of gas [J], which a regulator starts from, or the places of the nodes, where the pressure is explicit. Empty for all
// others.
Eigen::VectorXd Chamber::initial_memory() const {
  if (kind_ == Command::gauge_pressure) return Eigen::Vector2d(0.0, initial_pressure_pa_ * initial_volume_m3_);
  return Eigen::VectorXd::Zero(explicit_ ? 1 + 3 * node_count_ : 0);
}

void Chamber::begin_step(const StepStart& start, DriveState& drive) const {
  if (drive.memory.size() == 0) return;
  drive.memory[0] = std::isfinite(start.time_step_s) ? start.time_step_s : 0.0;
  if (explicit_) {
    drive.memory.tail(3 * node_count_) = Eigen::Map<const Eigen::VectorXd>(start.positions_m.data(), 3 * node_count_);
  } else {
    drive.memory[1] = gas_j(start);
  }
}

double Chamber::gas_j(const StepStart& at) const {
  return (initial_pressure_pa_ - at.multipliers.at(0)) * volume_->volume_m3(at.positions_m);
}

bool Chamber::keep_supply(double share, const StepStart& now, DriveState& drive) const {
  if (kind_ != Command::gauge_pressure) return false;
  drive.memory << kClosed, share * gas_j(now);
  return true;
}

std::optional<Eigen::Matrix3Xd> Chamber::load_positions_m(const DriveState& drive) const {
  if (!explicit_ || drive.memory[0] == 0.0) return std::nullopt;
  return Eigen::Map<const Eigen::Matrix3Xd>(drive.memory.data() + 1, 3, node_count_);
}

GasSupply Chamber::regulated(const DriveState& drive) const {
  GasSupply supply;
  supply.regulated = true;
  supply.prescribed_pressure_pa = drive.actuated_command;
  supply.gas = supply.most_gas = gas_at(drive.actuated_command);
  const double time_step_s = drive.memory[0], amount_before_j = drive.memory[1];
  if (time_step_s == kClosed) {
    supply.gas.amount_j = supply.most_gas.amount_j = amount_before_j;
    return supply;
  }
  const bool limited = time_step_s > 0.0 && flow_m3_s_ > 0.0;
  const double reach_j =
      limited ? initial_pressure_pa_ * flow_m3_s_ * time_step_s : std::numeric_limits<double>::infinity();
  const double least_j = kLeastAmount * initial_pressure_pa_ * initial_volume_m3_;
  supply.gas.amount_j =
      limited ? std::max(amount_before_j - reach_j, least_j) : -std::numeric_limits<double>::infinity();
  supply.most_gas.amount_j = amount_before_j + reach_j;
  return supply;
}

GasSupply Chamber::supply(const DriveState& drive) const {
  if (kind_ == Command::gauge_pressure) return regulated(drive);
  GasSupply supply;
  supply.gas = gas_at(drive.actuated_command);
  if (const std::optional<Eigen::Matrix3Xd> before_m = load_positions_m(drive)) {
    supply.load = true;
    const double before_m3 = std::max(volume_->volume_m3(*before_m), kLeastVolume * initial_volume_m3_);
    supply.prescribed_pressure_pa = supply.gas.gauge_pressure_pa(before_m3);
  }
  return supply;
}

ActuatorReading Chamber::observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers,
                                 const DriveState& drive) const {
  ActuatorReading reading;
  reading.volume_m3 = volume_->volume_m3(positions_m);
  reading.initial_volume_m3 = initial_volume_m3_;
  reading.gauge_pressure_pa = 0.0 - multipliers.at(0);  // no -0 where there is none
  reading.surface = surface_;
  reading.center_m = Eigen::Vector3d::Zero();
  for (const int node : nodes_) *reading.center_m += positions_m.col(node) / static_cast<double>(nodes_.size());
  if (kind_ == Command::gauge_pressure) return reading;
  const IsothermalGas gas = gas_at(drive.actuated_command);
  reading.gas_residual =
      (initial_pressure_pa_ - multipliers.at(0)) * (*reading.volume_m3 + gas.dead_volume_m3) / gas.amount_j - 1.0;
  return reading;
}

}  // namespace soft_robot_lab
