// SPDX-License-Identifier: BSD-3-Clause
#include "still_parts.h"

#include <algorithm>

#include "mechanics/body/held.h"
#include "scene_warning.h"

namespace soft_robot_lab {
namespace {

bool is_held(const Body& body, int fibre) {
  return std::all_of(body.fibre_groups().begin(), body.fibre_groups().end(), [&](const FibreGroup& group) {
    return group.fibre != fibre || body.fixed()(Eigen::all, body.mesh().tets.col(group.tet)).all();
  });
}

}  // namespace

std::vector<SolveWarning> still_parts(const Body& body, const MeshLocator& locator,
                                      const std::vector<Marker>& markers) {
  if (body.holds_move()) return {};
  const bool all_held = body.fixed().all();
  if (all_held && body.obstacles().empty())  // on which free ones may lie
    return {scene_warning(
        "nothing_moves",
        "all nodes are held, so nothing can move: the boxes in `fixed` are too large, where a clamp holds one "
        "end")};
  if (all_held) return {};
  std::vector<SolveWarning> warnings;
  for (const Marker& marker : markers)
    if (held(locator.embed(marker.rest_position_m()), body.fixed()))
      warnings.push_back(
          scene_warning("held_marker", "marker " + marker.name() +
                                           " lies where the body is held, and cannot move: move it, or the box "
                                           "in `fixed`"));
  for (std::size_t i = 0; i < body.fibres().size(); ++i)
    if (is_held(body, static_cast<int>(i)))
      warnings.push_back(scene_warning(
          "held_fibre", "fibre " + body.fibres()[i].name + " lies where the body is held, and does nothing there"));
  return warnings;
}

}  // namespace soft_robot_lab
