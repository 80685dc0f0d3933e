// From the text of a settings file to its tree.
#include <fstream>
#include <sstream>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "settings/settings_data.h"

namespace soft_robot_lab {
namespace {

// Aliases may repeat a part of a document without end; no settings file comes near these.
constexpr int kMaxDepth = 100;
constexpr int kMaxNodes = 1000000;

}  // namespace

// `place` carries source, line and path of the node.
SettingsNode SettingsNode::Data::build(const YAML::Node& yaml, Data place, int depth, int& budget) {
  auto data = std::make_shared<Data>(std::move(place));
  if (depth > kMaxDepth || --budget < 0) fail_at(data->source, data->line, data->path, "nested too deep, or too large");
  const auto place_below = [&](const YAML::Mark& mark, const std::string& path) {
    Data below;
    below.source = data->source;
    below.line = mark.is_null() ? data->line : mark.line + 1;
    below.path = path;
    return below;
  };
  if (yaml.IsScalar()) {
    data->kind = Kind::scalar;
    data->scalar = yaml.Scalar();
    data->quoted = yaml.Tag() == "!" || yaml.Tag() == "tag:yaml.org,2002:str";
  } else if (yaml.IsSequence()) {
    data->kind = Kind::sequence;
    for (const YAML::Node& item : yaml) {
      const std::string path = data->path + "[" + std::to_string(data->items.size()) + "]";
      data->items.push_back(build(item, place_below(item.Mark(), path), depth + 1, budget));
    }
  } else if (yaml.IsMap()) {
    data->kind = Kind::map;
    for (const auto& pair : yaml) {
      Data below = place_below(pair.first.Mark(), data->path);
      if (!pair.first.IsScalar()) fail_at(below.source, below.line, below.path, "a key must be a word");
      const std::string& key = pair.first.Scalar();
      for (const Member& member : data->members) {
        if (member.key != key) continue;
        fail_at(below.source, below.line, below.path,
                "key '" + key + "' stands twice, first in line " + std::to_string(member.line));
      }
      below.path += (below.path.empty() ? "" : ".") + key;
      const int line = below.line;
      data->members.push_back(
          {key, data->source, line, build(pair.second, std::move(below), depth + 1, budget), false});
    }
  }
  return SettingsNode(std::move(data));
}

SettingsNode SettingsNode::load_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || file.bad() || text.fail()) throw SettingsError(path + ": cannot be read, or is empty");
  return parse(text.str(), path);
}

SettingsNode SettingsNode::parse(const std::string& text, const std::string& source_name) {
  Data root;
  root.source = source_name;
  int budget = kMaxNodes;
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.empty()) throw SettingsError(source_name + ": is empty");
    if (documents.size() > 1) throw SettingsError(source_name + ": holds more than one YAML document");
    return Data::build(documents[0], std::move(root), 0, budget);
  } catch (const YAML::Exception& error) {
    fail_at(source_name, error.mark.is_null() ? 1 : error.mark.line + 1, "", "not YAML: " + error.msg);
  }
}

}  // namespace soft_robot_lab
