#include "soft_robot_lab/sim/simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

#include "gauss_seidel_solver.h"
#include "newton_solver.h"

namespace soft_robot_lab {
namespace {

constexpr double kSmallestStage = 64;   // a command change is cut into at most this many continuation stages
constexpr int kDeepestHalving = 6;      // a time step is cut into at most 2^6 parts
constexpr double kLargestGrowth = 2.0;  // of a time step over the one before; BDF2 is stable up to 1 + sqrt(2)
constexpr int kRelaxationSteps = 600;   // time steps in which gauss_seidel must come to rest
constexpr int kPatience = 100;        // of which it takes this many before it doubles its substeps, four times at most
constexpr int kPullSteps = 30;        // over which it moves the actuators then
constexpr int kThreads = 2;           // of gauss_seidel, on meshes large enough to be worth it
constexpr int kStageIterations = 25;  // Newton iterations before a stage is cut
constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr int kBudget = 10;  // an equilibrium may take this many times max_iterations in all

void require(bool ok, const char* field, double value, const char* range) {
  if (ok) return;
  std::ostringstream message;
  message << field << ": " << value << " is out of range " << range;
  throw std::invalid_argument(message.str());
}

template <class Items, class NameOf>
int index_of(const std::string& kind, const std::string& name, const Items& items, NameOf name_of) {
  std::string known;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (name_of(items[i]) == name) return static_cast<int>(i);
    known += (i == 0 ? "" : ", ") + name_of(items[i]);
  }
  throw std::invalid_argument("unknown " + kind + " '" + name + "'; known: " + (known.empty() ? "none" : known));
}

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Backward differentiation over one step of length h, or over it and the one before:  y' = (y - from) / gamma.
// With w = h / previous h (Hairer, Norsett & Wanner 1993, III.5):
//   gamma = h (1 + w) / (1 + 2 w),   from = ((1 + w)^2 y1 - w^2 y2) / (1 + 2 w);   w = 0 is implicit Euler.
// Applied to x and v it gives  M (x - x~) / gamma^2 = force(x),  x~ = x_from + gamma v_from.
// For equal steps:  9/4 M (x - x~) / h^2 = force(x),  x~ = (4 x1 - x2) / 3 + 2/9 h (4 v1 - v2).
struct BackwardDifference {
  double gamma_s;
  Eigen::Matrix3Xd positions_from_m, velocities_from_m_s;

  BackwardDifference(const SimulationState& state, double h) {
    const double w = state.previous_step_s > 0.0 ? h / state.previous_step_s : 0.0;
    if (w == 0.0 || w > kLargestGrowth) {
      gamma_s = h;
      positions_from_m = state.positions_m;
      velocities_from_m_s = state.velocities_m_s;
      return;
    }
    const double one = (1.0 + w) * (1.0 + w) / (1.0 + 2.0 * w), two = w * w / (1.0 + 2.0 * w);
    gamma_s = h * (1.0 + w) / (1.0 + 2.0 * w);
    positions_from_m = one * state.positions_m - two * state.previous_positions_m;
    velocities_from_m_s = one * state.velocities_m_s - two * state.previous_velocities_m_s;
  }
};

std::vector<const Constraint*> constraints_of(const std::vector<std::unique_ptr<Actuator>>& actuators) {
  std::vector<const Constraint*> all;
  for (const auto& actuator : actuators)
    for (const Constraint* constraint : actuator->constraints()) all.push_back(constraint);
  return all;
}

std::vector<SharedLength> shared_lengths_of(const std::vector<std::unique_ptr<Actuator>>& actuators) {
  std::vector<SharedLength> all;
  int offset = 0;
  for (const auto& actuator : actuators) {
    for (const Junction* junction : actuator->junctions())
      all.push_back({junction, offset + junction->first, offset + junction->second});
    offset += static_cast<int>(actuator->constraints().size());
  }
  return all;
}

}  // namespace

void SolverOptions::validate() const {
  require(time_step_s > 0.0 && time_step_s <= 1.0, "solver.time_step_s", time_step_s, "(0, 1]");
  require(tolerance > 0.0 && tolerance < 1.0, "solver.tolerance", tolerance, "(0, 1)");
  require(dynamic_tolerance > 0.0 && dynamic_tolerance < 1.0, "solver.dynamic_tolerance", dynamic_tolerance, "(0, 1)");
  require(max_iterations >= 1 && max_iterations <= 10000, "solver.max_iterations", max_iterations, "[1, 10000]");
  require(substep_count >= 1 && substep_count <= 10000, "solver.substeps", substep_count, "[1, 10000]");
  require(iteration_count >= 1 && iteration_count <= 10000, "solver.iterations", iteration_count, "[1, 10000]");
  if (method == Method::gauss_seidel && integrator != Integrator::implicit_euler)
    throw std::invalid_argument("solver.integrator: must be implicit_euler with solver.method gauss_seidel, not bdf2");
}

struct Simulation::Parts {
  Body body;
  std::vector<std::unique_ptr<Actuator>> actuators;
  std::vector<Marker> markers;
  SolverOptions options;
  NewtonSolver solver;
  std::unique_ptr<GaussSeidelSolver> gauss_seidel;  // where it is the method
  SimulationState state;

  Parts(Body body_in, std::vector<std::unique_ptr<Actuator>> actuators_in, std::vector<Marker> markers_in,
        const SolverOptions& options_in)
      : body(std::move(body_in)),
        actuators(std::move(actuators_in)),
        markers(std::move(markers_in)),
        options(options_in),
        solver(body, constraints_of(actuators), shared_lengths_of(actuators)) {
    if (options.method == SolverOptions::Method::gauss_seidel)
      gauss_seidel = std::make_unique<GaussSeidelSolver>(body, constraints_of(actuators), kThreads);
  }

  NewtonState unknowns() const {
    return {state.positions_m, state.element_multipliers_pa, state.constraint_multipliers,
            Eigen::VectorXd::Zero(solver.junction_count())};
  }

  void begin_step(double time_step_s) {
    for (auto& actuator : actuators) actuator->begin_step({state.positions_m, state.velocities_m_s, time_step_s});
  }

  void accept(NewtonState solved) {
    state.positions_m = std::move(solved.positions_m);
    state.element_multipliers_pa = std::move(solved.element_multipliers_pa);
    state.constraint_multipliers = std::move(solved.constraint_multipliers);
    const double* flow = solved.flows_m.data();
    for (auto& actuator : actuators) {
      const std::size_t count = actuator->junctions().size();
      actuator->end_step({flow, flow + count});
      flow += count;
    }
  }

  // What actuators and solver know, so that a copy of the state has it.
  void remember() {
    state.linearisation = solver.linearisation();
    for (std::size_t i = 0; i < actuators.size(); ++i) {
      state.commands[i] = actuators[i]->command();
      state.actuated_commands[i] = actuators[i]->actuated_command();
      state.actuator_memories[i] = actuators[i]->memory();
    }
  }

  void move_actuators(const std::vector<double>& from, double share) {
    for (std::size_t i = 0; i < actuators.size(); ++i) {
      const double target = actuators[i]->command();
      actuators[i]->place(from[i] + share * (target - from[i]));
    }
  }

  // "element 12 at (0.01, 0, 0.02) m"
  std::string place_of(int element) const {
    if (element < 0) return "nowhere";
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 4; ++corner)
      centre += 0.25 * body.mesh().nodes_m.col(body.mesh().tets(corner, element));
    std::ostringstream text;
    text << "element " << element << " at rest position (" << centre.x() << ", " << centre.y() << ", " << centre.z()
         << ") m";
    return text.str();
  }

  // Solves from the present state, which it leaves alone; the report counts the work and tells how this solve ended.
  NewtonReport solve(const NewtonTask& task, NewtonState& unknown, SolveReport& report) {
    const NewtonReport newton = solver.solve(task, unknown);
    ++report.steps;
    report.iterations += newton.iterations;
    report.factorisations += newton.factorisations;
    report.rejected_steps += newton.shortened + newton.convexified + (newton.converged ? 0 : 1);
    tell_end(newton, report);
    return newton;
  }

  void tell_end(const NewtonReport& newton, SolveReport& report) const {
    report.converged = newton.converged;
    report.residual = newton.residual;
    report.inverted_elements = newton.inverted_elements;
    report.message = newton.reason;
    if (newton.inverted_elements > 0) {
      if (!report.message.empty()) report.message += "; ";
      report.message +=
          std::to_string(newton.inverted_elements) + " inverted elements, the worst " + place_of(newton.worst_element);
    }
  }

  // One step of length h, or two halves where it does not converge. What bdf2 knows of the step before lets their
  // lengths differ; where they grow too fast, as they may after halved steps, one step is implicit Euler's.
  void advance(double h, int depth, SolveReport& report) {
    SimulationState before = state;
    for (auto& actuator : actuators) actuator->advance(h);
    begin_step(h);
    const BackwardDifference difference(state, h);
    const Eigen::Matrix3Xd predicted =
        difference.positions_from_m + difference.gamma_s * difference.velocities_from_m_s;
    NewtonTask task;
    task.inertia_per_s2 = 1.0 / (difference.gamma_s * difference.gamma_s);
    task.predicted_m = &predicted;
    task.tolerance = options.dynamic_tolerance;
    task.min_iterations = 1;
    task.reuse_factor = true;
    task.max_iterations =
        depth < kDeepestHalving ? std::min(options.max_iterations, kStageIterations) : options.max_iterations;
    NewtonState unknown = unknowns();
    unknown.positions_m = state.positions_m + h * state.velocities_m_s;
    if (!solve(task, unknown, report).converged && depth < kDeepestHalving) {
      restore(before);
      advance(0.5 * h, depth + 1, report);
      const bool first = report.converged;
      advance(0.5 * h, depth + 1, report);
      report.converged = report.converged && first;
      return;
    }
    state.velocities_m_s = (unknown.positions_m - difference.positions_from_m) / difference.gamma_s;
    accept(std::move(unknown));
    state.time_s = before.time_s + h;
    if (options.integrator == Integrator::bdf2) {
      state.previous_step_s = h;
      state.previous_positions_m = std::move(before.positions_m);
      state.previous_velocities_m_s = std::move(before.velocities_m_s);
    }
    remember();
  }

  bool within_budget(const SolveReport& report) const { return report.iterations < kBudget * options.max_iterations; }

  bool relax(SolveReport& report) {
    NewtonTask task;
    task.tolerance = options.tolerance;
    task.max_iterations = std::min(options.max_iterations, kStageIterations);
    begin_step(kForever);
    NewtonState unknown = unknowns();
    if (!solve(task, unknown, report).converged) return false;
    accept(std::move(unknown));
    return true;
  }

  // Down the energy in steps that inertia keeps short, longer and longer (pseudo-transient continuation, Kelley & Keyes
  // 1998), until inertia has no say and Newton alone converges: finds its way through buckling, where a rest state that
  // Newton would run to is a saddle.
  bool descend(SolveReport& report) {
    const Material& material = body.material();
    const double wave_s = body.size_m() * std::sqrt(material.density_kg_m3 / material.youngs_modulus_pa);
    double h = 3.0 * wave_s;
    while (within_budget(report) && h > 1e-3 * wave_s) {
      NewtonTask task;
      task.tolerance = std::max(options.tolerance, 1e-4);
      task.min_iterations = 1;
      task.max_iterations = kStageIterations;
      task.inertia_per_s2 = 1.0 / (h * h);
      const Eigen::Matrix3Xd start = state.positions_m;
      task.predicted_m = &start;
      begin_step(kForever);
      NewtonState unknown = unknowns();
      const NewtonReport newton = solve(task, unknown, report);
      if (!newton.converged) {
        h *= 0.25;
        continue;
      }
      accept(std::move(unknown));
      if (h > 1e3 * wave_s && relax(report)) return true;
      h *= newton.iterations <= 5 ? 3.0 : 1.5;
    }
    return false;
  }

  void forget_previous_step() {
    state.previous_step_s = 0.0;
    state.previous_positions_m.resize(3, 0);
    state.previous_velocities_m_s.resize(3, 0);
  }

  // One time step of gauss_seidel; kept only where it is finite. The residual is that of a body at rest or of the last
  // substep.
  GaussSeidelReport advance_in_substeps(const GaussSeidelTask& task, bool at_rest, SolveReport& report) {
    const SimulationState before = state;
    GaussSeidelState moving{unknowns(), state.velocities_m_s, state.element_forces_n};
    const GaussSeidelReport done = gauss_seidel->advance_stably(task, moving);
    ++report.steps;
    report.iterations += done.sweeps;
    report.rejected_steps += done.rejected_steps;
    NewtonReport found;
    if (done.finite) {
      accept(std::move(moving.unknowns));
      state.velocities_m_s = std::move(moving.velocities_m_s);
      state.element_forces_n = std::move(moving.element_forces_n);
      NewtonTask residual;
      residual.max_iterations = 0;
      residual.tolerance = options.tolerance;
      residual.predicted_m = &done.predicted_m;
      residual.inertia_per_s2 = at_rest ? 0.0 : std::pow(done.substeps / task.time_step_s, 2);
      NewtonState measured = unknowns();
      found = solver.solve(residual, measured);
      if (!at_rest) {
        found.converged = done.stable;
        found.reason =
            done.stable ? "" : "the step created energy with " + std::to_string(done.substeps) + " substeps too";
      }
    } else {
      restore(before);
      found.residual = 1.0;
      found.reason = "the step went non-finite and was undone";
    }
    tell_end(found, report);
    return done;
  }

  GaussSeidelTask substepping() const {
    GaussSeidelTask task;
    task.time_step_s = options.time_step_s;
    task.substep_count = options.substep_count;
    task.iteration_count = options.iteration_count;
    return task;
  }

  void step_in_substeps(SolveReport& report) {
    const std::vector<double> from = state.actuated_commands;
    std::vector<double> to;
    for (auto& actuator : actuators) {
      actuator->advance(options.time_step_s);
      to.push_back(actuator->actuated_command());
    }
    GaussSeidelTask task = substepping();
    task.before_substep = [&](double share, const GaussSeidelState& start, double h) {
      for (std::size_t i = 0; i < actuators.size(); ++i) {
        // Also a command without a speed limit takes the whole time step to arrive.
        actuators[i]->place(from[i] + share * (to[i] - from[i]));
        actuators[i]->begin_step({start.unknowns.positions_m, start.velocities_m_s, h});
      }
    };
    if (!advance_in_substeps(task, false, report).finite) return;
    state.time_s += task.time_step_s;
    remember();
  }

  // Dynamic relaxation with kinetic damping (Cundall 1976): motion stops whenever it has begun to slow down.
  void settle_in_substeps(SolveReport& report) {
    const std::vector<double> from = state.actuated_commands;
    GaussSeidelTask task = substepping();
    double last_kinetic_energy = 0.0;
    begin_step(kForever);
    for (int step = 1; step <= kRelaxationSteps; ++step) {
      move_actuators(from, std::min(1.0, static_cast<double>(step) / kPullSteps));
      const GaussSeidelReport done = advance_in_substeps(task, true, report);
      if (!done.finite) break;
      if (done.kinetic_energy_j < last_kinetic_energy) state.velocities_m_s.setZero();
      last_kinetic_energy = done.kinetic_energy_j;
      if (report.converged && step >= kPullSteps) break;
      if (step % kPatience == 0 && step <= 4 * kPatience) task.substep_count *= 2;
    }
    state.velocities_m_s.setZero();
    if (!report.converged)
      report.message = "not at rest after " + std::to_string(report.steps) + " time steps: " + report.message;
  }

  void restore(const SimulationState& saved) {
    state = saved;
    if (options.integrator != Integrator::bdf2) forget_previous_step();
    for (std::size_t i = 0; i < actuators.size(); ++i)
      actuators[i]->restore(saved.commands[i], saved.actuated_commands[i], saved.actuator_memories[i]);
  }
};

Simulation::Simulation(Body body, std::vector<std::unique_ptr<Actuator>> actuators, std::vector<Marker> markers,
                       const SolverOptions& options) {
  options.validate();
  if (body.fixed_node_count() == 0) throw std::invalid_argument("body.fixed: no node is held; the robot would fall");
  std::set<std::string> names;
  for (const auto& actuator : actuators)
    if (!names.insert(actuator->name()).second)
      throw std::invalid_argument("two actuators are named '" + actuator->name() + "'");
  names.clear();
  for (const Marker& marker : markers)
    if (!names.insert(marker.name()).second)
      throw std::invalid_argument("two markers are named '" + marker.name() + "'");
  parts_ = std::make_unique<Parts>(std::move(body), std::move(actuators), std::move(markers), options);
  reset();
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

void Simulation::set_command(const std::string& actuator, double command) {
  const int index = actuator_index(actuator);
  parts_->actuators[index]->set_command(command);
  parts_->state.commands[index] = command;
  parts_->state.actuator_memories[index] = parts_->actuators[index]->memory();
}

SolveReport Simulation::step() {
  const Stopwatch clock;
  SolveReport report;
  if (parts_->gauss_seidel) {
    parts_->step_in_substeps(report);
  } else {
    parts_->advance(parts_->options.time_step_s, 0, report);
  }
  report.wall_s = clock.seconds();
  return report;
}

SolveReport Simulation::solve_equilibrium() {
  const Stopwatch clock;
  SolveReport report;
  Parts& p = *parts_;
  for (const auto& actuator : p.actuators)
    if (const std::string why = actuator->why_no_equilibrium(); !why.empty())
      throw std::invalid_argument("actuator '" + actuator->name() + "': " + why);
  const SimulationState before = p.state;
  p.state.velocities_m_s.setZero();
  p.forget_previous_step();
  if (p.gauss_seidel) {
    p.settle_in_substeps(report);
    p.remember();
    report.wall_s = clock.seconds();
    return report;
  }
  const std::vector<double> from = p.state.actuated_commands;
  double done = 0.0, stage = 1.0;
  while (done < 1.0 && p.within_budget(report)) {
    const double share = std::min(1.0, done + stage);
    p.move_actuators(from, share);
    bool found = p.relax(report);
    if (!found && stage * kSmallestStage <= 1.0) {
      found = p.descend(report);
      if (!found) break;
    }
    if (found) done = share;
    stage *= found ? 2.0 : 0.5;
  }
  if (done < 1.0) {
    p.move_actuators(from, 1.0);
    report.converged = false;
    std::ostringstream reached;
    reached << "no equilibrium found beyond " << 100.0 * done << " % of the command change, in " << report.iterations
            << " iterations: " << (report.message.empty() ? "work limit" : report.message);
    report.message = reached.str();
  }
  p.state.time_s = before.time_s;
  p.remember();
  report.wall_s = clock.seconds();
  return report;
}

Eigen::MatrixXd Simulation::marker_sensitivities() {
  Parts& p = *parts_;
  p.begin_step(kForever);
  const Eigen::MatrixXd motions = p.solver.sensitivities(p.unknowns());
  p.remember();
  if (motions.rows() == 0 && p.solver.constraint_count() > 0)
    throw std::runtime_error("no sensitivity: the present state is not a stable equilibrium");
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(p.markers.size()),
                                                 static_cast<Eigen::Index>(p.actuators.size()));
  Eigen::Index column = 0;
  for (std::size_t a = 0; a < p.actuators.size(); ++a) {
    for (std::size_t i = 0; i < p.actuators[a]->constraints().size(); ++i, ++column) {
      const Eigen::Map<const Eigen::Matrix3Xd> motion(motions.col(column).data(), 3, p.state.positions_m.cols());
      for (std::size_t m = 0; m < p.markers.size(); ++m)
        result.block<3, 1>(3 * static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(a)) +=
            p.markers[m].velocity(p.state.positions_m, motion);
    }
  }
  return result;
}

void Simulation::reset() {
  Parts& p = *parts_;
  SimulationState& s = p.state;
  s.time_s = 0.0;
  s.positions_m = p.body.mesh().nodes_m;
  s.velocities_m_s = Eigen::Matrix3Xd::Zero(3, p.body.mesh().node_count());
  p.forget_previous_step();
  s.element_multipliers_pa = Eigen::VectorXd::Zero(p.body.mesh().tet_count());
  s.constraint_multipliers = Eigen::VectorXd::Zero(p.solver.constraint_count());
  s.element_forces_n = Eigen::VectorXd::Zero(p.gauss_seidel ? p.gauss_seidel->force_count() : 0);
  for (auto& actuator : p.actuators) actuator->reset();
  s.commands.resize(p.actuators.size());
  s.actuated_commands.resize(p.actuators.size());
  s.actuator_memories.resize(p.actuators.size());
  p.remember();
  s.linearisation = nullptr;
  p.solver.restore(nullptr);
}

const SimulationState& Simulation::state() const { return parts_->state; }

void Simulation::set_state(const SimulationState& state) {
  const SimulationState& now = parts_->state;
  const bool sizes =
      state.positions_m.cols() == now.positions_m.cols() && state.velocities_m_s.cols() == now.velocities_m_s.cols() &&
      state.element_multipliers_pa.size() == now.element_multipliers_pa.size() &&
      state.constraint_multipliers.size() == now.constraint_multipliers.size() &&
      state.element_forces_n.size() == now.element_forces_n.size() && state.commands.size() == now.commands.size() &&
      state.actuated_commands.size() == now.actuated_commands.size() &&
      std::equal(state.actuator_memories.begin(), state.actuator_memories.end(), now.actuator_memories.begin(),
                 now.actuator_memories.end(), [](const auto& a, const auto& b) { return a.size() == b.size(); });
  const Eigen::Index previous = state.previous_step_s != 0.0 ? now.positions_m.cols() : 0;
  const bool previous_sizes =
      state.previous_positions_m.cols() == previous && state.previous_velocities_m_s.cols() == previous;
  if (!sizes || !previous_sizes) throw std::invalid_argument("state: its sizes are not those of this simulation");
  require(state.previous_step_s >= 0.0 && state.previous_step_s <= 1.0, "state.previous_step_s", state.previous_step_s,
          "[0, 1]");
  if (!state.previous_positions_m.allFinite() || !state.previous_velocities_m_s.allFinite() ||
      !state.positions_m.allFinite() || !state.velocities_m_s.allFinite() ||
      !state.element_multipliers_pa.allFinite() || !state.constraint_multipliers.allFinite() ||
      !state.element_forces_n.allFinite() || !std::isfinite(state.time_s) ||
      !std::all_of(state.actuator_memories.begin(), state.actuator_memories.end(),
                   [](const auto& memory) { return memory.allFinite(); }))
    throw std::invalid_argument("state: not finite");
  parts_->restore(state);
  parts_->solver.restore(state.linearisation);
}

const Body& Simulation::body() const { return parts_->body; }
const SolverOptions& Simulation::options() const { return parts_->options; }
const std::vector<Marker>& Simulation::markers() const { return parts_->markers; }
const std::vector<std::unique_ptr<Actuator>>& Simulation::actuators() const { return parts_->actuators; }

int Simulation::actuator_index(const std::string& name) const {
  return index_of("actuator", name, parts_->actuators, [](const auto& actuator) { return actuator->name(); });
}

int Simulation::marker_index(const std::string& name) const {
  return index_of("marker", name, parts_->markers, [](const Marker& marker) { return marker.name(); });
}

Eigen::Vector3d Simulation::marker_position(int marker) const {
  return parts_->markers.at(marker).position(parts_->state.positions_m);
}

ActuatorReading Simulation::actuator_state(int actuator) const {
  std::size_t first = 0;
  for (int i = 0; i < actuator; ++i) first += parts_->actuators[i]->constraints().size();
  const Actuator& chosen = *parts_->actuators.at(actuator);
  std::vector<double> multipliers;
  for (std::size_t i = 0; i < chosen.constraints().size(); ++i)
    multipliers.push_back(parts_->state.constraint_multipliers[static_cast<Eigen::Index>(first + i)]);
  ActuatorReading state = chosen.observe(parts_->state.positions_m, multipliers);
  state.name = chosen.name();
  state.command = chosen.command();
  state.actuated_command = chosen.actuated_command();
  return state;
}

}  // namespace soft_robot_lab
