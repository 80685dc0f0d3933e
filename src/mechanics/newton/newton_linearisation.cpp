// SPDX-License-Identifier: BSD-3-Clause
// Newton's matrix: how it is put together, factorised, and made again for a saved state.
#include <algorithm>

#include "mechanics/solver_constants.h"
#include "newton_solver.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kMostKept = 10;  // as many states as a search starts from
constexpr double kMostKeptBytes = 1.28e8;

}  // namespace

bool NewtonSolver::linearise(const NewtonState& state, double inertia_per_s2,
                             const std::shared_ptr<const StrainTarget>& strain_target, bool convex, Slip slip) {
  keep_factor();
  forget_factor();
  turns_.resize(3, 0);
  matrix_.set_zero();
  elements_.add_hessian(state.positions_m, state.element_multipliers_pa, convex, matrix_);
  if (strain_target) springs_.add_hessian(state.positions_m, *strain_target, convex, matrix_);
  terms_.add_hessian(state.positions_m, state.drives, convex, matrix_);
  if (!soft_contact_) {
    ContactSums sums = contact_.sums(state.positions_m, state.contact);
    touches_ = std::move(sums.touches);
    skin_in_border_ = inertia_per_s2 > 0.0 && may_be_in_border(touches_, kMostInBorder);
    rigid_touches_ = std::move(sums.rigid);
    for (ContactTouch& touch : touches_) {
      touch.friction.secant = slip == Slip::secant;
      touch.friction.held = slip == Slip::held && touch.at_limit();
      if (slip == Slip::stuck) touch.friction.held = touch.closed && !touch.on_skin() && touch.friction.limit_pa > 0.0;
    }
    for (RigidTouch& touch : rigid_touches_) {
      touch.friction.secant = slip == Slip::secant;
      touch.friction.held = slip == Slip::held && touch.at_limit();
      if (slip == Slip::stuck) touch.friction.held = touch.closed && touch.friction.limit_pa > 0.0;
    }
  }
  if (!add_rest_and_factorise(state, inertia_per_s2, convex)) return false;
  if (!convex && slip == Slip::tangent)
    linearisation_ = factorised_ =
        std::make_shared<Linearisation>(Linearisation{std::make_shared<const NewtonState>(state),
                                                      inertia_per_s2,
                                                      strain_target,
                                                      skin_in_matrix_ ? with_skin_->pattern() : nullptr,
                                                      {}});
  return true;
}

bool NewtonSolver::add_rest_and_factorise(const NewtonState& state, double inertia_per_s2, bool convex) {
  if (inertia_per_s2 > 0.0) {
    for (int node = 0; node < layout_.node_count; ++node)
      matrix_.add_to_diagonal(node, inertia_per_s2 * body_.node_masses_kg()[node]);
  }
  for (int i = 0; i < constraint_count(); ++i) {
    if (state.constraint_multipliers[i] == 0.0) continue;
    CliqueAdder hessian(matrix_, tables_->cliques[static_cast<std::size_t>(i)]);
    constraints_[i].add_hessian(state.positions_m, state.drives, state.constraint_multipliers[i], hessian);
  }
  const double tie = constants::kTieStiffness * body_.material().youngs_modulus_pa * body_.size_m();
  CliqueAdder ties(matrix_, tables_->ties);
  for (int point = 0; point < layout_.point_count; ++point)
    ties.add_outer(point, layout_.tie_coefficients[point], tie * Eigen::Matrix3d::Identity());
  CliqueAdder faces(matrix_, tables_->faces);
  contact_.add_hessian(touches_, convex, soft_contact_, faces);
  if (!factorise(convex)) return false;
  border_ = border(state);
  border_free_obstacles(state, convex);
  border_solved_ = solve(border_);
  delassus_ = border_.transpose() * border_solved_;
  return true;
}

// While descending they stay in place.
void NewtonSolver::border_free_obstacles(const NewtonState& state, bool convex) {
  free_border_ = FreeBorder();
  const FreeObstacles& free = contact_.free();
  if (free.count() == 0 || soft_contact_) return;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(state.positions_m.size(), 6 * free.count());
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(6 * free.count(), 6 * free.count());
  contact_.add_free_hessian(touches_, convex, columns, own);
  contact_.rigid().add_hessian(rigid_touches_, convex, own);
  if (state.free_inertia) add_free_inertia(free, *state.free_inertia, own);
  columns(tables_->held, Eigen::all).setZero();
  Eigen::MatrixXd solved = solve(columns);
  free_border_ =
      FreeBorder(std::move(columns), std::move(solved), std::move(own), free, body_.material().youngs_modulus_pa);
}

// Of skin that is a constraint of the steps only what turns with it is in the matrix, and only where it is pressed
// hard.
bool NewtonSolver::factorise(bool convex) {
  const auto joins_matrix = [&](const ContactTouch& touch) {
    if (!touch.closed || !touch.on_skin()) return false;
    const double hard_pa = kHardPressed * contact_.skin().youngs_modulus_pa(touch);
    return !skin_in_border_ || (!convex && touch.pressure_pa > hard_pa);
  };
  const auto ask = [&] {
    if (interrupt_) interrupt_->check();
  };
  std::vector<FacePair> closed;
  for (const ContactTouch& touch : touches_)
    if (joins_matrix(touch)) closed.push_back(contact_.skin().faces_of(touch));
  skin_in_matrix_ = !closed.empty();
  if (!skin_in_matrix_) {
    matrix_.hold(body_.fixed());
    return factor_.factorise(matrix_, ask);
  }
  include_in_pattern(std::move(closed));
  if (with_skin_)
    with_skin_->follow(contact_pattern_);
  else
    with_skin_ = std::make_unique<ContactMatrix>(contact_pattern_);
  contact_pattern_->copy(matrix_, with_skin_->matrix);
  CliqueAdder pairs(with_skin_->matrix, contact_pattern_->places());
  for (const ContactTouch& touch : touches_) {
    if (!joins_matrix(touch)) continue;
    Eigen::MatrixXd hessian = contact_.skin().hessian(touch, convex, soft_contact_);
    if (skin_in_border_) hessian -= contact_.skin().hessian(touch, true, soft_contact_);
    pairs.add_dense(contact_pattern_->index_of(contact_.skin().faces_of(touch)), hessian);
  }
  with_skin_->matrix.hold(body_.fixed());
  return with_skin_->factor.factorise(with_skin_->matrix, ask);
}

// Each costs a solution with the factor. What slips is no constraint; nor may skin be one that a free obstacle moves.
bool NewtonSolver::may_be_in_border(const std::vector<ContactTouch>& touches, int most) const {
  const SkinContact& skin = contact_.skin();
  return skin.pair_count() > 0 && !skin.rubs() && contact_.free().count() == 0 &&
         std::count_if(touches.begin(), touches.end(), [](const auto& touch) { return touch.on_skin(); }) <= most;
}

// Only what touches: with what soon may, one factorisation took as long as many new patterns.
void NewtonSolver::include_in_pattern(std::vector<FacePair> closed) {
  const auto known = [&](const FacePair& pair) { return contact_pattern_->index_of(pair) >= 0; };
  if (contact_pattern_ && std::all_of(closed.begin(), closed.end(), known)) return;
  std::sort(closed.begin(), closed.end());
  closed.erase(std::unique(closed.begin(), closed.end()), closed.end());
  std::vector<std::vector<int>> cliques;
  for (const FacePair& pair : closed) cliques.push_back(contact_.skin().pairs().nodes(pair));
  contact_pattern_ =
      std::make_shared<const ContactPattern>(matrix_.pattern(), *tables_->factor, std::move(closed), cliques);
}

bool NewtonSolver::linearised_at(const NewtonState& state, double inertia_per_s2,
                                 const std::shared_ptr<const StrainTarget>& strain_target) const {
  return linearisation_ && linearisation_->inertia_per_s2 == inertia_per_s2 &&
         linearisation_->strain_target == strain_target && linearisation_->at->positions_m == state.positions_m &&
         linearisation_->at->element_multipliers_pa == state.element_multipliers_pa &&
         linearisation_->at->constraint_multipliers == state.constraint_multipliers &&
         (term_count() == 0 || *linearisation_->at->drives == *state.drives) &&
         linearisation_->at->contact == state.contact && linearisation_->at->free_inertia == state.free_inertia;
}

void NewtonSolver::restore(const std::shared_ptr<const Linearisation>& linearisation) {
  if (linearisation && !linearisation->at) return restore(nullptr);  // xpbd's
  linearisation_ = linearisation;
  if (linearisation && linearisation->contact_pattern) contact_pattern_ = linearisation->contact_pattern;
}

void NewtonSolver::forget_factor() {
  linearisation_.reset();
  factorised_.reset();
  skin_columns_.clear();
}

void NewtonSolver::exchange(KeptFactor& other) {
  std::swap(matrix_, other.matrix);
  std::swap(factor_, other.factor);
  elements_.exchange_volume_gradients(other.volume_gradients);
  border_.swap(other.border);
  border_solved_.swap(other.border_solved);
  delassus_.swap(other.delassus);
  touches_.swap(other.touches);
  rigid_touches_.swap(other.rigid_touches);
}

// Of a rest state, where it is all in factor_.
bool NewtonSolver::may_be_kept() const {
  return factorised_ && factorised_->inertia_per_s2 == 0.0 && !factorised_->strain_target && !skin_in_matrix_ &&
         free_border_.empty();
}

void NewtonSolver::keep_factor() {
  if (!may_be_kept()) return;
  auto place = std::find_if(kept_.begin(), kept_.end(), [](const KeptFactor& kept) { return kept.of.expired(); });
  if (place == kept_.end()) {
    const double bytes = 8.0 * static_cast<double>(factor_.factor_size());
    if (kept_.size() < kMostKept && bytes * static_cast<double>(kept_.size() + 1) <= kMostKeptBytes)
      kept_.push_back({{}, BlockMatrix(tables_->matrix), BlockCholesky(tables_->factor), {}, {}, {}, {}, {}, {}});
    else if (!kept_.empty())
      std::rotate(kept_.begin(), kept_.begin() + 1, kept_.end());  // the oldest
    else
      return;
    place = kept_.end() - 1;
  }
  exchange(*place);
  place->of = factorised_;
}

// In place of another one, which is kept instead.
bool NewtonSolver::take_up_kept_factor() {
  const auto asked = std::find_if(kept_.begin(), kept_.end(),
                                  [this](const KeptFactor& kept) { return kept.of.lock() == linearisation_; });
  if (asked == kept_.end()) return false;
  exchange(*asked);
  asked->of = may_be_kept() ? factorised_ : nullptr;
  free_border_ = FreeBorder();
  skin_in_matrix_ = skin_in_border_ = false;
  turns_.resize(3, 0);
  factorised_ = linearisation_;
  skin_columns_ = linearisation_->skin_columns;
  return true;
}

bool NewtonSolver::make_factor() {
  if (linearisation_ == factorised_ || take_up_kept_factor()) return true;
  const std::shared_ptr<const Linearisation> asked = linearisation_;
  const bool same = factorised_ && factorised_->at == asked->at;
  if (!same && !linearise(*asked->at, asked->inertia_per_s2, asked->strain_target, false)) return false;
  linearisation_ = factorised_ = asked;
  skin_columns_ = asked->skin_columns;
  return true;
}

bool NewtonSolver::has_factor_at(const NewtonState& state, double inertia_per_s2,
                                 const std::shared_ptr<const StrainTarget>& strain_target) {
  if (!linearised_at(state, inertia_per_s2, strain_target) || !make_factor()) return false;
  turns_.resize(3, 0);
  return true;
}

// Column by column: Eigen copies blocks of many rows three times as slowly.
Eigen::MatrixXd NewtonSolver::solve(const Eigen::MatrixXd& right_hand_sides) const {
  const Eigen::Index rows = right_hand_sides.rows(), columns = right_hand_sides.cols();
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(3 * matrix_.node_count(), columns), solved(rows, columns);
  for (Eigen::Index k = 0; k < columns; ++k) x.col(k).head(rows) = right_hand_sides.col(k);
  factor().solve(x);
  for (Eigen::Index k = 0; k < columns; ++k) solved.col(k) = x.col(k).head(rows);
  free_border_.complete(right_hand_sides, solved);
  return solved;
}

}  // namespace soft_robot_lab
