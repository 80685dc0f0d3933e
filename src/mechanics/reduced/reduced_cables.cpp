// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_cables.h"

#include <stdexcept>

namespace soft_robot_lab {
namespace {

const PathLength& frictionless_length(const Actuator& actuator, const Constraint* constraint) {
  const auto* length = dynamic_cast<const PathLength*>(constraint);
  if (length && actuator.friction_contacts().empty() && actuator.rest_state().memory.size() == 0) return *length;
  throw std::invalid_argument("actuator '" + actuator.name() +
                              "': a reduced model knows only cables of model sliding, or springs without damping");
}

}  // namespace

ReducedCables::ReducedCables(const Model& model, const Eigen::MatrixXd& modes) : modes_(modes.cols()) {
  for (std::size_t i = 0; i < model.actuators().size(); ++i)
    for (const Constraint* constraint : model.actuators()[i]->constraints())
      add_cable(frictionless_length(*model.actuators()[i], constraint), i, model.body().mesh().nodes_m, modes);
}

void ReducedCables::add_cable(const PathLength& length, std::size_t actuator, const Eigen::Matrix3Xd& rest_positions_m,
                              const Eigen::MatrixXd& modes) {
  const std::vector<EmbeddedPoint>& points = length.path().points();
  const auto rows = static_cast<Eigen::Index>(3 * points.size());
  const Eigen::Matrix3Xd rest = length.path().places(rest_positions_m);
  Cable cable{
      &length, actuator, Eigen::Map<const Eigen::VectorXd>(rest.data(), rows), Eigen::MatrixXd::Zero(rows, modes_), {}};
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t k = 0; k < points[p].nodes.size(); ++k)
      cable.places.middleRows<3>(static_cast<Eigen::Index>(3 * p)) +=
          points[p].weights[k] * modes.middleRows<3>(3 * points[p].nodes[k]);
  for (Eigen::Index row = 3; row < rows; row += 3)
    cable.spans.push_back(cable.places.middleRows<3>(row) - cable.places.middleRows<3>(row - 3));
  cables_.push_back(std::move(cable));
}

ReducedCables::Values ReducedCables::at(const Eigen::VectorXd& q, const Eigen::VectorXd& tensions_n,
                                        const DriveStates& drives) const {
  Values result;
  result.gradients.setZero(modes_, static_cast<Eigen::Index>(count()));
  for (std::size_t c = 0; c < count(); ++c) {
    const Cable& cable = cables_[c];
    const auto column = static_cast<Eigen::Index>(c);
    const Eigen::VectorXd places = cable.rest_places_m + cable.places * q;
    result.spans.push_back(
        cable.length->path().spans_between(Eigen::Map<const Eigen::Matrix3Xd>(places.data(), 3, places.size() / 3)));
    double length_m = 0.0;
    for (std::size_t i = 0; i < cable.spans.size(); ++i) {
      length_m += result.spans[c][i].length_m;
      result.gradients.col(column).noalias() += cable.spans[i].transpose() * result.spans[c][i].direction;
    }
    result.laws.push_back(cable.length->law(length_m, tensions_n[column], drives[cable.actuator]));
  }
  return result;
}

Eigen::MatrixXd ReducedCables::hessian(const Values& values, const Eigen::VectorXd& tensions_n) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(modes_, modes_);
  for (std::size_t c = 0; c < count(); ++c)
    for (std::size_t i = 0; i < cables_[c].spans.size(); ++i)
      result += tensions_n[static_cast<Eigen::Index>(c)] * cables_[c].spans[i].transpose() *
                values.spans[c][i].curvature * cables_[c].spans[i];
  return result;
}

}  // namespace soft_robot_lab
