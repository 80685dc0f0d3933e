// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_constraints.h"

#include <stdexcept>

namespace soft_robot_lab {
namespace {

void refuse_memory(const Actuator& actuator) {
  if (actuator.friction_contacts().empty() && actuator.rest_state().memory.size() == 0) return;
  throw std::invalid_argument("actuator '" + actuator.name() +
                              "': a reduced model knows only cables of model sliding, springs without damping, and "
                              "chambers of model implicit without a regulator");
}

// A member of a volume's triples, as it moves with the modes.
struct MovingPoint {
  Eigen::Vector3d rest_m;
  Eigen::Matrix3Xd motion;  // 3 x modes

  MovingPoint(const EmbeddedPoint& point, const Eigen::Matrix3Xd& rest_positions_m, const Eigen::MatrixXd& modes)
      : rest_m(point.at(rest_positions_m)), motion(Eigen::Matrix3Xd::Zero(3, modes.cols())) {
    for (std::size_t k = 0; k < point.nodes.size(); ++k)
      motion += point.weights[k] * modes.middleRows<3>(3 * point.nodes[k]);
  }
};

DeterminantSum sum_of(const EnclosedVolume& surface, const Eigen::Matrix3Xd& rest_positions_m,
                      const Eigen::MatrixXd& modes) {
  DeterminantSum sum;
  for (const EnclosedVolume::Triple& triple : surface.triples()) {
    DeterminantTerm term{triple.weight, Eigen::Matrix3d(), PointGradient(9, modes.cols())};
    for (int c = 0; c < 3; ++c) {
      const int member = triple.members[static_cast<std::size_t>(c)];
      const EmbeddedPoint point = member < 0 ? surface.cap_centres()[static_cast<std::size_t>(~member)]
                                             : EmbeddedPoint{{member}, {1.0}, Eigen::Vector3d::Zero()};
      const MovingPoint moving(point, rest_positions_m, modes);
      term.at_rest.col(c) = moving.rest_m - surface.origin_m();
      term.gradient.middleRows<3>(3 * c) = moving.motion;
    }
    sum.push_back(std::move(term));
  }
  return sum;
}

}  // namespace

ReducedConstraints::ReducedConstraints(const Model& model, const Eigen::MatrixXd& modes) : modes_(modes.cols()) {
  const Eigen::Matrix3Xd& rest_m = model.body().mesh().nodes_m;
  std::vector<DeterminantSum> volumes;
  for (std::size_t i = 0; i < model.actuators().size(); ++i) {
    const Actuator& actuator = *model.actuators()[i];
    refuse_memory(actuator);
    for (const Constraint* constraint : actuator.constraints()) {
      if (const auto* length = dynamic_cast<const PathLength*>(constraint)) {
        if (length->path().finds_its_way())
          throw std::invalid_argument("actuator '" + actuator.name() + "': a reduced model knows no cable with around");
        add_cable(*length, rest_m, modes);
      } else if (const auto* volume = dynamic_cast<const ChamberVolume*>(constraint)) {
        chambers_.push_back({static_cast<Eigen::Index>(count()), volume->volume_m3(rest_m)});
        volumes.push_back(sum_of(volume->surface(), rest_m, modes));
      } else {
        throw std::invalid_argument("actuator '" + actuator.name() +
                                    "': a reduced model knows only cables and chambers");
      }
      all_.push_back(constraint);
      actuators_.push_back(i);
    }
  }
  if (!volumes.empty() && modes_ > 0) volumes_.emplace(volumes);
}

void ReducedConstraints::add_cable(const PathLength& length, const Eigen::Matrix3Xd& rest_positions_m,
                                   const Eigen::MatrixXd& modes) {
  const std::vector<EmbeddedPoint>& points = length.path().points();
  const auto rows = static_cast<Eigen::Index>(3 * points.size());
  const Eigen::Matrix3Xd rest = length.path().places(rest_positions_m);
  Cable cable{&length.path(),
              static_cast<Eigen::Index>(count()),
              Eigen::Map<const Eigen::VectorXd>(rest.data(), rows),
              Eigen::MatrixXd::Zero(rows, modes_),
              {}};
  for (std::size_t p = 0; p < points.size(); ++p)
    cable.places.middleRows<3>(static_cast<Eigen::Index>(3 * p)) =
        MovingPoint(points[p], rest_positions_m, modes).motion;
  for (Eigen::Index row = 3; row < rows; row += 3)
    cable.spans.push_back(cable.places.middleRows<3>(row) - cable.places.middleRows<3>(row - 3));
  cables_.push_back(std::move(cable));
}

void ReducedConstraints::add_cables_at(const Eigen::VectorXd& q, Values& values, Eigen::VectorXd& amounts) const {
  for (const Cable& cable : cables_) {
    const Eigen::VectorXd places = cable.rest_places_m + cable.places * q;
    values.spans.push_back(
        cable.path->spans_between(Eigen::Map<const Eigen::Matrix3Xd>(places.data(), 3, places.size() / 3)));
    const std::vector<Path::Span>& spans = values.spans.back();
    for (std::size_t i = 0; i < spans.size(); ++i) {
      amounts[cable.constraint] += spans[i].length_m;
      values.gradients.col(cable.constraint).noalias() += cable.spans[i].transpose() * spans[i].direction;
    }
  }
}

void ReducedConstraints::add_chambers_at(const Eigen::VectorXd& q, Values& values, Eigen::VectorXd& amounts) const {
  if (!volumes_) return;
  const auto chambers = static_cast<Eigen::Index>(chambers_.size());
  const Eigen::VectorXd grown_m3 = volumes_->at(q, Eigen::VectorXd::Zero(chambers)).values;
  const Eigen::MatrixXd gradients = volumes_->gradients(q);
  for (Eigen::Index k = 0; k < chambers; ++k) {
    const Chamber& chamber = chambers_[static_cast<std::size_t>(k)];
    amounts[chamber.constraint] = chamber.rest_volume_m3 + grown_m3[k];
    values.gradients.col(chamber.constraint) = gradients.col(k);
  }
}

ReducedConstraints::Values ReducedConstraints::at(const Eigen::VectorXd& q, const Eigen::VectorXd& multipliers,
                                                  const DriveStates& drives) const {
  Values result;
  result.gradients.setZero(modes_, static_cast<Eigen::Index>(count()));
  Eigen::VectorXd amounts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count()));
  add_cables_at(q, result, amounts);
  add_chambers_at(q, result, amounts);
  for (std::size_t c = 0; c < count(); ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    result.laws.push_back(all_[c]->law(amounts[row], multipliers[row], drives[actuators_[c]]));
  }
  return result;
}

void ReducedConstraints::Values::add(const std::vector<ReducedSkin::Touch>& more) {
  if (more.empty()) return;
  const Eigen::Index before = gradients.cols();
  gradients.conservativeResize(Eigen::NoChange, before + static_cast<Eigen::Index>(more.size()));
  for (std::size_t i = 0; i < more.size(); ++i) {
    gradients.col(before + static_cast<Eigen::Index>(i)) = more[i].gradient;
    laws.push_back(more[i].law);
    touches.push_back(more[i]);
  }
}

std::vector<Eigen::Index> ReducedConstraints::Values::touching() const {
  std::vector<Eigen::Index> places;
  for (const ReducedSkin::Touch& touch : touches) places.push_back(touch.place);
  return places;
}

Eigen::MatrixXd ReducedConstraints::hessian(const Eigen::VectorXd& q, const Values& values,
                                            const Eigen::VectorXd& multipliers) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(modes_, modes_);
  for (std::size_t c = 0; c < cables_.size(); ++c)
    for (std::size_t i = 0; i < cables_[c].spans.size(); ++i)
      result += multipliers[cables_[c].constraint] * cables_[c].spans[i].transpose() * values.spans[c][i].curvature *
                cables_[c].spans[i];
  if (!volumes_) return result;
  Eigen::VectorXd of_chambers(static_cast<Eigen::Index>(chambers_.size()));
  for (std::size_t k = 0; k < chambers_.size(); ++k)
    of_chambers[static_cast<Eigen::Index>(k)] = multipliers[chambers_[k].constraint];
  return result + volumes_->hessian(q, of_chambers);
}

}  // namespace soft_robot_lab
