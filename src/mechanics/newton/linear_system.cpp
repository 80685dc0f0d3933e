// SPDX-License-Identifier: BSD-3-Clause
// How the matrix is put together, factorised, and made again for a saved state.
#include "linear_system.h"

#include <algorithm>
#include <utility>

#include "mechanics/contact/contact_step.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kMostKept = 10;  // as many states as a search starts from
constexpr double kMostKeptBytes = 1.28e8;

}  // namespace

LinearSystem::LinearSystem(const NewtonTables& tables, NewtonEnergies& energies)
    : tables_(tables), energies_(energies), matrix_(tables.matrix), factor_(tables.factor) {}

bool LinearSystem::linearise(const NewtonState& state, double inertia_per_s2,
                             const std::shared_ptr<const StrainTarget>& strain_target, bool convex, Slip slip) {
  keep_factor();
  forget_factor();
  turns_.resize(3, 0);
  matrix_.set_zero();
  energies_.elements.add_hessian(state.positions_m, state.element_multipliers_pa, convex, matrix_);
  if (strain_target) energies_.springs.add_hessian(state.positions_m, *strain_target, convex, matrix_);
  energies_.terms.add_hessian(state.positions_m, state.drives, convex, matrix_);
  if (!energies_.soft_contact) {
    ContactSums sums = energies_.contact.sums(state.positions_m, state.contact);
    touching_.points = std::move(sums.touches);
    skin_in_border_ = inertia_per_s2 > 0.0 && may_be_in_border(touching_.points, kMostInBorder);
    touching_.rigid = std::move(sums.rigid);
    for (ContactTouch& touch : touching_.points) {
      touch.friction.secant = slip == Slip::secant;
      touch.friction.held = slip == Slip::held && touch.at_limit();
      if (slides_where_met(touch)) touch.friction.limit_pa = -1.0;
      if (slip == Slip::stuck) touch.friction.held = touch.closed && !touch.on_skin() && touch.friction.limit_pa > 0.0;
    }
    for (RigidTouch& touch : touching_.rigid) {
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
                                                      skin_matrix_.used ? skin_matrix_.whole->pattern() : nullptr,
                                                      {}});
  return true;
}

// A point that comes to touch skin after it has slid along has no pressure yet that would tie it. By the pressure that
// its gap stands for it goes on sliding.
bool LinearSystem::slides_where_met(const ContactTouch& touch) const {
  if (!touch.on_skin() || !touch.closed || touch.friction.limit_pa != 0.0) return false;
  const double next_pa = energies_.contact.law(touch).pressure_pa(touch.gap_m);
  FrictionLaw next = touch.friction;
  next.limit_pa = energies_.contact.friction_of(touch) * next_pa;
  return next.slips(touch.away_m);
}

bool LinearSystem::add_rest_and_factorise(const NewtonState& state, double inertia_per_s2, bool convex) {
  if (inertia_per_s2 > 0.0) {
    for (int node = 0; node < tables_.layout.node_count; ++node)
      matrix_.add_to_diagonal(node, inertia_per_s2 * tables_.body.node_masses_kg()[node]);
  }
  for (int i = 0; i < tables_.constraint_count(); ++i) {
    if (state.constraint_multipliers[i] == 0.0) continue;
    CliqueAdder hessian(matrix_, tables_.cliques[static_cast<std::size_t>(i)]);
    tables_.constraints[i].add_hessian(state.positions_m, state.drives, state.constraint_multipliers[i], hessian);
  }
  const double tie = constants::kTieStiffness * tables_.body.material().youngs_modulus_pa * tables_.body.size_m();
  CliqueAdder ties(matrix_, tables_.ties);
  for (int point = 0; point < tables_.layout.point_count; ++point)
    ties.add_outer(point, tables_.layout.tie_coefficients[point], tie * Eigen::Matrix3d::Identity());
  CliqueAdder faces(matrix_, tables_.faces);
  energies_.contact.add_hessian(touching_.points, convex, energies_.soft_contact, faces);
  if (!factorise(convex)) return false;
  border_.columns = constraint_gradients(tables_, state);
  border_free_obstacles(state, convex);
  border_.solved = solve(border_.columns);
  border_.delassus = border_.columns.transpose() * border_.solved;
  return true;
}

// While descending they stay in place.
void LinearSystem::border_free_obstacles(const NewtonState& state, bool convex) {
  free_border_ = FreeBorder();
  const FreeObstacles& free = energies_.contact.free();
  if (free.count() == 0 || energies_.soft_contact) return;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(state.positions_m.size(), 6 * free.count());
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(6 * free.count(), 6 * free.count());
  energies_.contact.add_free_hessian(touching_.points, convex, columns, own);
  energies_.contact.rigid().add_hessian(touching_.rigid, convex, own);
  if (state.free_inertia) add_free_inertia(free, *state.free_inertia, own);
  columns(tables_.held, Eigen::all).setZero();
  Eigen::MatrixXd solved = solve(columns);
  free_border_ = FreeBorder(std::move(columns), std::move(solved), std::move(own), free,
                            tables_.body.material().youngs_modulus_pa, state.free_inertia.get());
}

// Of skin that is a constraint of the steps only what turns with it is in the matrix, and only where it is pressed
// hard.
bool LinearSystem::factorise(bool convex) {
  const auto joins_matrix = [&](const ContactTouch& touch) {
    if (!touch.closed || !touch.on_skin()) return false;
    const double hard_pa = kHardPressed * energies_.contact.skin().youngs_modulus_pa(touch);
    return !skin_in_border_ || (!convex && touch.pressure_pa > hard_pa);
  };
  const auto ask = [&] {
    if (interrupt_) interrupt_->check();
  };
  std::vector<FacePair> closed;
  for (const ContactTouch& touch : touching_.points)
    if (joins_matrix(touch)) closed.push_back(energies_.contact.skin().faces_of(touch));
  skin_matrix_.used = !closed.empty();
  if (!skin_matrix_.used) {
    matrix_.hold(tables_.body.fixed());
    return factor_.factorise(matrix_, ask);
  }
  include_in_pattern(std::move(closed));
  if (skin_matrix_.whole)
    skin_matrix_.whole->follow(skin_matrix_.pattern);
  else
    skin_matrix_.whole = std::make_unique<ContactMatrix>(skin_matrix_.pattern);
  skin_matrix_.pattern->copy(matrix_, skin_matrix_.whole->matrix);
  CliqueAdder pairs(skin_matrix_.whole->matrix, skin_matrix_.pattern->places());
  for (const ContactTouch& touch : touching_.points) {
    if (!joins_matrix(touch)) continue;
    Eigen::MatrixXd hessian = energies_.contact.skin().hessian(touch, convex, energies_.soft_contact);
    if (skin_in_border_) hessian -= energies_.contact.skin().hessian(touch, true, energies_.soft_contact);
    pairs.add_dense(skin_matrix_.pattern->index_of(energies_.contact.skin().faces_of(touch)), hessian);
  }
  skin_matrix_.whole->matrix.hold(tables_.body.fixed());
  return skin_matrix_.whole->factor.factorise(skin_matrix_.whole->matrix, ask);
}

// Each costs a solution with the factor. What slips is no constraint; nor may skin be one that a free obstacle moves.
bool LinearSystem::may_be_in_border(const std::vector<ContactTouch>& touches, int most) const {
  const SkinContact& skin = energies_.contact.skin();
  return skin.pair_count() > 0 && !skin.rubs() && energies_.contact.free().count() == 0 &&
         std::count_if(touches.begin(), touches.end(), [](const auto& touch) { return touch.on_skin(); }) <= most;
}

// Only what touches: with what soon may, one factorisation took as long as many new patterns.
void LinearSystem::include_in_pattern(std::vector<FacePair> closed) {
  const auto known = [&](const FacePair& pair) { return skin_matrix_.pattern->index_of(pair) >= 0; };
  if (skin_matrix_.pattern && std::all_of(closed.begin(), closed.end(), known)) return;
  std::sort(closed.begin(), closed.end());
  closed.erase(std::unique(closed.begin(), closed.end()), closed.end());
  std::vector<std::vector<int>> cliques;
  for (const FacePair& pair : closed) cliques.push_back(energies_.contact.skin().pairs().nodes(pair));
  skin_matrix_.pattern =
      std::make_shared<const ContactPattern>(matrix_.pattern(), *tables_.factor, std::move(closed), cliques);
}

bool LinearSystem::linearise_held(const NewtonState& state) {
  const ContactSums sums = energies_.contact.sums(state.positions_m, state.contact);
  const auto at_limit = [](const auto& touch) { return touch.at_limit(); };
  if (std::none_of(sums.touches.begin(), sums.touches.end(), at_limit) &&
      std::none_of(sums.rigid.begin(), sums.rigid.end(), at_limit))
    return has_factor_at(state, 0.0, nullptr) || linearise(state, 0.0, nullptr, false);
  return linearise(state, 0.0, nullptr, false, Slip::held);
}

bool LinearSystem::linearise_blend(const NewtonState& state, double inertia_per_s2,
                                   const std::shared_ptr<const StrainTarget>& strain_target,
                                   const Eigen::VectorXd& volumetric_strain, double convexity) {
  if (convexity > 1.0) return linearise(state, inertia_per_s2, strain_target, true);
  forget_factor();
  const auto size = static_cast<Eigen::Index>(9 * matrix_.rows().size());
  Eigen::Map<Eigen::VectorXd> values(matrix_.block(0), size);
  matrix_.set_zero();
  if (convexity > 0.0) {
    const Elements& elements = energies_.elements;
    Eigen::VectorXd cancelling = (elements.mu_pa().array() * (1.0 - volumetric_strain.array())).matrix();
    cancelling.tail(elements.fibre_count()) = state.element_multipliers_pa.tail(elements.fibre_count());
    energies_.elements.add_hessian(state.positions_m, cancelling, true, matrix_);
    if (strain_target) energies_.springs.add_hessian(state.positions_m, *strain_target, true, matrix_);
    energies_.terms.add_hessian(state.positions_m, state.drives, true, matrix_);
  }
  if (convexity < 1.0) {
    const Eigen::VectorXd safe = values;
    matrix_.set_zero();
    energies_.elements.add_hessian(state.positions_m, state.element_multipliers_pa, false, matrix_);
    if (strain_target) energies_.springs.add_hessian(state.positions_m, *strain_target, false, matrix_);
    energies_.terms.add_hessian(state.positions_m, state.drives, false, matrix_);
    values = (1.0 - convexity) * values + convexity * safe;
  }
  return add_rest_and_factorise(state, inertia_per_s2, convexity > 0.0);
}

void LinearSystem::find_edges(const Eigen::Matrix3Xd& positions_m) {
  energies_.contact.skin().find_edges(positions_m, touching_.points);
}

void LinearSystem::take_touches(std::vector<ContactTouch> touches) {
  touching_.points = std::move(touches);
  skin_in_border_ = false;
}

bool LinearSystem::linearised_at(const NewtonState& state, double inertia_per_s2,
                                 const std::shared_ptr<const StrainTarget>& strain_target) const {
  return linearisation_ && linearisation_->inertia_per_s2 == inertia_per_s2 &&
         linearisation_->strain_target == strain_target && linearisation_->at->positions_m == state.positions_m &&
         linearisation_->at->element_multipliers_pa == state.element_multipliers_pa &&
         linearisation_->at->constraint_multipliers == state.constraint_multipliers &&
         (tables_.term_count() == 0 || *linearisation_->at->drives == *state.drives) &&
         linearisation_->at->contact == state.contact && linearisation_->at->free_inertia == state.free_inertia;
}

void LinearSystem::restore(const std::shared_ptr<const Linearisation>& linearisation) {
  if (linearisation && !linearisation->at) return restore(nullptr);  // xpbd's
  linearisation_ = linearisation;
  if (linearisation && linearisation->contact_pattern) skin_matrix_.pattern = linearisation->contact_pattern;
}

void LinearSystem::forget_factor() {
  linearisation_.reset();
  factorised_.reset();
  skin_columns_.clear();
}

void LinearSystem::exchange(KeptFactor& other) {
  std::swap(matrix_, other.matrix);
  std::swap(factor_, other.factor);
  energies_.elements.exchange_volume_gradients(other.volume_gradients);
  border_.columns.swap(other.border);
  border_.solved.swap(other.border_solved);
  border_.delassus.swap(other.delassus);
  touching_.points.swap(other.touches);
  touching_.rigid.swap(other.rigid_touches);
}

// Of a rest state, where it is all in factor_.
bool LinearSystem::may_be_kept() const {
  return factorised_ && factorised_->inertia_per_s2 == 0.0 && !factorised_->strain_target && !skin_matrix_.used &&
         free_border_.empty();
}

void LinearSystem::keep_factor() {
  if (!may_be_kept()) return;
  auto place = std::find_if(kept_.begin(), kept_.end(), [](const KeptFactor& kept) { return kept.of.expired(); });
  if (place == kept_.end()) {
    const double bytes = 8.0 * static_cast<double>(factor_.factor_size());
    if (kept_.size() < kMostKept && bytes * static_cast<double>(kept_.size() + 1) <= kMostKeptBytes)
      kept_.push_back({{}, BlockMatrix(tables_.matrix), BlockCholesky(tables_.factor), {}, {}, {}, {}, {}, {}});
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
bool LinearSystem::take_up_kept_factor() {
  const auto asked = std::find_if(kept_.begin(), kept_.end(),
                                  [this](const KeptFactor& kept) { return kept.of.lock() == linearisation_; });
  if (asked == kept_.end()) return false;
  exchange(*asked);
  asked->of = may_be_kept() ? factorised_ : nullptr;
  free_border_ = FreeBorder();
  skin_matrix_.used = skin_in_border_ = false;
  turns_.resize(3, 0);
  factorised_ = linearisation_;
  skin_columns_ = linearisation_->skin_columns;
  return true;
}

bool LinearSystem::make_factor() {
  if (linearisation_ == factorised_ || take_up_kept_factor()) return true;
  const std::shared_ptr<const Linearisation> asked = linearisation_;
  const bool same = factorised_ && factorised_->at == asked->at;
  if (!same && !linearise(*asked->at, asked->inertia_per_s2, asked->strain_target, false)) return false;
  linearisation_ = factorised_ = asked;
  skin_columns_ = asked->skin_columns;
  return true;
}

bool LinearSystem::has_factor_at(const NewtonState& state, double inertia_per_s2,
                                 const std::shared_ptr<const StrainTarget>& strain_target) {
  if (!linearised_at(state, inertia_per_s2, strain_target) || !make_factor()) return false;
  turns_.resize(3, 0);
  return true;
}

// Column by column: Eigen copies blocks of many rows three times as slowly.
Eigen::MatrixXd LinearSystem::solve(const Eigen::MatrixXd& right_hand_sides) const {
  const Eigen::Index rows = right_hand_sides.rows(), columns = right_hand_sides.cols();
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(3 * matrix_.node_count(), columns), solved(rows, columns);
  for (Eigen::Index k = 0; k < columns; ++k) x.col(k).head(rows) = right_hand_sides.col(k);
  factor().solve(x);
  for (Eigen::Index k = 0; k < columns; ++k) solved.col(k) = x.col(k).head(rows);
  free_border_.complete(right_hand_sides, solved);
  return solved;
}

bool LinearSystem::may_serve(double inertia_per_s2, bool viscous, const ContactSums& contact) {
  return linearisation_ && linearisation_->inertia_per_s2 == inertia_per_s2 &&
         (linearisation_->strain_target == nullptr) == !viscous && make_factor() &&
         same_set(touching_.points, contact.touches, !skin_in_border_) &&
         RigidContact::same_set(touching_.rigid, contact.rigid);
}

bool LinearSystem::any_in_matrix(const std::vector<ContactTouch>& touches) const {
  if (!skin_in_border_) return !touches.empty();
  return std::any_of(touches.begin(), touches.end(),
                     [](const ContactTouch& touch) { return touch.closed && !touch.on_skin(); });
}

// Obstacles that touched did not turn with the body.
void LinearSystem::turn_to(const Eigen::Matrix3Xd& positions_m, const std::vector<ContactTouch>& touches) {
  const bool touch = any_in_matrix(touches) || any_in_matrix(touching_.points) || !free_border_.empty();
  if (touch || positions_m == linearisation_->at->positions_m)
    turns_.resize(3, 0);
  else
    turns_ = tables_.turns.between(linearisation_->at->positions_m, positions_m);
}

}  // namespace soft_robot_lab
