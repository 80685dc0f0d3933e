// SPDX-License-Identifier: BSD-3-Clause
#include "python_simulation.h"

#include <filesystem>
#include <stdexcept>

#include <dlfcn.h>

#include "settings/find_program.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

// Beside this module, in the lib folder of the package, or as the programs find it.
std::string mesher() {
  Dl_info module{};
  if (dladdr(reinterpret_cast<const void*>(&mesher), &module) == 0 || !module.dli_fname) return "";
  const std::filesystem::path here = std::filesystem::absolute(module.dli_fname).parent_path();
  for (const std::filesystem::path& folder : {here, here / "../../../soft_robot_lab"})
    if (is_program(folder / "mesh_robot")) return (folder / "mesh_robot").lexically_normal();
  return "";
}

}  // namespace

SceneOptions python_scene_options() {
  SceneOptions options;
  options.mesher = mesher();
  options.actuator_factory = make_actuator;
  options.reduced = ReducedUse::trained;
  return options;
}

std::vector<ActuatorReading> shown_readings(SceneMotion& motion) {
  motion.show();
  std::vector<ActuatorReading> all;
  for (std::size_t i = 0; i < motion.simulation().actuators().size(); ++i)
    all.push_back(motion.simulation().actuator_state(static_cast<int>(i)));
  return all;
}

PythonSimulation::PythonSimulation(Scene scene)
    : scene_(std::move(scene)), motion_(std::make_unique<SceneMotion>(scene_)) {
  scene_.simulation->set_interrupt([this] { return watch().asked(); });
}

Scene PythonSimulation::copy_of_scene() {
  Scene copy;
  copy.file = scene_.file;
  copy.simulation = std::make_unique<Simulation>(scene_.simulation->model());
  copy.run = scene_.run;
  copy.warnings = scene_.warnings;
  copy.fidelity = scene_.fidelity;
  copy.reduction = scene_.reduction;
  return copy;
}

std::shared_ptr<PythonSimulation> PythonSimulation::clone() {
  const PythonState here = state();
  auto copy = std::make_shared<PythonSimulation>(copy_of_scene());
  copy->set_state(here);
  return copy;
}

void PythonSimulation::set(const NamedCommands& commands) {
  const Use use(*this);
  require_commands(model(), commands);
  for (const auto& [name, command] : commands) motion_->set_command(name, command);
}

SolveReport PythonSimulation::moved(SolveReport (SceneMotion::*solve)()) {
  const Use use(*this);
  SolveReport report = freely([&] { return ((*motion_).*solve)(); });
  keep_nodes_true();
  return report;
}

SolveReport PythonSimulation::step() { return moved(&SceneMotion::step); }
SolveReport PythonSimulation::settle() { return moved(&SceneMotion::solve_equilibrium); }

void PythonSimulation::reset() {
  const Use use(*this);
  motion_->reset();
  keep_nodes_true();
}

PythonState PythonSimulation::state() {
  const Use use(*this);
  return {motion_->place(), scene_.simulation->model()};
}

void PythonSimulation::set_state(const PythonState& state) {
  const Use use(*this);
  go_to_or_stay(*motion_, state);
  keep_nodes_true();
}

SceneMotion& PythonSimulation::shown() {
  motion_->show();
  return *motion_;
}

Eigen::Matrix3Xd PythonSimulation::markers_m() {
  const Use use(*this);
  return motion_->markers_m();
}

Eigen::MatrixXd PythonSimulation::sensitivities() {
  const Use use(*this);
  return freely([&] { return shown().simulation().marker_sensitivities(); });
}

double PythonSimulation::time_s() {
  const Use use(*this);
  return motion_->time_s();
}

std::vector<DriveState> PythonSimulation::drives() {
  const Use use(*this);
  return motion_->drives();
}

bool PythonSimulation::reduced() {
  const Use use(*this);
  return motion_->reduced();
}

std::vector<ActuatorReading> PythonSimulation::readings() {
  const Use use(*this);
  return shown_readings(*motion_);
}

std::vector<ContactReading> PythonSimulation::contacts() {
  const Use use(*this);
  return shown().simulation().contacts();
}

std::shared_ptr<const ShownNodes> PythonSimulation::nodes() {
  const Use use(*this);
  if (!nodes_) nodes_ = std::make_shared<ShownNodes>();
  nodes_->positions_m = shown().simulation().state().positions_m;
  return nodes_;
}

void PythonSimulation::keep_nodes_true() {
  if (nodes_.use_count() > 1) nodes_->positions_m = shown().simulation().state().positions_m;
}

PythonSimulation::Run PythonSimulation::run() {
  const Use use(*this);
  return freely([&] {
    Scene own = copy_of_scene();
    own.simulation->set_interrupt([this] { return watch().asked(); });
    Run run;
    run.report = run_scene(own, [this](double) { return !watch().asked(); });
    run.result_json = result_json(own, run.report);
    return run;
  });
}

}  // namespace soft_robot_lab
