// SPDX-License-Identifier: BSD-3-Clause
#include "workspace.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

using Actuators = std::vector<std::unique_ptr<const Actuator>>;

std::vector<DrivenConstraint> constraints_of(const Actuators& actuators) {
  std::vector<DrivenConstraint> all;
  for (std::size_t i = 0; i < actuators.size(); ++i)
    for (const Constraint* constraint : actuators[i]->constraints()) all.push_back({constraint, static_cast<int>(i)});
  return all;
}

std::vector<SharedLength> shared_lengths_of(const Actuators& actuators) {
  std::vector<SharedLength> all;
  int offset = 0;
  for (const auto& actuator : actuators) {
    for (const FrictionContact* contact : actuator->friction_contacts())
      all.push_back({contact, offset + contact->first, offset + contact->second});
    offset += static_cast<int>(actuator->constraints().size());
  }
  return all;
}

std::vector<DrivenTerm> terms_of(const Actuators& actuators) {
  std::vector<DrivenTerm> all;
  for (std::size_t i = 0; i < actuators.size(); ++i)
    for (const EnergyTerm* term : actuators[i]->energy_terms()) all.push_back({term, static_cast<int>(i)});
  return all;
}

}  // namespace

SolverTables::SolverTables(const Body& body, const Actuators& actuators, SolverOptions::Method method)
    : newton(std::make_shared<const NewtonTables>(body, constraints_of(actuators), shared_lengths_of(actuators),
                                                  terms_of(actuators))),
      air_spans(body, actuators),
      skin_overlap(body) {
  if (method == SolverOptions::Method::xpbd)
    xpbd = std::make_shared<const XpbdTables>(body, constraints_of(actuators), shared_lengths_of(actuators));
}

Workspace::Workspace(const SolverTables& tables)
    : newton(tables.newton),
      xpbd(tables.xpbd ? std::make_unique<XpbdSolver>(tables.xpbd, constants::kXpbdThreads) : nullptr) {
  newton.heed(&interrupt);
  if (xpbd) xpbd->heed(&interrupt);
}

}  // namespace soft_robot_lab
