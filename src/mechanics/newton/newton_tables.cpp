// SPDX-License-Identifier: BSD-3-Clause
#include "newton_tables.h"

namespace soft_robot_lab {
namespace {

std::vector<Eigen::Index> held_by(const Body& body) {
  std::vector<Eigen::Index> held;
  for (Eigen::Index i = 0; i < body.fixed().size(); ++i)
    if (body.fixed().data()[i]) held.push_back(i);
  return held;
}

}  // namespace

NewtonTables::NewtonTables(const Body& body_in, std::vector<DrivenConstraint> constraints_in,
                           std::vector<SharedLength> shared_in, std::vector<DrivenTerm> terms_in)
    : body(body_in),
      constraints(std::move(constraints_in)),
      shared(std::move(shared_in)),
      terms(std::move(terms_in)),
      layout(body, constraints),
      loads_n(body.external_forces_n()),
      force_floor_n(1e-9 * body.material().youngs_modulus_pa * body.size_m() * body.size_m()),
      held(held_by(body)),
      matrix(std::make_shared<const BlockPattern>(layout.node_count + layout.point_count,
                                                  layout.all_cliques(body, terms.cliques()))),
      factor(std::make_shared<const FactorPattern>(*matrix)),
      elements(std::make_shared<const ElementTables>(body, *matrix)),
      turns(body, elements->batches),
      ties(*matrix, layout.ties),
      contact(body),
      faces(*matrix, contact.cliques()) {
  for (const auto& of_constraint : layout.cliques) cliques.emplace_back(*matrix, of_constraint);
  terms.place_in(*matrix);
}

void NewtonTables::release(Eigen::Matrix3Xd& forces) const { forces.reshaped()(held).setZero(); }

const CoRotatedStep& NewtonTables::co_rotation() const {
  std::call_once(co_rotation_made_,
                 [this] { co_rotation_ = std::make_unique<CoRotatedStep>(body, elements->batches, *matrix); });
  return *co_rotation_;
}

Eigen::MatrixXd constraint_gradients(const NewtonTables& tables, const NewtonState& state) {
  Eigen::MatrixXd columns(state.positions_m.size(), tables.constraint_count());
  Eigen::Matrix3Xd gradient(3, state.positions_m.cols());
  for (int i = 0; i < tables.constraint_count(); ++i) {
    gradient.setZero();
    tables.constraints[static_cast<std::size_t>(i)].add_gradient(state.positions_m, state.drives, 1.0, gradient);
    tables.release(gradient);
    columns.col(i) = as_vector(gradient);
  }
  return columns;
}

}  // namespace soft_robot_lab
