// SPDX-License-Identifier: BSD-3-Clause
// The cable of the thesis: from point to point a spring that pulls and never pushes, T = max(0, k (l - L) + b dl/dt).
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "cable_model.h"
#include "path_length.h"

namespace soft_robot_lab {
namespace {

// Forces that stay as they are over a step, whatever the body does: C = -f . x, whose multiplier is held at 1.
class FixedForces : public Constraint {
 public:
  explicit FixedForces(Eigen::Index nodes) : forces_n_(Eigen::Matrix3Xd::Zero(3, nodes)) {}
  void set(Eigen::Matrix3Xd forces_n) {
    forces_n_ = std::move(forces_n);
    multiplier_ = 1.0;
  }
  void clear() { multiplier_ = 0.0; }
  Eigen::Index node_count() const { return forces_n_.cols(); }

  std::vector<Clique> cliques() const override { return {}; }
  double value(const Eigen::Matrix3Xd& positions_m) const override {
    return -forces_n_.cwiseProduct(positions_m).sum();
  }
  void add_gradient(const Eigen::Matrix3Xd& /*positions_m*/, double scale, Eigen::Matrix3Xd& gradient) const override {
    gradient -= scale * forces_n_;
  }
  void add_hessian(const Eigen::Matrix3Xd& /*positions_m*/, double /*scale*/, CliqueSink& /*hessian*/) const override {}
  ConstraintLaw law(double /*value*/, double /*multiplier*/) const override {
    ConstraintLaw law;
    law.min_multiplier = law.max_multiplier = multiplier_;
    return law;
  }

 private:
  Eigen::Matrix3Xd forces_n_;
  double multiplier_ = 0.0;
};

// (W W^T)^-1 of the points' interpolation rows W, so that W^+ = W^T (W W^T)^-1.
Eigen::LDLT<Eigen::MatrixXd> inverse_gram(const std::vector<EmbeddedPoint>& points, Eigen::Index nodes) {
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points.size()), nodes);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < points[i].nodes.size(); ++k)
      w(static_cast<Eigen::Index>(i), points[i].nodes[k]) += points[i].weights[k];
  return Eigen::LDLT<Eigen::MatrixXd>(w * w.transpose());
}

class SpringCable : public CableModel {
 public:
  SpringCable(const std::vector<EmbeddedPoint>& points, const Eigen::Matrix3Xd& rest_positions_m,
              const SpringSettings& settings)
      : settings_(settings), points_(points), path_(points, rest_positions_m), fixed_(rest_positions_m.cols()) {
    for (const PathLength::Span& span : path_.spans(rest_positions_m)) rest_lengths_m_.push_back(span.length_m);
    for (std::size_t i = 1; i < points.size(); ++i)
      springs_.push_back(
          std::make_unique<PathLength>(std::vector<EmbeddedPoint>{points[i - 1], points[i]}, rest_positions_m));
    if (settings.pseudo_inverse) inverse_gram_ = inverse_gram(points, rest_positions_m.cols());
    tensions_n_.resize(springs_.size(), 0.0);
  }

  std::vector<const Constraint*> constraints() const override {
    std::vector<const Constraint*> all;
    for (const auto& spring : springs_) all.push_back(spring.get());
    if (settings_.explicit_forces) all.push_back(&fixed_);
    return all;
  }

  // Each spring takes the same share of the length.
  void command_length(double length_m, double length_per_command) override {
    const double rest = rest_length_m();
    contraction_ = length_m / rest;
    contraction_per_command_ = length_per_command / rest;
    hand_out();
  }

  void command_tension(double tension_n, double tension_per_command) override {
    by_tension_ = true;
    tension_n_ = tension_n;
    tension_per_command_ = tension_per_command;
    hand_out();
  }

  void begin_step(const StepStart& start) override {
    time_step_s_ = start.time_step_s;
    start_spans_ = path_.spans(start.positions_m);
    start_rates_m_s_.clear();
    for (std::size_t i = 0; i < start_spans_.size(); ++i)
      start_rates_m_s_.push_back(
          start_spans_[i].direction.dot(points_[i + 1].at(start.velocities_m_s) - points_[i].at(start.velocities_m_s)));
    hand_out();
  }

  std::string why_no_equilibrium() const override {
    return settings_.pseudo_inverse ? "coupling pseudo_inverse does work out of nothing, so no rest state is sought "
                                      "with it; use coupling transpose, or steps in time"
                                    : "";
  }

  Eigen::VectorXd memory() const override {
    return Eigen::Map<const Eigen::VectorXd>(tensions_n_.data(), static_cast<Eigen::Index>(tensions_n_.size()));
  }
  void recall(const Eigen::VectorXd& memory) override {
    tensions_n_.assign(memory.data(), memory.data() + memory.size());
  }

  std::vector<double> tensions_n(const std::vector<double>& multipliers) const override {
    if (settings_.explicit_forces && multipliers.back() != 0.0) return tensions_n_;
    return {multipliers.begin(), multipliers.begin() + static_cast<std::ptrdiff_t>(springs_.size())};
  }
  double compliance_m_n() const override { return static_cast<double>(springs_.size()) / settings_.stiffness_n_m; }

 private:
  double rest_length_m() const {
    double sum = 0.0;
    for (const double length : rest_lengths_m_) sum += length;
    return sum;
  }
  double length_m(std::size_t i) const { return contraction_ * rest_lengths_m_[i]; }

  // A rest state knows no step to hold forces over; there explicit springs are the same as implicit ones.
  bool explicit_now() const { return settings_.explicit_forces && std::isfinite(time_step_s_); }

  void hand_out() {
    if (explicit_now()) {
      hold_forces();
    } else {
      fixed_.clear();
      follow_lengths();
    }
  }

  void hold_forces() {
    for (std::size_t i = 0; i < springs_.size(); ++i) {
      springs_[i]->command_tension(0.0, 0.0);
      tensions_n_[i] = by_tension_ ? tension_n_
                                   : std::max(0.0, settings_.stiffness_n_m * (start_spans_[i].length_m - length_m(i)) +
                                                       settings_.damping_n_s_m * start_rates_m_s_[i]);
    }
    fixed_.set(node_forces());
  }

  // dl/dt is (l - l of the start) / step, so a damper adds to the stiffness and moves the length:
  //   T = (k + b/h) (l - (L + r l0) / (1 + r)),  r = b / (k h)
  void follow_lengths() {
    for (std::size_t i = 0; i < springs_.size(); ++i) {
      if (by_tension_) {
        springs_[i]->command_tension(tension_n_, tension_per_command_);
        continue;
      }
      const double r = settings_.damping_n_s_m / (settings_.stiffness_n_m * time_step_s_);
      const double length = r > 0.0 ? (length_m(i) + r * start_spans_[i].length_m) / (1.0 + r) : length_m(i);
      springs_[i]->command_length(length, 1.0 / (settings_.stiffness_n_m * (1.0 + r)),
                                  contraction_per_command_ * rest_lengths_m_[i] / (1.0 + r));
    }
  }

  Eigen::Matrix3Xd node_forces() const {
    Eigen::MatrixXd on_points = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points_.size()), 3);
    for (std::size_t i = 0; i < start_spans_.size(); ++i) {
      const Eigen::RowVector3d pull = tensions_n_[i] * start_spans_[i].direction.transpose();
      on_points.row(static_cast<Eigen::Index>(i)) += pull;
      on_points.row(static_cast<Eigen::Index>(i) + 1) -= pull;
    }
    if (settings_.pseudo_inverse) on_points = inverse_gram_.solve(on_points);
    Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, fixed_.node_count());
    for (std::size_t i = 0; i < points_.size(); ++i)
      for (std::size_t k = 0; k < points_[i].nodes.size(); ++k)
        forces.col(points_[i].nodes[k]) +=
            points_[i].weights[k] * on_points.row(static_cast<Eigen::Index>(i)).transpose();
    return forces;
  }

  SpringSettings settings_;
  std::vector<EmbeddedPoint> points_;
  PathLength path_;  // measures all spans at once
  std::vector<std::unique_ptr<PathLength>> springs_;
  FixedForces fixed_;
  Eigen::LDLT<Eigen::MatrixXd> inverse_gram_;
  std::vector<double> rest_lengths_m_;
  double contraction_ = 1.0, contraction_per_command_ = 0.0;
  bool by_tension_ = false;
  double tension_n_ = 0.0, tension_per_command_ = 0.0;
  double time_step_s_ = std::numeric_limits<double>::infinity();
  std::vector<PathLength::Span> start_spans_;  // of the step
  std::vector<double> start_rates_m_s_;
  std::vector<double> tensions_n_;  // explicit: those of this step
};

}  // namespace

std::unique_ptr<CableModel> make_spring_cable(const std::vector<EmbeddedPoint>& points,
                                              const Eigen::Matrix3Xd& rest_positions_m,
                                              const SpringSettings& settings) {
  return std::make_unique<SpringCable>(points, rest_positions_m, settings);
}

}  // namespace soft_robot_lab
