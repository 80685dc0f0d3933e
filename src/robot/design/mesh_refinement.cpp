// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/design/mesher.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

MeshRefinement read_mesh_refinement(const YamlNode& node) {
  MeshRefinement refinement;
  refinement.size_m = node.number("size_m", AllowedRange::positive());
  refinement.edges_only = node.has("edges_of");
  const std::string key = refinement.edges_only ? "edges_of" : "surface";
  if (node.has(key)) {
    refinement.surface = node.text(key);
    if (refinement.surface.empty()) node.child(key).fail("is empty; must be the name of a surface");
    return refinement;
  }
  refinement.center_m = node.vector3("center_m");
  refinement.radius_m = node.number("radius_m", AllowedRange::positive());
  return refinement;
}

}  // namespace soft_robot_lab
