// SPDX-License-Identifier: BSD-3-Clause
// The cable of the thesis: from point to point a spring that pulls and never pushes, T = max(0, k (l - L) + b dl/dt).
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "cable_model.h"
#include "path_length.h"

namespace soft_robot_lab {
namespace {

// (W W^T)^-1 of the points' interpolation rows W, so that W^+ = W^T (W W^T)^-1.
Eigen::LDLT<Eigen::MatrixXd> inverse_gram(const std::vector<EmbeddedPoint>& points, Eigen::Index nodes) {
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points.size()), nodes);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < points[i].nodes.size(); ++k)
      w(static_cast<Eigen::Index>(i), points[i].nodes[k]) += points[i].weights[k];
  return Eigen::LDLT<Eigen::MatrixXd>(w * w.transpose());
}

// What a step began with, as the memory holds it: the length of the step (0 in a search for a rest state), then per
// span length, rate, and direction.
class StepMemory {
 public:
  static Eigen::VectorXd empty(std::size_t spans) {
    return Eigen::VectorXd::Zero(1 + kPerSpan * static_cast<Eigen::Index>(spans));
  }
  explicit StepMemory(const Eigen::VectorXd& numbers) : numbers_(numbers) {}
  double time_step_s() const { return numbers_[0]; }
  double length_m(std::size_t span) const { return numbers_[first(span)]; }
  double rate_m_s(std::size_t span) const { return numbers_[first(span) + 1]; }
  Eigen::Vector3d direction(std::size_t span) const { return numbers_.segment<3>(first(span) + 2); }

  static void write(std::size_t span, double length_m, double rate_m_s, const Eigen::Vector3d& direction,
                    Eigen::VectorXd& numbers) {
    numbers.segment<kPerSpan>(first(span)) << length_m, rate_m_s, direction;
  }

 private:
  static constexpr int kPerSpan = 5;
  static Eigen::Index first(std::size_t span) { return 1 + kPerSpan * static_cast<Eigen::Index>(span); }
  const Eigen::VectorXd& numbers_;
};

class SpringCable : public CableModel {
 public:
  SpringCable(const std::vector<EmbeddedPoint>& points, const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
              const SpringSettings& settings)
      : command_(std::move(command)),
        settings_(settings),
        path_(points, rest_positions_m),
        fixed_(*this),
        node_count_(rest_positions_m.cols()) {
    for (const Path::Span& span : path_.spans(rest_positions_m)) rest_lengths_m_.push_back(span.length_m);
    for (const double length_m : rest_lengths_m_) rest_length_m_ += length_m;
    for (std::size_t i = 1; i < points.size(); ++i)
      springs_.push_back(
          std::make_unique<PathLength>(std::vector<EmbeddedPoint>{points[i - 1], points[i]}, rest_positions_m,
                                       [this, i](const DriveState& drive) { return law_of_spring(i - 1, drive); }));
    if (settings.pseudo_inverse) inverse_gram_ = inverse_gram(points, rest_positions_m.cols());
  }

  std::vector<const Constraint*> constraints() const override {
    std::vector<const Constraint*> all;
    for (const auto& spring : springs_) all.push_back(spring.get());
    if (settings_.explicit_forces) all.push_back(&fixed_);
    return all;
  }

  Eigen::VectorXd initial_memory() const override { return StepMemory::empty(rest_lengths_m_.size()); }

  void begin_step(const StepStart& start, DriveState& drive) const override {
    drive.memory[0] = std::isfinite(start.time_step_s) ? start.time_step_s : 0.0;
    const std::vector<Path::Span> spans = path_.spans(start.positions_m);
    for (std::size_t i = 0; i < spans.size(); ++i) {
      const double rate_m_s = spans[i].direction.dot(path_.points()[i + 1].at(start.velocities_m_s) -
                                                     path_.points()[i].at(start.velocities_m_s));
      StepMemory::write(i, spans[i].length_m, rate_m_s, spans[i].direction, drive.memory);
    }
  }

  std::string why_no_equilibrium() const override {
    return settings_.pseudo_inverse ? "coupling pseudo_inverse does work out of nothing, so no rest state is sought "
                                      "with it; use coupling transpose, or steps in time"
                                    : "";
  }

  std::vector<double> tensions_n(const std::vector<double>& multipliers, const DriveState& drive) const override {
    if (settings_.explicit_forces && multipliers.back() != 0.0) return held_tensions_n(drive);
    return {multipliers.begin(), multipliers.begin() + static_cast<std::ptrdiff_t>(springs_.size())};
  }
  double compliance_m_n() const override { return static_cast<double>(springs_.size()) / settings_.stiffness_n_m; }
  const Path& path() const override { return path_; }

 private:
  // Forces that stay as they are over a step, whatever the body does: C = -f . x, whose multiplier is held at 1; at 0
  // where no forces are held.
  class FixedForces : public Constraint {
   public:
    explicit FixedForces(const SpringCable& cable) : cable_(cable) {}
    std::vector<Clique> cliques() const override { return {}; }
    double value(const Eigen::Matrix3Xd& positions_m, const DriveState& drive) const override {
      return -cable_.held_forces_n(drive).cwiseProduct(positions_m).sum();
    }
    void add_gradient(const Eigen::Matrix3Xd& /*positions_m*/, const DriveState& drive, double scale,
                      Eigen::Matrix3Xd& gradient) const override {
      gradient -= scale * cable_.held_forces_n(drive);
    }
    void add_hessian(const Eigen::Matrix3Xd& /*positions_m*/, const DriveState& /*drive*/, double /*scale*/,
                     CliqueSink& /*hessian*/) const override {}
    ConstraintLaw law(double /*value*/, double /*multiplier*/, const DriveState& drive) const override {
      ConstraintLaw law;
      law.min_multiplier = law.max_multiplier = cable_.holds_forces(drive) ? 1.0 : 0.0;
      return law;
    }

   private:
    const SpringCable& cable_;
  };

  // A rest state knows no step to hold forces over; there explicit springs are the same as implicit ones.
  bool holds_forces(const DriveState& drive) const {
    return settings_.explicit_forces && StepMemory(drive.memory).time_step_s() > 0.0;
  }

  // Each spring takes the same share of the length.
  double length_m(std::size_t i, const DriveCommand& command) const {
    const double contraction = command.length_m / rest_length_m_;
    return contraction * rest_lengths_m_[i];
  }

  // dl/dt is (l - l of the start) / step, so a damper adds to the stiffness and moves the length:
  //   T = (k + b/h) (l - (L + r l0) / (1 + r)),  r = b / (k h)
  CableLaw law_of_spring(std::size_t i, const DriveState& drive) const {
    if (holds_forces(drive)) return CableLaw::of_tension(0.0, 0.0);
    const DriveCommand command = command_(drive.actuated_command);
    if (command.by_tension) return CableLaw::of_tension(command.tension_n, command.per_command);
    const StepMemory start(drive.memory);
    const double r =
        start.time_step_s() > 0.0 ? settings_.damping_n_s_m / (settings_.stiffness_n_m * start.time_step_s()) : 0.0;
    const double length = r > 0.0 ? (length_m(i, command) + r * start.length_m(i)) / (1.0 + r) : length_m(i, command);
    const double contraction_per_command = command.per_command / rest_length_m_;
    return CableLaw::of_length(length, 1.0 / (settings_.stiffness_n_m * (1.0 + r)),
                               contraction_per_command * rest_lengths_m_[i] / (1.0 + r));
  }

  std::vector<double> held_tensions_n(const DriveState& drive) const {
    const DriveCommand command = command_(drive.actuated_command);
    const StepMemory start(drive.memory);
    std::vector<double> tensions_n;
    for (std::size_t i = 0; i < springs_.size(); ++i)
      tensions_n.push_back(command.by_tension
                               ? command.tension_n
                               : std::max(0.0, settings_.stiffness_n_m * (start.length_m(i) - length_m(i, command)) +
                                                   settings_.damping_n_s_m * start.rate_m_s(i)));
    return tensions_n;
  }

  // On the nodes; zero where none are held.
  Eigen::Matrix3Xd held_forces_n(const DriveState& drive) const {
    Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, node_count_);
    if (!holds_forces(drive)) return forces;
    const std::vector<EmbeddedPoint>& points = path_.points();
    const std::vector<double> tensions_n = held_tensions_n(drive);
    const StepMemory start(drive.memory);
    Eigen::MatrixXd on_points = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t i = 0; i < tensions_n.size(); ++i) {
      const Eigen::RowVector3d pull = tensions_n[i] * start.direction(i).transpose();
      on_points.row(static_cast<Eigen::Index>(i)) += pull;
      on_points.row(static_cast<Eigen::Index>(i) + 1) -= pull;
    }
    if (settings_.pseudo_inverse) on_points = inverse_gram_.solve(on_points);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k < points[i].nodes.size(); ++k)
        forces.col(points[i].nodes[k]) +=
            points[i].weights[k] * on_points.row(static_cast<Eigen::Index>(i)).transpose();
    return forces;
  }

  CommandReader command_;
  SpringSettings settings_;
  Path path_;  // measures all spans at once
  std::vector<std::unique_ptr<PathLength>> springs_;
  FixedForces fixed_;
  Eigen::Index node_count_;
  Eigen::LDLT<Eigen::MatrixXd> inverse_gram_;
  std::vector<double> rest_lengths_m_;
  double rest_length_m_ = 0.0;
};

}  // namespace

std::unique_ptr<CableModel> make_spring_cable(const std::vector<EmbeddedPoint>& points,
                                              const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
                                              const SpringSettings& settings) {
  return std::make_unique<SpringCable>(points, rest_positions_m, std::move(command), settings);
}

}  // namespace soft_robot_lab
