#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {

ForwardModel::ForwardModel(Simulation& simulation, const std::string& marker, const std::vector<std::string>& actuators)
    : simulation_(simulation), marker_(simulation.marker_index(marker)) {
  for (const std::string& actuator : actuators) actuators_.push_back(simulation.actuator_index(actuator));
}

Eigen::Vector3d ForwardModel::marker(const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian) {
  if (commands.size() != static_cast<Eigen::Index>(actuators_.size())) {
    throw std::invalid_argument("commands: " + std::to_string(commands.size()) + " given, must be " +
                                std::to_string(actuators_.size()));
  }
  const SimulationState last_good = simulation_.state();
  try {
    for (size_t i = 0; i < actuators_.size(); ++i) {
      simulation_.set_command(simulation_.actuators()[actuators_[i]]->name(), commands[static_cast<Eigen::Index>(i)]);
    }
    const SolveReport report = simulation_.solve_equilibrium();
    if (!report.converged) throw ForwardModelError(report.message);
    if (jacobian) *jacobian = sensitivities();
  } catch (...) {
    simulation_.set_state(last_good);
    throw;
  }
  return simulation_.marker_position(marker_);
}

Eigen::Matrix3Xd ForwardModel::sensitivities() const {
  Eigen::MatrixXd all;
  try {
    all = simulation_.marker_sensitivities();
  } catch (const std::runtime_error& error) {
    throw ForwardModelError(error.what());
  }
  Eigen::Matrix3Xd picked(3, actuators_.size());
  for (size_t i = 0; i < actuators_.size(); ++i) {
    picked.col(static_cast<Eigen::Index>(i)) = all.block<3, 1>(3 * marker_, actuators_[i]);
  }
  return picked;
}

}  // namespace soft_robot_lab
