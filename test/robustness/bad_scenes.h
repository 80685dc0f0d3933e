// SPDX-License-Identifier: BSD-3-Clause
// Scenes that are bad or extreme, each in one way, made from good ones. The same seed makes the same scenes.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace soft_robot_lab {

struct BadScene {
  std::string name;                                             // what was done, and to which key
  std::string text;                                             // of the scene's file
  std::vector<std::pair<std::string, std::string>> files = {};  // beside it: names and contents
  std::string commands = "";  // of them, what `rollouts` takes with the scene; empty: `simulate` runs it
  bool sound = false;         // nothing is wrong with it: others are made of it
  bool request = false;       // to `mesh_robot`, as launch/import_mesh.py makes it, and no scene
};

// Every scalar of each good scene replaced by each of a list of bad values, every key misspelt, repeated and left out,
// lists emptied and doubled; then the text cut off, and bytes of it replaced, at random places.
std::vector<BadScene> bad_scenes(unsigned int seed);

}  // namespace soft_robot_lab
