// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_constraints.h"

#include <set>
#include <stdexcept>
#include <string>

namespace soft_robot_lab {
namespace {

[[noreturn]] void refuse(const Actuator& actuator, const std::string& what) {
  throw std::invalid_argument("actuator '" + actuator.name() + "': a reduced model knows no " + what);
}

// What acts in the first step of a time.
DriveState in_a_step(const Actuator& actuator, const Eigen::Matrix3Xd& rest_m) {
  DriveState drive = actuator.rest_state();
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, rest_m.cols());
  actuator.begin_step({1.0, rest_m, still, std::vector<double>(actuator.constraints().size(), 0.0)}, drive);
  return drive;
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
  std::vector<DeterminantSum> volumes;
  for (std::size_t i = 0; i < model.actuators().size(); ++i) {
    const Actuator& actuator = *model.actuators()[i];
    begin_steps_ |= actuator.friction_contacts().empty() && actuator.rest_state().memory.size() > 0;
    for (const FrictionContact* contact : actuator.friction_contacts())
      rubbing_.contacts.push_back(
          {contact, static_cast<int>(count()) + contact->first, static_cast<int>(count()) + contact->second});
    for (const Constraint* constraint : actuator.constraints()) {
      add_constraint(*constraint, actuator, model, modes, volumes);
      all_.push_back(constraint);
      actuators_.push_back(i);
    }
  }
  if (!volumes.empty() && modes_ > 0) volumes_.emplace(volumes);
  if (!rubbing_.contacts.empty()) find_rubbing(model, modes);
}

void ReducedConstraints::add_constraint(const Constraint& constraint, const Actuator& actuator, const Model& model,
                                        const Eigen::MatrixXd& modes, std::vector<DeterminantSum>& volumes) {
  const Eigen::Matrix3Xd& rest_m = model.body().mesh().nodes_m;
  if (const auto* length = dynamic_cast<const PathLength*>(&constraint)) {
    if (length->path().finds_its_way()) refuse(actuator, "cable with around");
    add_cable(*length, rest_m, modes);
  } else if (const auto* volume = dynamic_cast<const ChamberVolume*>(&constraint)) {
    if (volume->is_load(in_a_step(actuator, rest_m))) refuse(actuator, "chamber of model explicit");
    chambers_.push_back({static_cast<Eigen::Index>(count()), volume->volume_m3(rest_m)});
    volumes.push_back(sum_of(volume->surface(), rest_m, modes));
  } else {
    refuse(actuator, "actuator but cables, without around and with implicit forces, and chambers");
  }
}

void ReducedConstraints::find_rubbing(const Model& model, const Eigen::MatrixXd& modes) {
  rubbing_.rest_m = model.body().mesh().nodes_m;
  std::set<int> nodes;
  for (const Cable& cable : cables_)
    for (const EmbeddedPoint& point : cable.path->points()) nodes.insert(point.nodes.begin(), point.nodes.end());
  rubbing_.nodes.assign(nodes.begin(), nodes.end());
  rubbing_.modes.resize(static_cast<Eigen::Index>(3 * nodes.size()), modes_);
  for (std::size_t i = 0; i < rubbing_.nodes.size(); ++i)
    rubbing_.modes.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = modes.middleRows<3>(3 * rubbing_.nodes[i]);
}

Eigen::Matrix3Xd ReducedConstraints::Rubbing::positions_m(const Eigen::VectorXd& q) const {
  Eigen::Matrix3Xd all_m = rest_m;
  const Eigen::VectorXd moved = modes * q;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    all_m.col(nodes[i]) += moved.segment<3>(static_cast<Eigen::Index>(3 * i));
  return all_m;
}

Eigen::MatrixXd ReducedConstraints::log_ratio_gradients(const Eigen::VectorXd& q) const {
  Eigen::MatrixXd all(modes_, friction_contact_count());
  if (all.cols() == 0) return all;
  const Eigen::Matrix3Xd positions_m = rubbing_.positions_m(q);
  for (Eigen::Index j = 0; j < all.cols(); ++j) {
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
    rubbing_.contacts[static_cast<std::size_t>(j)].law->add_log_ratio_gradient(positions_m, 1.0, gradient);
    all.col(j) = rubbing_.modes.transpose() * gradient(Eigen::all, rubbing_.nodes).reshaped();
  }
  return all;
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
  if (rubbing_.contacts.empty()) return result;
  const Eigen::Matrix3Xd positions_m = rubbing_.positions_m(q);
  for (const Rubbing::Contact& contact : rubbing_.contacts)
    result.friction_contacts.push_back({contact.first, contact.second, contact.law->ratio(positions_m)});
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
