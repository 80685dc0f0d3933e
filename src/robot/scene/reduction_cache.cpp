// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <set>

#include "fidelity.h"
#include "reduction.h"
#include "robot/design/content_hash.h"
#include "settings/read_file.h"

namespace soft_robot_lab {
namespace {

using Kept = nlohmann::json;

// Part of every key: raise it when another model would be trained for the same scene.
constexpr const char* kReductionVersion = "soft_robot_lab reduced 4";
constexpr const char* kReductionEnding = ".reduced.cbor";

template <class Numbers>
std::string bytes(const Numbers& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()),
          static_cast<std::size_t>(numbers.size()) * sizeof *numbers.data()};
}

Kept matrix_json(const Eigen::MatrixXd& m) {
  return {{"rows", m.rows()}, {"numbers", std::vector<double>(m.data(), m.data() + m.size())}};
}

// Throws Kept::exception, or std::invalid_argument where the size is not that of the scene.
Eigen::MatrixXd matrix_from(const Kept& json, Eigen::Index rows) {
  const auto numbers = json.at("numbers").get<std::vector<double>>();
  const auto size = static_cast<Eigen::Index>(numbers.size());
  if (json.at("rows").get<Eigen::Index>() != rows || size % rows != 0)
    throw std::invalid_argument("a kept reduced model is of another size");
  return Eigen::Map<const Eigen::MatrixXd>(numbers.data(), rows, size / rows);
}

Kept kept_rests(const KnownRests& rests) {
  return {matrix_json(rests.commands), matrix_json(rests.q), matrix_json(rests.pressures),
          matrix_json(rests.multipliers)};
}

KnownRests rests_from(const Kept& json, const ReducedModel& model) {
  return {matrix_from(json.at(0), static_cast<Eigen::Index>(model.box.min.size())),
          matrix_from(json.at(1), model.energy.modes()), matrix_from(json.at(2), model.energy.pressures()),
          matrix_from(json.at(3), static_cast<Eigen::Index>(model.constraints.count()))};
}

Kept kept_error(const ReducedError& e) { return {e.states, e.unsolved, e.rms_m, e.max_m}; }

ReducedError error_from(const Kept& json) {
  return {json.at(0).get<int>(), json.at(1).get<int>(), json.at(2).get<double>(), json.at(3).get<double>()};
}

ReducedChoice choice_from(const Kept& json, const std::shared_ptr<const Model>& model) {
  const TetMesh& mesh = model->body().mesh();
  const ReducedBasis basis{matrix_from(json.at("modes"), 3 * mesh.node_count()),
                           matrix_from(json.at("pressures"), mesh.tet_count())};
  const CommandBox box{json.at("box").at(0).get<std::vector<double>>(),
                       json.at("box").at(1).get<std::vector<double>>()};
  if (box.min.size() != model->actuators().size() || box.max.size() != box.min.size())
    throw std::invalid_argument("a kept reduced model is of other actuators");
  auto reduced = std::make_shared<ReducedModel>(model, box, basis);
  reduced->hyper_reduce(
      matrix_from(json.at("point_factors"), static_cast<Eigen::Index>(reduced->energy.points().size())));
  reduced->rests = rests_from(json.at("rests"), *reduced);
  reduced->let_touch(json.at("skin").get<std::vector<FacePair>>());
  reduced->snapshots = json.at("snapshots").get<int>();
  reduced->failed_solves = json.at("failed_solves").get<int>();
  return {reduced, error_from(json.at("equilibria")), error_from(json.at("transient")), json.at("cpu_s").get<double>()};
}

}  // namespace

// All settings but those that a model does not hang on; of what stands in other files, such as meshes and materials,
// the content.
std::string reduction_key(const YamlNode& settings, const Body& body) {
  ContentHash hash;
  hash.add(kReductionVersion);
  const YamlNode copy = Overrides().set({"solver", "audit_every_s"}, 1).over(settings);  // dumping counts as reading
  const std::set<std::string> others{"run", "markers", "parameters", "casting"};
  for (const std::string& section : copy.keys()) {
    if (others.count(section) > 0) continue;
    hash.add(section);
    hash.add(copy.child(section).dump());
  }
  hash.add(bytes(body.mesh().nodes_m));
  hash.add(bytes(body.mesh().tets));
  hash.add(bytes(body.node_masses_kg()));
  hash.add(bytes(body.external_forces_n()));
  hash.add(bytes(Eigen::Vector2d(body.material().lame_mu_pa(), body.material().poissons_ratio)));
  return hash.hex();
}

std::optional<ReducedChoice> find_reduction(const std::string& key, const std::shared_ptr<const Model>& model,
                                            const SceneOptions& options) {
  const std::string path = cache_of(options).find(key, kReductionEnding);
  if (path.empty()) return std::nullopt;
  try {
    return choice_from(Kept::from_cbor(read_regular_file(path, kLargestMesh_bytes)), model);
  } catch (const Kept::exception&) {
    return std::nullopt;  // of another version
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

void keep_reduction(const std::string& key, const ReducedChoice& choice, const SceneOptions& options) {
  const ReducedModel& model = *choice.model;
  const Kept json = {{"box", {model.box.min, model.box.max}},
                     {"modes", matrix_json(model.basis.modes)},
                     {"pressures", matrix_json(model.basis.pressures)},
                     {"point_factors", matrix_json(model.point_factors)},
                     {"rests", kept_rests(model.rests)},
                     {"skin", model.skin.pairs()},
                     {"snapshots", model.snapshots},
                     {"failed_solves", model.failed_solves},
                     {"equilibria", kept_error(choice.equilibria)},
                     {"transient", kept_error(choice.transient)},
                     {"cpu_s", choice.cpu_s}};
  const std::vector<std::uint8_t> cbor = Kept::to_cbor(json);
  cache_of(options).keep_text(std::string(cbor.begin(), cbor.end()), key, kReductionEnding);
}

}  // namespace soft_robot_lab
