// SPDX-License-Identifier: BSD-3-Clause
// A cable with Coulomb friction on its points (Euler 1769, Eytelwein 1808): where it turns by an angle, the tensions of
// the two spans differ by no more than a factor of exp(coefficient * angle), and by just that where it slips. Each span
// keeps its own stretch of the cable, which is all that pulling and releasing remember; in a step stretches pass from
// span to span by the slips at its points, which the solver finds exactly, without regularisation: stick, slip and
// slack are one linear complementarity problem (mechanics/complementarity/multiplier_problem.h).
#include <cmath>

#include <Eigen/Geometry>

#include "cable_model.h"
#include "path_length.h"

namespace soft_robot_lab {
namespace {

constexpr double kStraight = 1e-6;  // sine of an angle that counts as none: there its derivative is undefined

using BothEnds = Eigen::Matrix<double, 6, 1>;

void add_to_ends(const Path& span, const BothEnds& columns, Eigen::Matrix3Xd& gradient) {
  for (const int end : {0, 1}) {
    const EmbeddedPoint& point = span.points()[static_cast<std::size_t>(end)];
    for (std::size_t k = 0; k < point.nodes.size(); ++k)
      gradient.col(point.nodes[k]) += point.weights[k] * columns.segment<3>(3 * end);
  }
}

// One end of a span around obstacles, up to a fixed place at which it passes: of its length the part there, which that
// end alone pulls. The whole span's Hessian is shared out, as it were one tension.
class SpanEnd : public Constraint {
 public:
  SpanEnd(const Path& span, bool last, const Eigen::Vector3d& position_m, PathLength::LawOfDrive law)
      : span_(span), last_(last), position_m_(position_m), law_(std::move(law)) {}

  std::vector<EmbeddedPoint> carried_points() const override { return span_.points(); }
  std::vector<Clique> cliques() const override { return {{~0, ~1}}; }
  double value(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/) const override {
    const Path::Span span = span_.spans(positions_m)[0];
    const double before = span.around->share_at(position_m_);
    return span.length_m * (last_ ? 1.0 - before : before);
  }
  void add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/, double scale,
                    Eigen::Matrix3Xd& gradient) const override {
    const Path::Span span = span_.spans(positions_m)[0];
    BothEnds pulls = BothEnds::Zero();
    pulls.segment<3>(last_ ? 3 : 0) = scale * (last_ ? span.direction : span.by_first());
    add_to_ends(span_, pulls, gradient);
  }
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/, double scale,
                   CliqueSink& hessian) const override {
    Eigen::Matrix<double, 6, 6> own = scale * span_.spans(positions_m)[0].hessian();
    own.block<3, 3>(last_ ? 0 : 3, last_ ? 0 : 3).setZero();
    own.topRightCorner<3, 3>() *= 0.5;
    own.bottomLeftCorner<3, 3>() *= 0.5;
    hessian.add_dense(0, own);
  }
  ConstraintLaw law(double value, double /*multiplier*/, const DriveState& drive) const override {
    return law_of_length(law_(drive), value);
  }

 private:
  const Path& span_;
  bool last_;
  Eigen::Vector3d position_m_;
  PathLength::LawOfDrive law_;
};

// Where the cable turns and rubs.
class Capstan : public FrictionContact {
 public:
  Capstan(double coefficient, bool on_obstacle, int place) : on_obstacle_(on_obstacle), coefficient_(coefficient) {
    first = place;
    second = place + 1;
  }
  double ratio(const Eigen::Matrix3Xd& positions_m) const override {
    return std::exp(coefficient_ * angle(positions_m));
  }
  void add_log_ratio_gradient(const Eigen::Matrix3Xd& positions_m, double scale,
                              Eigen::Matrix3Xd& gradient) const override {
    add_angle_gradient(positions_m, scale * coefficient_, gradient);
  }
  bool on_obstacle() const { return on_obstacle_; }
  virtual double angle(const Eigen::Matrix3Xd& positions_m) const = 0;

 protected:
  virtual void add_angle_gradient(const Eigen::Matrix3Xd& positions_m, double scale,
                                  Eigen::Matrix3Xd& gradient) const = 0;

 private:
  bool on_obstacle_;
  double coefficient_;
};

// At a point between two spans, each a path of its own.
class Bend : public Capstan {
 public:
  Bend(const Path& before, const Path& after, double coefficient, int place)
      : Capstan(coefficient, false, place), before_(before), after_(after) {}

  double angle(const Eigen::Matrix3Xd& positions_m) const override { return turn(positions_m).angle; }

  void add_angle_gradient(const Eigen::Matrix3Xd& positions_m, double scale,
                          Eigen::Matrix3Xd& gradient) const override {
    const Turn at = turn(positions_m);
    if (at.sine < kStraight) return;
    // d angle = -(b - a cos) / sin . da - (a - b cos) / sin . db for unit vectors a and b.
    const Eigen::Vector3d by_before = -scale / at.sine * (at.after - at.cosine * at.before),
                          by_after = -scale / at.sine * (at.before - at.cosine * at.after);
    add_to_ends(before_, before_.spans(positions_m)[0].hessian().bottomRows<3>().transpose() * by_before, gradient);
    add_to_ends(after_, -after_.spans(positions_m)[0].hessian().topRows<3>().transpose() * by_after, gradient);
  }

 private:
  struct Turn {
    Eigen::Vector3d before, after;
    double cosine, sine, angle;
  };

  Turn turn(const Eigen::Matrix3Xd& positions_m) const {
    Turn turn{before_.spans(positions_m)[0].direction.stableNormalized(),
              -after_.spans(positions_m)[0].by_first().stableNormalized(), 0.0, 0.0, 0.0};
    turn.cosine = turn.before.dot(turn.after);
    turn.sine = turn.before.cross(turn.after).norm();
    turn.angle = std::atan2(turn.sine, turn.cosine);
    return turn;
  }

  const Path &before_, &after_;
};

// Obstacles around which a span finds its way, as one capstan in its middle.
class Wrap : public Capstan {
 public:
  Wrap(const Path& span, double coefficient, int place) : Capstan(coefficient, true, place), span_(span) {}

  double angle(const Eigen::Matrix3Xd& positions_m) const override {
    return span_.spans(positions_m)[0].around->turned_rad;
  }
  void add_angle_gradient(const Eigen::Matrix3Xd& positions_m, double scale,
                          Eigen::Matrix3Xd& gradient) const override {
    add_to_ends(span_, scale * span_.spans(positions_m)[0].around->turned_gradient, gradient);
  }

 private:
  const Path& span_;
};

class FrictionCable : public CableModel {
 public:
  FrictionCable(const std::vector<EmbeddedPoint>& points, const Eigen::Matrix3Xd& rest_positions_m,
                CommandReader command, double compliance_m_n, const CableFriction& friction,
                std::vector<SpanString> strings)
      : command_(std::move(command)),
        compliance_m_n_(compliance_m_n),
        obstacles_as_points_(!friction.on_obstacles),
        path_(points, rest_positions_m, strings) {
    strings.resize(points.size() - 1);
    for (std::size_t i = 1; i < points.size(); ++i) {
      spans_.push_back(std::make_unique<Path>(std::vector<EmbeddedPoint>{points[i - 1], points[i]}, rest_positions_m,
                                              std::vector<SpanString>{strings[i - 1]}));
      if (i > 1)
        capstans_.push_back(std::make_unique<Bend>(*spans_[i - 2], *spans_[i - 1], friction.coefficient, last_piece()));
      add_span(*spans_.back(), strings[i - 1], rest_positions_m, friction.on_obstacles.value_or(friction.coefficient));
    }
    rest_lengths_m_.resize(static_cast<Eigen::Index>(pieces_.size()));
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      rest_lengths_m_[static_cast<Eigen::Index>(i)] = pieces_[i]->value(rest_positions_m, {});
  }

  std::vector<const Constraint*> constraints() const override {
    std::vector<const Constraint*> all;
    for (const auto& piece : pieces_) all.push_back(piece.get());
    return all;
  }

  std::vector<const FrictionContact*> friction_contacts() const override {
    std::vector<const FrictionContact*> all;
    for (const auto& capstan : capstans_) all.push_back(capstan.get());
    return all;
  }

  // Per piece: how much unloaded cable it holds. That of the first is not read: it is what the others leave of the
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
    LawChange change{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(pieces_.size())),
                     Eigen::VectorXd::Zero(static_cast<Eigen::Index>(capstans_.size()))};
    if (key == "compliance_m_n") {
      for (Eigen::Index k = command_(drive.actuated_command).by_tension ? 1 : 0; k < change.offsets.size(); ++k)
        change.offsets[k] = -multipliers[static_cast<std::size_t>(k)] * rest_lengths_m_[k] / rest_lengths_m_.sum();
    } else if (key == "friction_coefficient") {
      for (std::size_t i = 0; i < capstans_.size(); ++i)
        if (obstacles_as_points_ || !capstans_[i]->on_obstacle())
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
  const Path& path() const override { return path_; }

 private:
  int last_piece() const { return static_cast<int>(pieces_.size()) - 1; }

  // One piece, or two with the friction of obstacles between.
  void add_span(const Path& span, const SpanString& string, const Eigen::Matrix3Xd& rest_positions_m,
                double on_obstacles) {
    const auto law = [this](std::size_t k) -> PathLength::LawOfDrive {
      return [this, k](const DriveState& drive) { return law_of_piece(static_cast<Eigen::Index>(k), drive); };
    };
    if (!string) {
      pieces_.push_back(std::make_unique<PathLength>(span.points(), rest_positions_m, law(pieces_.size())));
      return;
    }
    const Eigen::Vector3d position_m = string->led_over_m()[string->led_over_m().size() / 2];
    capstans_.push_back(std::make_unique<Wrap>(span, on_obstacles, last_piece() + 1));
    for (const bool last : {false, true})
      pieces_.push_back(std::make_unique<SpanEnd>(span, last, position_m, law(pieces_.size())));
  }

  // The drive, at the first piece, is the one that a command reaches directly.
  CableLaw law_of_piece(Eigen::Index k, const DriveState& drive) const {
    const double compliance_m_n = compliance_m_n_ * rest_lengths_m_[k] / rest_lengths_m_.sum();
    if (k > 0) return CableLaw::of_length(drive.memory[k], compliance_m_n, 0.0);
    const DriveCommand command = command_(drive.actuated_command);
    if (command.by_tension) return CableLaw::of_tension(command.tension_n, command.per_command);
    const double others_m = drive.memory.tail(drive.memory.size() - 1).sum();
    return CableLaw::of_length(command.length_m - others_m, compliance_m_n, command.per_command);
  }

  CommandReader command_;
  double compliance_m_n_;
  bool obstacles_as_points_;  // their coefficient is that of the points
  Path path_;
  std::vector<std::unique_ptr<Path>> spans_;
  std::vector<std::unique_ptr<Constraint>> pieces_;
  std::vector<std::unique_ptr<Capstan>> capstans_;
  Eigen::VectorXd rest_lengths_m_;  // per piece
};

}  // namespace

std::unique_ptr<CableModel> make_friction_cable(const std::vector<EmbeddedPoint>& points,
                                                const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
                                                double compliance_m_n, const CableFriction& friction,
                                                std::vector<SpanString> strings) {
  return std::make_unique<FrictionCable>(points, rest_positions_m, std::move(command), compliance_m_n, friction,
                                         std::move(strings));
}

}  // namespace soft_robot_lab
