// SPDX-License-Identifier: BSD-3-Clause
#include "element_colours.h"

namespace soft_robot_lab {

std::vector<std::vector<int>> colour_elements(const TetMesh& mesh) {
  std::vector<std::vector<int>> colours;
  std::vector<std::vector<int>> colours_at_node(mesh.node_count());
  for (int element = 0; element < mesh.tet_count(); ++element) {
    std::vector<char> taken(colours.size(), 0);
    for (int corner = 0; corner < 4; ++corner)  // elements that share a mid-edge node share corners too
      for (const int colour : colours_at_node[mesh.tets(corner, element)]) taken[colour] = 1;
    std::size_t chosen = colours.size();
    for (std::size_t colour = 0; colour < colours.size(); ++colour)
      if (!taken[colour] && (chosen == colours.size() || colours[colour].size() < colours[chosen].size()))
        chosen = colour;
    if (chosen == colours.size()) colours.emplace_back();
    colours[chosen].push_back(element);
    for (int corner = 0; corner < 4; ++corner)
      colours_at_node[mesh.tets(corner, element)].push_back(static_cast<int>(chosen));
  }
  return colours;
}

}  // namespace soft_robot_lab
