// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuators/cable.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cable_model.h"
#include "cable_points.h"
#include "cable_strings.h"

namespace soft_robot_lab {
namespace {

using Points = std::vector<EmbeddedPoint>;

std::unique_ptr<CableModel> read_springs(const YamlNode& settings, const Points& points,
                                         const Eigen::Matrix3Xd& rest_positions_m, CommandReader command) {
  SpringSettings springs;
  springs.stiffness_n_m = settings.number("stiffness_n_m", AllowedRange::positive());
  springs.damping_n_s_m = settings.number_or("damping_n_s_m", 0.0, AllowedRange::not_negative());
  springs.explicit_forces = settings.choice_or("integration", "implicit", {"implicit", "explicit"}) == "explicit";
  springs.pseudo_inverse = settings.choice_or("coupling", "transpose", {"transpose", "pseudo_inverse"}) != "transpose";
  if (springs.pseudo_inverse && !springs.explicit_forces)
    settings.child("coupling")
        .fail(
            "pseudo_inverse has no energy that an implicit solver could use; needs "
            "integration: explicit");
  return make_spring_cable(points, rest_positions_m, std::move(command), springs);
}

CableFriction read_friction(const YamlNode& settings) {
  CableFriction friction{settings.number("friction_coefficient", {0.0, 2.0}), std::nullopt};
  if (!settings.has("friction_on_obstacles")) return friction;
  if (!settings.has("around")) settings.child("friction_on_obstacles").fail("is of obstacles; list them as around");
  friction.on_obstacles = settings.number("friction_on_obstacles", {0.0, 2.0});
  return friction;
}

std::unique_ptr<CableModel> read_model(const YamlNode& settings, const Body& body, const MeshLocator& locator,
                                       const Points& points, CommandReader command) {
  const Eigen::Matrix3Xd& rest_positions_m = body.mesh().nodes_m;
  const std::string model = settings.choice_or("model", "sliding", {"sliding", "friction", "springs"});
  if (model == "springs") {
    if (settings.has("around")) settings.child("around").fail("model springs knows no obstacles; must be another");
    return read_springs(settings, points, rest_positions_m, std::move(command));
  }
  std::vector<SpanString> strings = read_strings(settings, body, locator, points);
  const double compliance_m_n = settings.number_or("compliance_m_n", 1.0e-5, AllowedRange::not_negative());
  if (model == "sliding")
    return make_sliding_cable(points, rest_positions_m, std::move(command), compliance_m_n, std::move(strings));
  return make_friction_cable(points, rest_positions_m, std::move(command), compliance_m_n, read_friction(settings),
                             std::move(strings));
}

}  // namespace

Cable::Cable() = default;
Cable::~Cable() = default;

void Cable::on_initialise(const YamlNode& settings, const Body& body, const MeshLocator& locator) {
  const Eigen::Matrix3Xd& rest_positions_m = body.mesh().nodes_m;
  CablePoints read = read_cable_points(settings, body, locator);
  points_ = std::move(read.points);
  path_changes_ = std::move(read.changes);
  model_ = read_model(settings, body, locator, points_, [this](double command) { return drive_command(command); });
  rest_length_m_ = model_->path().length_m(rest_positions_m);
  if (!std::isfinite(rest_length_m_)) settings.child("around").fail("no taut way around them was found at rest");

  const std::string command = settings.choice_or("command", "contraction", {"contraction", "length_m", "tension_n"});
  kind_ = command == "contraction" ? Command::contraction : command == "length_m" ? Command::length : Command::tension;
  if (kind_ == Command::tension) {
    limits_ = {0.0, 0.0, settings.number_or("max_tension_n", 100.0, AllowedRange::positive()), "N"};
    return;
  }
  pretension_n_ = settings.number_or("pretension_n", 0.0, AllowedRange::not_negative());
  if (pretension_n_ > 0.0 && model_->compliance_m_n() == 0.0)
    settings.child("pretension_n").fail("a cable with compliance_m_n 0 has no tension of its own at rest; must be 0");
  length_offset_m_ = settings.number_or("length_offset_m", 0.0, {-0.1 * rest_length_m_, 0.1 * rest_length_m_});
  const double pull_speed_m_s = settings.number_or("pull_speed_m_s", 0.0, AllowedRange::not_negative());
  start_delay_s_ = settings.number_or("pull_delay_s", 0.0, AllowedRange::not_negative());
  if (kind_ == Command::contraction) {
    limits_ = {1.0, settings.number_or("min_contraction", 0.5, {0.05, 1.0}), 1.5, "1"};
    command_speed_ = pull_speed_m_s / rest_length_m_;
  } else {
    limits_ = {rest_length_m_, 0.05 * rest_length_m_, 1.5 * rest_length_m_, "m"};
    command_speed_ = pull_speed_m_s;
  }
}

double Cable::unloaded_length_m(double actuated_command) const {
  const double added_m = length_offset_m_ - pretension_n_ * model_->compliance_m_n();
  return (kind_ == Command::contraction ? actuated_command * rest_length_m_ : actuated_command) + added_m;
}

DriveCommand Cable::drive_command(double actuated_command) const {
  if (kind_ == Command::tension) return {true, 0.0, actuated_command, 1.0};
  return {false, unloaded_length_m(actuated_command), 0.0, kind_ == Command::contraction ? rest_length_m_ : 1.0};
}

std::vector<const Constraint*> Cable::constraints() const { return model_->constraints(); }
std::vector<const FrictionContact*> Cable::friction_contacts() const { return model_->friction_contacts(); }
std::string Cable::why_no_equilibrium() const { return model_->why_no_equilibrium(); }
Eigen::VectorXd Cable::initial_memory() const { return model_->initial_memory(); }
void Cable::begin_step(const StepStart& start, DriveState& drive) const { model_->begin_step(start, drive); }
void Cable::end_step(const std::vector<double>& slips_m, DriveState& drive) const { model_->end_step(slips_m, drive); }

std::optional<LawChange> Cable::law_change(const std::string& key, const Eigen::Matrix3Xd& positions_m,
                                           const std::vector<double>& multipliers, const DriveState& drive) const {
  // How the offsets change per metre of cable.
  const std::vector<const Constraint*> all = constraints();
  Eigen::VectorXd by_length(static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i)
    by_length[static_cast<Eigen::Index>(i)] =
        all[i]->law(all[i]->value(positions_m, drive), multipliers[i], drive).offset_per_command /
        (kind_ == Command::contraction ? rest_length_m_ : 1.0);
  if (key == "length_offset_m" && kind_ != Command::tension)
    return LawChange{by_length, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(friction_contacts().size()))};
  std::optional<LawChange> change = model_->law_change(key, positions_m, multipliers, drive);
  if (change && key == "compliance_m_n") change->offsets -= pretension_n_ * by_length;
  return change;
}

ActuatorReading Cable::observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers,
                               const DriveState& drive) const {
  ActuatorReading state;
  state.path_m = model_->path().polyline_m(positions_m);
  state.length_m = model_->path().length_m(positions_m);
  state.rest_length_m = rest_length_m_;
  const std::vector<double> tensions_n = model_->tensions_n(multipliers, drive);
  state.tension_n = tensions_n.front();
  if (tensions_n.size() > 1) state.span_tensions_n = tensions_n;
  state.path_changes = path_changes_;
  if (kind_ == Command::tension) return state;
  state.commanded_length_m =
      kind_ == Command::contraction ? drive.actuated_command * rest_length_m_ : drive.actuated_command;
  const double longer_m = *state.length_m - unloaded_length_m(drive.actuated_command);
  state.stretch_m = std::max(0.0, longer_m);
  state.slack_m = std::max(0.0, -longer_m);
  state.pretension_n = pretension_n_;
  return state;
}

}  // namespace soft_robot_lab
