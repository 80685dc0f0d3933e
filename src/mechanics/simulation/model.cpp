// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/model.h"

#include <iterator>
#include <set>
#include <stdexcept>

#include "workspace.h"

namespace soft_robot_lab {
namespace {

template <class Items, class NameOf>
int index_of(const std::string& kind, const std::string& name, const Items& items, NameOf name_of) {
  std::string known;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (name_of(items[i]) == name) return static_cast<int>(i);
    known += (i == 0 ? "" : ", ") + name_of(items[i]);
  }
  throw std::invalid_argument("unknown " + kind + " '" + name + "'; known: " + (known.empty() ? "none" : known));
}

void refuse_beyond_xpbd(const Body& body) {
  if (!body.fibres().empty())
    throw std::invalid_argument("fibres are not for solver.method xpbd; choose method newton");
  if (body.linear_volume() == LinearVolume::vertex_averaged)
    throw std::invalid_argument(
        "body.linear_volume: vertex_averaged is not for solver.method xpbd, which corrects one element at a "
        "time; "
        "choose element, or method newton");
}

void refuse_equal_names(const std::string& kind, const std::vector<std::string>& all) {
  std::set<std::string> names;
  for (const std::string& name : all)
    if (!names.insert(name).second) throw std::invalid_argument("two " + kind + " are named '" + name + "'");
}

}  // namespace

Model::Model(Body body, std::vector<std::unique_ptr<Actuator>> actuators, std::vector<Marker> markers,
             const SolverOptions& options)
    : body_(std::move(body)),
      actuators_(std::make_move_iterator(actuators.begin()), std::make_move_iterator(actuators.end())),
      markers_(std::move(markers)),
      options_(options) {
  options_.validate();
  if (body_.fixed_node_count() == 0 && body_.obstacles().empty())
    throw std::invalid_argument("body.fixed: no node is held; the robot would fall");
  if (options_.method == SolverOptions::Method::xpbd) refuse_beyond_xpbd(body_);
  std::vector<std::string> names;
  for (const auto& actuator : actuators_) names.push_back(actuator->name());
  refuse_equal_names("actuators", names);
  names.clear();
  for (const Marker& marker : markers_) names.push_back(marker.name());
  refuse_equal_names("markers", names);
  for (const auto& actuator : actuators_)
    if (options_.method == SolverOptions::Method::xpbd && !actuator->energy_terms().empty())
      throw std::invalid_argument(
          "actuator '" + actuator->name() +
          "' has an energy of its own, which is not for solver.method xpbd; choose method newton");
  tables_ = std::make_unique<const SolverTables>(body_, actuators_, options_.method);
}

Model::~Model() = default;

int Model::actuator_index(const std::string& name) const {
  return index_of("actuator", name, actuators_, [](const auto& actuator) { return actuator->name(); });
}

int Model::marker_index(const std::string& name) const {
  return index_of("marker", name, markers_, [](const Marker& marker) { return marker.name(); });
}

}  // namespace soft_robot_lab
