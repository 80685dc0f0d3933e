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
    if (jacobian) {
      const Eigen::MatrixXd sensitivities = simulation_.marker_sensitivities();
      jacobian->resize(3, commands.size());
      for (size_t i = 0; i < actuators_.size(); ++i) {
        jacobian->col(static_cast<Eigen::Index>(i)) = sensitivities.block<3, 1>(3 * marker_, actuators_[i]);
      }
    }
  } catch (...) {
    simulation_.set_state(last_good);
    throw;
  }
  return simulation_.marker_position(marker_);
}

}  // namespace soft_robot_lab
