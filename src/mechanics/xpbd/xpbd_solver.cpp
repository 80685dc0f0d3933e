// SPDX-License-Identifier: BSD-3-Clause
#include "xpbd_solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "element_colours.h"
#include "element_step.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

struct Colouring {
  std::vector<int> lanes, start;
};

// Colours in the lanes of batches, each colour from a batch of its own.
Colouring lay_out(const TetMesh& mesh) {
  Colouring result;
  result.start.push_back(0);
  for (const std::vector<int>& colour : colour_elements(mesh)) {
    result.lanes.insert(result.lanes.end(), colour.begin(), colour.end());
    while (result.lanes.size() % kLanes != 0) result.lanes.push_back(~colour.back());
    result.start.push_back(static_cast<int>(result.lanes.size()) / kLanes);
  }
  return result;
}

ElementBatches coloured_batches(const Body& body, Colouring colouring, std::vector<int>& start) {
  std::vector<int> rank(body.mesh().node_count());
  std::iota(rank.begin(), rank.end(), 0);
  start = std::move(colouring.start);
  return {body, std::move(colouring.lanes), rank};
}

Eigen::VectorXd shear_stiffnesses_n_m(const Body& body, const ElementBatches& batches) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(body.mesh().node_count());
  for (std::size_t i = 0; i < batches.nodes.size(); ++i) {
    const std::size_t node = i / kLanes % static_cast<std::size_t>(batches.node_count), lane = i % kLanes;
    const std::size_t batch = i / kLanes / static_cast<std::size_t>(batches.node_count);
    if (batches.element[batch * kLanes + lane] < 0) continue;
    const std::size_t pair = batch * static_cast<std::size_t>(batches.pair_count()) + node * (node + 3) / 2;
    sum[batches.nodes[i]] += batches.laplacian[pair][static_cast<int>(lane)];
  }
  return sum;
}

InverseMasses inverse_masses(const Body& body, const Eigen::VectorXd& masses_kg) {
  InverseMasses result;
  result.whole = masses_kg.cwiseInverse().transpose().replicate(3, 1);
  result.whole = body.fixed().array().select(0.0, result.whole.array()).matrix();
  result.root = result.whole.cwiseSqrt();
  return result;
}

}  // namespace

XpbdTables::XpbdTables(const Body& body_in, std::vector<DrivenConstraint> constraints_in,
                       std::vector<SharedLength> shared_in)
    : body(body_in),
      constraints(std::move(constraints_in)),
      shared(std::move(shared_in)),
      loads_n(body.external_forces_n()),
      batches(coloured_batches(body, lay_out(body.mesh()), colour_start)),
      moving(inverse_masses(body, body.node_masses_kg())) {
  resting = inverse_masses(body, shear_stiffnesses_n_m(body, batches));
}

XpbdSolver::XpbdSolver(std::shared_ptr<const XpbdTables> tables, int thread_count)
    : tables_(std::move(tables)),
      loads_n_(tables_->loads_n),
      masses_(&tables_->moving),
      thread_count_(thread_count),
      multipliers_(static_cast<std::size_t>(tables_->batches.count()) * tables_->batches.node_count * 3, splat(0.0)),
      pushed_m_(Eigen::Matrix3Xd::Zero(3, tables_->body.mesh().node_count())),
      solves_(tables_->batches, masses_->root.data()),
      energies_(static_cast<std::size_t>(tables_->batches.count()), splat(0.0)),
      gradient_(Eigen::Matrix3Xd::Zero(3, tables_->body.mesh().node_count())),
      nodes_(tables_->constraints.size()) {}

template <class Work>
void XpbdSolver::for_colours(Work work) const {
  for (std::size_t colour = 0; colour + 1 < tables_->colour_start.size(); ++colour) {
    const int first = tables_->colour_start[colour], count = tables_->colour_start[colour + 1] - first;
    const int parts = std::clamp(count / constants::kBatchesWorthAThread, 1, thread_count_);
#pragma omp parallel for num_threads(parts) schedule(static, 1) if (parts > 1)
    for (int part = 0; part < parts; ++part) work(first + count * part / parts, first + count * (part + 1) / parts);
  }
}

// What a constraint acts on at any time: what it acts on now, and what it couples.
const std::vector<int>& XpbdSolver::touched_by(std::size_t constraint, const NewtonState& state) {
  for (const int node : touched_) gradient_.col(node).setZero();
  const DrivenConstraint& of = tables_->constraints[constraint];
  of.add_gradient(state.positions_m, state.drives, 1.0, gradient_);
  std::vector<int>& nodes = nodes_[constraint];
  if (nodes.empty()) {
    for (Eigen::Index node = 0; node < gradient_.cols(); ++node)
      if (!gradient_.col(node).isZero(0.0)) nodes.push_back(static_cast<int>(node));
    for (const EmbeddedPoint& point : of.constraint->carried_points())
      nodes.insert(nodes.end(), point.nodes.begin(), point.nodes.end());
    for (const Clique& clique : of.constraint->cliques())
      std::copy_if(clique.begin(), clique.end(), std::back_inserter(nodes), [](int node) { return node >= 0; });
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
  touched_ = nodes;
  return touched_;
}

ConstraintLaw XpbdSolver::law_at(std::size_t constraint, const NewtonState& state) const {
  const DrivenConstraint& of = tables_->constraints[constraint];
  const double y = state.constraint_multipliers[static_cast<Eigen::Index>(constraint)];
  return of.law(of.value(state.positions_m, state.drives), y, state.drives);
}

ElementStep XpbdSolver::element_step(double h, NewtonState& state, const Eigen::Matrix3Xd* start_m) {
  return {h,
          masses_->root.data(),
          state.positions_m.data(),
          multipliers_.data(),
          state.element_multipliers_pa.data(),
          start_m ? start_m->data() : nullptr,
          start_m ? tables_->body.viscosity().rayleigh_stiffness_s / h : 0.0};
}

void XpbdSolver::take_up(const std::shared_ptr<const KeptSolves>& kept, double h, double dashpot) {
  const auto of_this_step = [&](const KeptSolves& made) { return made.time_step_s == h && made.dashpot == dashpot; };
  const bool same_step = kept && of_this_step(*kept) && kept->positions_m.size() == solves_.made.positions_m.size();
  if (!same_step || !of_this_step(solves_.made))
    std::fill(solves_.known.begin(), solves_.known.end(), ElementSolves::kNone);
  if (same_step && (kept != kept_ || !of_this_step(solves_.made))) solves_.restore(*kept);
  solves_.made.time_step_s = h;
  solves_.made.dashpot = dashpot;
  std::fill(solves_.fresh.begin(), solves_.fresh.end(), 0);
  kept_ = kept;
}

void XpbdSolver::let_go(std::shared_ptr<const KeptSolves>& kept) {
  if (std::find(solves_.fresh.begin(), solves_.fresh.end(), 1) != solves_.fresh.end())
    kept = kept_ = std::make_shared<const KeptSolves>(solves_.made);
}

// l = -h^2 M^-1/2 f; the forces on held nodes, where M^-1/2 is zero, are not needed and not kept.
void XpbdSolver::load_multipliers(const Eigen::VectorXd& forces_n, double h) {
  for (std::size_t place = 0; place < multipliers_.size(); ++place)
    for (int lane = 0; lane < kLanes; ++lane)
      multipliers_[place][lane] =
          -h * h * root_inverse_mass(place, lane) * forces_n[static_cast<Eigen::Index>(place) * kLanes + lane];
  pushed_m_.setZero();
  for (std::size_t place = 0; place < multipliers_.size(); ++place)
    for (int lane = 0; lane < kLanes; ++lane)
      if (tables_->batches.element[place / element_size() * kLanes + lane] >= 0)
        pushed_m_.data()[coordinate(place, lane)] += root_inverse_mass(place, lane) * multipliers_[place][lane];
}

void XpbdSolver::save_multipliers(double h, Eigen::VectorXd& forces_n) const {
  for (std::size_t place = 0; place < multipliers_.size(); ++place) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const double s = root_inverse_mass(place, lane);
      forces_n[static_cast<Eigen::Index>(place) * kLanes + lane] =
          s > 0.0 ? -multipliers_[place][lane] / (h * h * s) : 0.0;
    }
  }
}

Eigen::VectorXd XpbdSolver::weights_at_rest(double h) const {
  const Eigen::Matrix3Xd& root = tables_->resting.root;
  Eigen::VectorXd weights(root.size() + force_count());
  for (Eigen::Index i = 0; i < root.size(); ++i) weights[i] = root.data()[i] > 0.0 ? 1.0 / root.data()[i] : 0.0;
  for (std::size_t place = 0; place < multipliers_.size(); ++place)
    for (int lane = 0; lane < kLanes; ++lane)
      weights[root.size() + static_cast<Eigen::Index>(place) * kLanes + lane] =
          tables_->batches.element[place / element_size() * kLanes + lane] < 0
              ? 0.0
              : h * h * root.data()[coordinate(place, lane)];
  return weights;
}

// A sweep from zero in no time leaves the nodes where they are, and the multipliers at -h^2 M^-1/2 dE/dx.
Eigen::VectorXd XpbdSolver::forces_of(NewtonState state) {
  constexpr double no_time_s = 1e-10;
  Eigen::VectorXd forces_n = Eigen::VectorXd::Zero(force_count());
  std::fill(multipliers_.begin(), multipliers_.end(), splat(0.0));
  take_up(nullptr, no_time_s, 0.0);
  sweep_elements(no_time_s, state);
  save_multipliers(no_time_s, forces_n);
  return forces_n;
}

void XpbdSolver::predict(const XpbdTask& task, double h, XpbdState& state) {
  Eigen::Matrix3Xd& positions = state.unknowns.positions_m;
  const Eigen::Matrix3Xd start_m = positions;
  Eigen::Matrix3Xd motion = h * state.velocities_m_s + h * h * masses_->whole.cwiseProduct(loads_n_);
  if (task.multipliers_from_zero) {
    std::fill(multipliers_.begin(), multipliers_.end(), splat(0.0));
    pushed_m_.setZero();
  }
  motion += pushed_m_;
  if (task.hysteresis) motion -= h * h * masses_->whole.cwiseProduct(task.hysteresis->gradient_n());
  for (std::size_t i = 0; i < tables_->constraints.size(); ++i) {
    double& y = state.unknowns.constraint_multipliers[static_cast<Eigen::Index>(i)];
    const ConstraintLaw law = law_at(i, state.unknowns);
    y = std::clamp(task.multipliers_from_zero ? 0.0 : y, law.min_multiplier, law.max_multiplier);
    if (y == 0.0) continue;
    for (const int node : touched_by(i, state.unknowns))
      motion.col(node) -= h * h * y * masses_->whole.col(node).cwiseProduct(gradient_.col(node));
  }
  if (contact_) contact_->begin(h, state.unknowns.contact, state.free_velocities, motion);
  positions += masses_->whole.cwiseSign().cwiseProduct(motion);
  if (task.reactions_n) tables_->body.place_held_nodes(state.unknowns.contact.time_s, positions);
  if (contact_) contact_->find(start_m, positions, state.unknowns.contact);
}

void XpbdSolver::sweep_elements(double h, NewtonState& state, const Eigen::Matrix3Xd* start_m) {
  const ElementStep step = element_step(h, state, start_m);
  pushed_m_ -= state.positions_m;
  for_colours([&](int first, int last) { move_elements(tables_->batches, first, last, step, solves_); });
  pushed_m_ += state.positions_m;
}

// Eq. 18 with y = -lambda / h^2, the force: the correction is dy = (o - a y) / (a + h^2 grad C . M^-1 grad C).
void XpbdSolver::sweep_constraints(const XpbdTask& task, double h, NewtonState& state) {
  if (!tables_->shared.empty()) return solve_constraints(task, h, state);
  for (std::size_t i = 0; i < tables_->constraints.size(); ++i) {
    double& y = state.constraint_multipliers[static_cast<Eigen::Index>(i)];
    const ConstraintLaw law = law_at(i, state);
    if (law.prescribed()) continue;
    double weight = 0.0;
    for (const int node : touched_by(i, state)) weight += gradient_.col(node).cwiseAbs2().dot(masses_->whole.col(node));
    const double delassus = law.compliance + h * h * weight;
    if (!(delassus > 0.0)) continue;  // rigid between held nodes: nothing can move
    const double next =
        std::clamp(y + (law.offset - law.compliance * y) / delassus, law.min_multiplier, law.max_multiplier);
    for (const int node : touched_)
      state.positions_m.col(node) -= h * h * (next - y) * masses_->whole.col(node).cwiseProduct(gradient_.col(node));
    y = next;
  }
}

void XpbdSolver::sweep(const XpbdTask& task, double h, const Eigen::Matrix3Xd& start_m, NewtonState& state) {
  const bool dashpots = tables_->body.viscosity().rayleigh_stiffness_s > 0.0 && !task.at_rest;
  sweep_elements(h, state, dashpots ? &start_m : nullptr);
  sweep_constraints(task, h, state);
  if (contact_) contact_->sweep(state.positions_m);
}

void XpbdSolver::find_gradients(const NewtonState& state) {
  gradients_.resize(tables_->constraints.size());
  for (std::size_t i = 0; i < tables_->constraints.size(); ++i) {
    gradients_[i].nodes = touched_by(i, state);
    gradients_[i].columns = gradient_(Eigen::all, touched_);
  }
}

// A constraint that nothing can move keeps its multiplier.
MultiplierProblem XpbdSolver::problem_at(double h, const NewtonState& state, bool slips_go_on) {
  const auto count = static_cast<Eigen::Index>(tables_->constraints.size());
  MultiplierProblem problem{Eigen::MatrixXd(count, count), Eigen::VectorXd(count), {}, {}};
  for (std::size_t i = 0; i < tables_->constraints.size(); ++i) problem.laws.push_back(law_at(i, state));
  for (const SharedLength& shared : tables_->shared)
    problem.friction_contacts.push_back({shared.first, shared.second, shared.contact->ratio(state.positions_m)});
  if (slips_go_on) problem.laws = after_flows(std::move(problem.laws), problem.friction_contacts, state.slips_m);
  for (const int node : touched_) gradient_.col(node).setZero();
  touched_.clear();
  for (Eigen::Index i = 0; i < count; ++i) {
    const NodeGradient& of = gradients_[static_cast<std::size_t>(i)];
    gradient_(Eigen::all, of.nodes) = h * h * masses_->whole(Eigen::all, of.nodes).cwiseProduct(of.columns);
    for (Eigen::Index j = 0; j <= i; ++j) {
      const NodeGradient& other = gradients_[static_cast<std::size_t>(j)];
      double sum = 0.0;
      for (std::size_t k = 0; k < other.nodes.size(); ++k)
        sum += gradient_.col(other.nodes[k]).dot(other.columns.col(static_cast<Eigen::Index>(k)));
      problem.delassus(i, j) = problem.delassus(j, i) = sum;
    }
    for (const int node : of.nodes) gradient_.col(node).setZero();
  }
  const Eigen::VectorXd& y = state.constraint_multipliers;
  problem.excess = problem.delassus * y;
  for (Eigen::Index i = 0; i < count; ++i) {
    ConstraintLaw& law = problem.laws[static_cast<std::size_t>(i)];
    problem.excess[i] += law.offset;
    problem.delassus(i, i) += law.compliance;
    if (problem.delassus(i, i) > 0.0) continue;
    problem.delassus(i, i) = 1.0;
    law.min_multiplier = law.max_multiplier = y[i];
  }
  return problem;
}

void XpbdSolver::solve_constraints(const XpbdTask& task, double h, NewtonState& state) {
  find_gradients(state);
  const Multipliers next = solve_multipliers(problem_at(h, state, !task.at_rest), state.constraint_multipliers);
  if (!next.found) return;
  for (std::size_t i = 0; i < gradients_.size(); ++i) {
    const NodeGradient& of = gradients_[i];
    const auto row = static_cast<Eigen::Index>(i);
    const double change = next.y[row] - state.constraint_multipliers[row];
    for (std::size_t k = 0; k < of.nodes.size(); ++k)
      state.positions_m.col(of.nodes[k]) -=
          h * h * change * masses_->whole.col(of.nodes[k]).cwiseProduct(of.columns.col(static_cast<Eigen::Index>(k)));
  }
  state.constraint_multipliers = next.y;
  state.slips_m = task.at_rest ? next.slips_m : Eigen::VectorXd(state.slips_m + next.slips_m);
}

double XpbdSolver::kinetic_energy(const Eigen::Matrix3Xd& velocities_m_s) const {
  // Not of what is held: holds that move bring that themselves.
  return 0.5 * masses_->whole.cwiseSign()
                   .cwiseProduct(velocities_m_s.cwiseAbs2())
                   .colwise()
                   .sum()
                   .dot(tables_->body.node_masses_kg());
}

double XpbdSolver::stored_energy(const Eigen::Matrix3Xd& positions_m) {
  measure_energy(tables_->batches, positions_m.data(), energies_.data());
  double sum = 0.0;
  for (const Batch& batch : energies_)
    for (int lane = 0; lane < kLanes; ++lane) sum += batch[lane];
  return sum;
}

XpbdSolver::Account XpbdSolver::open_account(const XpbdTask& task, const XpbdState& state) {
  Account account;
  for (const DrivenConstraint& of : tables_->constraints)
    account.values.push_back(of.value(state.unknowns.positions_m, state.unknowns.drives));
  account.before_j = kinetic_energy(state.velocities_m_s) + stored_energy(state.unknowns.positions_m);
  if (task.hysteresis) account.before_j += task.hysteresis->energy_j();
  return account;
}

void XpbdSolver::add_work(const XpbdTask& task, const Eigen::Matrix3Xd& motion_m, const NewtonState& state,
                          Account& account) const {
  double brought_j = loads_n_.cwiseProduct(motion_m).sum();
  if (task.reactions_n) brought_j += task.reactions_n(state).cwiseProduct(motion_m).sum();
  for (std::size_t i = 0; i < tables_->constraints.size(); ++i) {
    const double value = tables_->constraints[i].value(state.positions_m, state.drives);
    brought_j -= state.constraint_multipliers[static_cast<Eigen::Index>(i)] * (value - account.values[i]);
    account.values[i] = value;
  }
  account.bring(brought_j);
}

void XpbdSolver::close_account(const XpbdTask& task, const Account& account, const XpbdState& state,
                               XpbdReport& report) {
  const NewtonState& unknowns = state.unknowns;
  report.kinetic_energy_j = kinetic_energy(state.velocities_m_s);
  double after_j = report.kinetic_energy_j + stored_energy(unknowns.positions_m);
  if (task.hysteresis) after_j += task.hysteresis->energy_j();
  const double least_j = 1e-9 * tables_->body.material().youngs_modulus_pa * tables_->body.node_masses_kg().sum() /
                         tables_->body.material().density_kg_m3;
  report.created_energy =
      (after_j - account.before_j - account.work_j) / (account.before_j + account.moved_j + least_j);
  report.finite = std::isfinite(report.created_energy) && state.element_forces_n.allFinite() &&
                  state.branch_stress_pa.allFinite() && unknowns.element_multipliers_pa.allFinite() &&
                  unknowns.constraint_multipliers.allFinite() && unknowns.slips_m.allFinite() &&
                  unknowns.contact.pressures_pa.allFinite();
  report.stable = report.finite && report.created_energy <= constants::kMostCreatedEnergy;
}

void XpbdSolver::add_free_obstacles(const XpbdState& state, XpbdReport& report) const {
  const FreePoses& poses = state.unknowns.contact.free;
  report.finite = report.finite && poses.centers_m.allFinite() && poses.turns.allFinite();
  report.stable = report.stable && report.finite;
  report.kinetic_energy_j += free_kinetic_j(contact_->free(), poses, state.free_velocities);
  report.free_inertia = contact_->free_inertia();
}

void XpbdSolver::stop(XpbdState& state, bool first, XpbdReport& report) const {
  const auto& inverse = masses_->whole.array();
  const double motion = std::sqrt((inverse > 0.0).select(state.velocities_m_s.array().square() / inverse, 0.0).sum());
  if (first) report.first_motion = motion;
  report.last_motion = motion;
  state.velocities_m_s.setZero();
}

XpbdReport XpbdSolver::advance(const XpbdTask& task, XpbdState& state) {
  XpbdReport report;
  masses_ = task.at_rest ? &tables_->resting : &tables_->moving;
  report.substeps = task.substep_count;
  const double h = task.time_step_s / task.substep_count;
  NewtonState& unknowns = state.unknowns;
  const double slowing = 1.0 / (1.0 + tables_->body.viscosity().rayleigh_mass_per_s * h);
  const bool dashpots = tables_->body.viscosity().rayleigh_stiffness_s > 0.0 && !task.at_rest;
  if (task.hysteresis) task.hysteresis->begin(unknowns.positions_m, state.branch_stress_pa);
  Account account = open_account(task, state);
  take_up(state.kept, h, dashpots ? tables_->body.viscosity().rayleigh_stiffness_s / h : 0.0);
  load_multipliers(state.element_forces_n, h);
  contact_.reset();
  if (task.contact)
    contact_.emplace(*task.contact, tables_->body, masses_->whole, unknowns.positions_m, unknowns.contact);
  const double from_s = unknowns.contact.time_s;
  for (int substep = 0; substep < task.substep_count; ++substep) {
    const double over = (substep + 1.0) / task.substep_count;
    if (task.drives_at) unknowns.drives = task.drives_at(over);
    unknowns.contact.time_s = from_s + over * (task.until_s - from_s);
    const Eigen::Matrix3Xd before = unknowns.positions_m;
    if (slowing < 1.0) state.velocities_m_s *= slowing;
    if (substep + 1 == task.substep_count) {
      report.started_m = before;
      report.predicted_m = before + h * state.velocities_m_s;
      if (task.hysteresis) report.predicted_m -= h * h * masses_->whole.cwiseProduct(task.hysteresis->gradient_n());
    }
    predict(task, h, state);
    for (int iteration = 0; iteration < task.iteration_count; ++iteration) {
      if (interrupt_) interrupt_->check();
      sweep(task, h, before, unknowns);
      ++report.sweeps;
    }
    const Eigen::Matrix3Xd motion = unknowns.positions_m - before;
    state.velocities_m_s = motion / h;
    // A node that moves so far flies apart with its body, and looks for skin that it touches without end.
    if (!(motion.colwise().norm().maxCoeff() < tables_->body.size_m())) return report;
    if (contact_)
      account.bring(contact_->finish(before, unknowns.positions_m, unknowns.contact, state.free_velocities));
    add_work(task, motion, unknowns, account);
    if (task.hysteresis) task.hysteresis->follow(unknowns.positions_m, h);
    if (task.at_rest) stop(state, substep == 0, report);
  }
  save_multipliers(h, state.element_forces_n);
  let_go(state.kept);
  if (task.hysteresis) state.branch_stress_pa = task.hysteresis->stress_pa();
  close_account(task, account, state, report);
  if (contact_) add_free_obstacles(state, report);
  return report;
}

XpbdReport XpbdSolver::advance_stably(XpbdTask task, XpbdState& state) {
  const XpbdState start = state;
  XpbdReport kept;
  int sweeps = 0, rejected = 0;
  const auto attempt = [&] {
    XpbdState trial = start;
    const XpbdReport report = advance(task, trial);
    sweeps += report.sweeps;
    rejected += report.stable ? 0 : 1;
    if (!report.finite) return;
    kept = report;
    state = std::move(trial);
  };
  for (int doubling = 0; doubling <= constants::kDoublings && !kept.stable; ++doubling, task.substep_count *= 2)
    attempt();
  if (!kept.finite) {
    task.substep_count /= 2;
    task.multipliers_from_zero = true;
    attempt();
  }
  kept.sweeps = sweeps;
  kept.rejected_steps = rejected;
  return kept;
}

}  // namespace soft_robot_lab
