// SPDX-License-Identifier: BSD-3-Clause
// A cable with Coulomb friction on its points (Euler 1769, Eytelwein 1808): where it turns by an angle, the tensions of
// the two spans differ by no more than a factor of exp(coefficient * angle), and by just that where it slips. Each span
// keeps its own stretch of the cable, which is all that pulling and releasing remember; in a step stretches pass from
// span to span by the friction_contacts' slips, which the solver finds exactly, without regularisation: stick, slip and
// slack are one linear complementarity problem (sim/multiplier_problem.h).
#include <cmath>

#include <Eigen/Geometry>

#include "cable_model.h"
#include "path_length.h"

namespace soft_robot_lab {
namespace {

constexpr double kStraight = 1e-6;  // sine of an angle that counts as none: there its derivative is undefined

class Capstan : public FrictionContact {
 public:
  Capstan(const PathLength& before, const PathLength& after, double friction_coefficient, int place)
      : before_(before), after_(after), friction_coefficient_(friction_coefficient) {
    first = place;
    second = place + 1;
  }

  double ratio(const Eigen::Matrix3Xd& positions_m) const override {
    return std::exp(friction_coefficient_ * angle(positions_m));
  }
  double angle(const Eigen::Matrix3Xd& positions_m) const { return turn(positions_m).angle; }

  void add_log_ratio_gradient(const Eigen::Matrix3Xd& positions_m, double scale,
                              Eigen::Matrix3Xd& gradient) const override {
    const Turn at = turn(positions_m);
    if (at.sine < kStraight) return;
    // d angle = -(b - a cos) / sin . da - (a - b cos) / sin . db for unit vectors a and b.
    const double s = -scale * friction_coefficient_ / at.sine;
    add_along(before_, positions_m, s * (at.after - at.cosine * at.before), gradient);
    add_along(after_, positions_m, s * (at.before - at.cosine * at.after), gradient);
  }

 private:
  struct Turn {
    Eigen::Vector3d before, after;
    double cosine, sine, angle;
  };

  Turn turn(const Eigen::Matrix3Xd& positions_m) const {
    Turn turn{before_.path().spans(positions_m)[0].direction.stableNormalized(),
              after_.path().spans(positions_m)[0].direction.stableNormalized(), 0.0, 0.0, 0.0};
    turn.cosine = turn.before.dot(turn.after);
    turn.sine = turn.before.cross(turn.after).norm();
    turn.angle = std::atan2(turn.sine, turn.cosine);
    return turn;
  }

  // Adds `change` . d direction / dx of a span.
  static void add_along(const PathLength& span, const Eigen::Matrix3Xd& positions_m, const Eigen::Vector3d& change,
                        Eigen::Matrix3Xd& gradient) {
    const Eigen::Vector3d pull = span.path().spans(positions_m)[0].curvature * change;
    const std::vector<EmbeddedPoint> ends = span.carried_points();
    for (const int end : {0, 1})
      for (std::size_t k = 0; k < ends[end].nodes.size(); ++k)
        gradient.col(ends[end].nodes[k]) += (end == 0 ? -1.0 : 1.0) * ends[end].weights[k] * pull;
  }

  const PathLength &before_, &after_;
  double friction_coefficient_;
};

class FrictionCable : public CableModel {
 public:
  FrictionCable(const std::vector<EmbeddedPoint>& points, const Eigen::Matrix3Xd& rest_positions_m,
                CommandReader command, double compliance_m_n, double friction_coefficient)
      : command_(std::move(command)), compliance_m_n_(compliance_m_n) {
    for (std::size_t i = 1; i < points.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i) - 1;
      spans_.push_back(
          std::make_unique<PathLength>(std::vector<EmbeddedPoint>{points[i - 1], points[i]}, rest_positions_m,
                                       [this, k](const DriveState& drive) { return law_of_span(k, drive); }));
    }
    rest_lengths_m_.resize(static_cast<Eigen::Index>(spans_.size()));
    for (std::size_t i = 0; i < spans_.size(); ++i)
      rest_lengths_m_[static_cast<Eigen::Index>(i)] = spans_[i]->length_m(rest_positions_m);
    for (std::size_t i = 1; i < spans_.size(); ++i)
      capstans_.push_back(
          std::make_unique<Capstan>(*spans_[i - 1], *spans_[i], friction_coefficient, static_cast<int>(i) - 1));
  }

  std::vector<const Constraint*> constraints() const override {
    std::vector<const Constraint*> all;
    for (const auto& span : spans_) all.push_back(span.get());
    return all;
  }

  std::vector<const FrictionContact*> friction_contacts() const override {
    std::vector<const FrictionContact*> all;
    for (const auto& capstan : capstans_) all.push_back(capstan.get());
    return all;
  }

  // Per span: how much unloaded cable it holds. That of the first is not read: it is what the others leave of the
  // commanded length.
  Eigen::VectorXd initial_memory() const override { return rest_lengths_m_; }

  void end_step(const std::vector<double>& slips_m, DriveState& drive) const override {
    for (std::size_t i = 0; i < slips_m.size(); ++i) {
      drive.memory[static_cast<Eigen::Index>(i)] += slips_m[i];
      drive.memory[static_cast<Eigen::Index>(i) + 1] -= slips_m[i];
    }
  }

  std::optional<LawChange> law_change(const std::string& key, const Eigen::Matrix3Xd& positions_m,
                                      const std::vector<double>& multipliers, const DriveState& drive) const override {
    LawChange change{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(spans_.size())),
                     Eigen::VectorXd::Zero(static_cast<Eigen::Index>(capstans_.size()))};
    if (key == "compliance_m_n") {
      for (Eigen::Index k = command_(drive.actuated_command).by_tension ? 1 : 0; k < change.offsets.size(); ++k)
        change.offsets[k] = -multipliers[static_cast<std::size_t>(k)] * rest_lengths_m_[k] / rest_lengths_m_.sum();
    } else if (key == "friction_coefficient") {
      for (std::size_t i = 0; i < capstans_.size(); ++i)
        change.log_ratios[static_cast<Eigen::Index>(i)] = capstans_[i]->angle(positions_m);
    } else {
      return std::nullopt;
    }
    return change;
  }

  std::vector<double> tensions_n(const std::vector<double>& multipliers, const DriveState& /*drive*/) const override {
    return multipliers;
  }
  double compliance_m_n() const override { return compliance_m_n_; }

 private:
  // The drive, at the first span, is the one that a command reaches directly.
  CableLaw law_of_span(Eigen::Index k, const DriveState& drive) const {
    const double compliance_m_n = compliance_m_n_ * rest_lengths_m_[k] / rest_lengths_m_.sum();
    if (k > 0) return CableLaw::of_length(drive.memory[k], compliance_m_n, 0.0);
    const DriveCommand command = command_(drive.actuated_command);
    if (command.by_tension) return CableLaw::of_tension(command.tension_n, command.per_command);
    const double others_m = drive.memory.tail(drive.memory.size() - 1).sum();
    return CableLaw::of_length(command.length_m - others_m, compliance_m_n, command.per_command);
  }

  CommandReader command_;
  double compliance_m_n_;
  std::vector<std::unique_ptr<PathLength>> spans_;
  std::vector<std::unique_ptr<Capstan>> capstans_;
  Eigen::VectorXd rest_lengths_m_;  // per span
};

}  // namespace

std::unique_ptr<CableModel> make_friction_cable(const std::vector<EmbeddedPoint>& points,
                                                const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
                                                double compliance_m_n, double friction_coefficient) {
  return std::make_unique<FrictionCable>(points, rest_positions_m, std::move(command), compliance_m_n,
                                         friction_coefficient);
}

}  // namespace soft_robot_lab
