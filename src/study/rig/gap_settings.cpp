// SPDX-License-Identifier: BSD-3-Clause
#include "gap_settings.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

int read_axis(const std::string& axis) { return axis.front() - 'x'; }

std::vector<std::string> read_texts(const std::vector<YamlNode>& nodes) {
  std::vector<std::string> texts;
  for (const YamlNode& node : nodes) texts.push_back(node.as_text());
  return texts;
}

// Names of configurations.
std::vector<std::string> read_names(const std::vector<YamlNode>& nodes, const std::vector<Configuration>& known) {
  for (const YamlNode& node : nodes) {
    const std::string name = node.as_text();
    if (std::none_of(known.begin(), known.end(), [&](const Configuration& one) { return one.name == name; }))
      node.fail("there is no configuration '" + name + "'");
  }
  return read_texts(nodes);
}

}  // namespace

GapSettings read_gap_settings(const ExperimentContext& context, const std::string& name) {
  const YamlNode node = YamlNode::load_file(context.settings_file(name));
  GapSettings settings{read_lab_files(node, context), commands_syringes(node), {}, {}, {}, {}, {}, 1};
  settings.configurations = read_configurations(node);
  settings.come_back = read_names(node.sequence("come_back"), settings.configurations);
  if (settings.come_back.empty()) node.fail("come_back is empty");
  settings.drawn = read_names(node.optional_sequence("drawn"), settings.configurations);
  settings.shape = read_texts(node.sequence("shape"));
  if (settings.shape.empty()) node.fail("shape is empty");
  const std::vector<std::string> axes = {"x", "y", "z"};
  if (node.has("mirror_axis")) settings.mirror_axis = read_axis(node.choice("mirror_axis", axes));
  settings.seen_along = read_axis(node.choice_or("seen_along", "y", {"x", "y"}));
  node.require_all_read();
  return settings;
}

}  // namespace soft_robot_lab
