// SPDX-License-Identifier: BSD-3-Clause
// solver.method reduced: a scene's reduced model, trained where none is kept.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "mechanics/reduced/choose_modes.h"
#include "sections.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {

struct SceneReduction {
  ReducedChoice choice;
  ReducedRequest request;
  bool from_cache = false;
};

// Where the scene asks for a reduced model that this program does not know, or together with `fidelity`.
void refuse_unknown_reduced(const YamlNode& scene, const SceneOptions& options);

// None with another method, or where newton takes its place.
std::optional<ReducedRequest> read_reduced(const YamlNode& settings, const Scene& scene, ReducedUse use);

// Null where none is kept and none is to be trained.
std::shared_ptr<const SceneReduction> reduce(const YamlNode& settings, const Scene& scene,
                                             const ReducedRequest& request, const SceneOptions& options);

// Kept by content beside the meshes: modes, weights and errors. The polynomials are worked out anew.
std::string reduction_key(const YamlNode& settings, const Body& body);
std::optional<ReducedChoice> find_reduction(const std::string& key, const std::shared_ptr<const Model>& model,
                                            const SceneOptions& options);
void keep_reduction(const std::string& key, const ReducedChoice& choice, const SceneOptions& options);

// `reduced` of result.json.
nlohmann::ordered_json reduction_json(const SceneReduction& reduction, const RunReport& report);

// The same for a reader, in a line.
std::string summary(const SceneReduction& reduction, const RunReport& report);

}  // namespace soft_robot_lab
