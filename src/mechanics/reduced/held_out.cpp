// SPDX-License-Identifier: BSD-3-Clause
#include "held_out.h"

#include <algorithm>
#include <cmath>

#include "reduced_simulation.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kFirstHeldOut = 5000;  // of the commands; training has smaller numbers
constexpr unsigned kHeldOutSeed = 2;

class ErrorSum {
 public:
  void add(bool solved, const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
    ++error_.states;
    if (!solved) {
      ++error_.unsolved;
      return;
    }
    const Eigen::RowVectorXd squares = (a - b).colwise().squaredNorm();
    squares_ += squares.mean();
    error_.max_m = std::max(error_.max_m, std::sqrt(squares.maxCoeff()));
  }
  ReducedError result() const {
    ReducedError error = error_;
    error.rms_m = std::sqrt(squares_ / std::max(1, error.states - error.unsolved));
    return error;
  }

 private:
  ReducedError error_;
  double squares_ = 0.0;
};

}  // namespace

HeldOut::Shape HeldOut::shape_of(const Simulation& simulation, bool converged) {
  return {simulation.state().commands(), converged, simulation.state().positions_m};
}

HeldOut::HeldOut(const std::shared_ptr<const Model>& model, const CommandBox& box, int equilibria, double transient_s,
                 const TrainingProgress& progress) {
  Simulation full(model);
  for (int i = 0; i < equilibria; ++i) {
    if (progress) progress(0.5 * i / equilibria, "equilibria to judge by");
    full.reset();
    command(commands_in(box, kFirstHeldOut + static_cast<std::size_t>(i)), full);
    const bool converged = full.solve_equilibrium().converged;
    equilibria_.push_back(shape_of(full, converged));
  }
  if (progress) progress(0.5, "motion to judge by");
  run_transient(box, transient_s, kHeldOutSeed, full,
                [&](int /*step*/, bool converged) { transient_.push_back(shape_of(full, converged)); });
}

ReducedError HeldOut::equilibria(const std::shared_ptr<const ReducedModel>& reduced) const {
  ErrorSum sum;
  ReducedSimulation fast(reduced);
  for (const Shape& shape : equilibria_) {
    fast.reset();
    command(shape.commands, fast);
    const bool solved = fast.solve_equilibrium().converged;  // before the arguments below, whose order is free
    sum.add(solved && shape.converged, shape.positions_m, fast.positions_m());
  }
  return sum.result();
}

ReducedError HeldOut::transient(const std::shared_ptr<const ReducedModel>& reduced) const {
  ErrorSum sum;
  ReducedSimulation fast(reduced);
  for (const Shape& shape : transient_) {
    command(shape.commands, fast);
    const bool solved = fast.step().converged;
    sum.add(solved && shape.converged, shape.positions_m, fast.positions_m());
  }
  return sum.result();
}

ReducedError HeldOut::projection(const ReducedModel& reduced) const {
  ErrorSum sum;
  const Body& body = reduced.full->body();
  const Eigen::MatrixXd to_modes = reduced.basis.modes.transpose() * masses_of_axes_kg(body).asDiagonal();
  for (const Shape& shape : transient_) {
    const Eigen::Matrix3Xd moved = shape.positions_m - body.mesh().nodes_m;
    const Eigen::VectorXd q = to_modes * Eigen::Map<const Eigen::VectorXd>(moved.data(), moved.size());
    sum.add(shape.converged, shape.positions_m, reduced.positions_m(q));
  }
  return sum.result();
}

}  // namespace soft_robot_lab
