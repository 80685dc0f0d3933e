// SPDX-License-Identifier: BSD-3-Clause
// From the text of a settings file to its tree.
#include <algorithm>
#include <cstddef>
#include <sstream>
#include <unordered_map>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/yaml.h>

#include "kept_files.h"
#include "settings_data.h"
#include "limits.h"
#include "read_file.h"

namespace soft_robot_lab {
namespace {

// Aliases may repeat a part of a document without end; no settings file comes near these.
constexpr int kMaxDepth = limits::kTree_depth;
constexpr long kMaxNodes = limits::kTree_nodes;  // of the text
constexpr std::size_t kShownPath = 60;
constexpr long kMaxBytes = limits::kTree_bytes;  // of the tree, with all that aliases repeat

// Counts what a text holds before anything is kept of it: yaml-cpp takes hundreds of bytes for a node of two.
class NodeCounter : public YAML::EventHandler {
 public:
  explicit NodeCounter(const std::string& source) : source_(source) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string&) override {
    count(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    count(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    count(mark);
  }
  void OnMapEnd() override {}

 private:
  void count(const YAML::Mark& mark) {
    if (++nodes_ > kMaxNodes)
      fail_at(source_, mark.line + 1, "",
              "nested too deep, or too large: more than " + std::to_string(kMaxNodes) + " values and keys");
  }

  const std::string& source_;
  long nodes_ = 0;
};

void check_size(const std::string& text, const std::string& source) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  NodeCounter counter(source);
  while (parser.HandleNextDocument(counter)) {
  }
}

bool indented_by_tab(const std::string& line) {
  const std::size_t tab = line.find('\t'), text = line.find_first_not_of(" \t\r");
  return tab < text && text != std::string::npos;
}

// The last line up to this one in which a tab indents, counted from 1; 0 where none does.
int tab_line(const std::string& text, int up_to) {
  std::istringstream lines(text);
  int last = 0;
  std::string line;
  for (int number = 1; number <= up_to && std::getline(lines, line); ++number)
    if (indented_by_tab(line)) last = number;
  return last;
}

[[noreturn]] void fail_as_no_yaml(const YAML::Exception& error, const std::string& text, const std::string& source) {
  const int line = error.mark.is_null() ? 1 : error.mark.line + 1;
  if (const int tab = tab_line(text, line); tab > 0)
    fail_at(source, tab, "", "not YAML: a tab indents this line, where YAML takes spaces alone");
  if (dynamic_cast<const YAML::DeepRecursion*>(&error) != nullptr)
    fail_at(source, line, "", "nested too deep: more than 500 lists and maps within one another");
  fail_at(source, line, "", "not YAML: " + error.msg);
}

}  // namespace

// `place` carries source, line and path of the node.
YamlNode YamlNode::Data::build(const YAML::Node& yaml, Data place, int depth, long& bytes_left) {
  auto data = std::make_shared<Data>(std::move(place));
  bytes_left -= static_cast<long>(sizeof(Data) + sizeof(Member) + data->source.size() + 2 * data->path.size());
  if (yaml.IsScalar()) bytes_left -= static_cast<long>(yaml.Scalar().size());
  if (depth > kMaxDepth || bytes_left < 0)
    fail_at(data->source, data->line, data->path.substr(0, kShownPath) + (data->path.size() > kShownPath ? "..." : ""),
            "nested too deep, or too large; an alias may stand within its own anchor");
  const auto place_below = [&](const YAML::Mark& mark, const std::string& its_path) {
    Data below;
    below.source = data->source;
    below.line = mark.is_null() ? data->line : mark.line + 1;
    below.path = its_path;
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
      data->items.push_back(build(item, place_below(item.Mark(), path), depth + 1, bytes_left));
    }
  } else if (yaml.IsMap()) {
    data->kind = Kind::map;
    std::unordered_map<std::string, int> first_line;
    for (const auto& pair : yaml) {
      Data below = place_below(pair.first.Mark(), data->path);
      if (!pair.first.IsScalar()) fail_at(below.source, below.line, below.path, "a key must be a word");
      const std::string& key = pair.first.Scalar();
      const auto [first, is_new] = first_line.emplace(key, below.line);
      if (!is_new)
        fail_at(below.source, below.line, below.path,
                "key '" + key + "' stands twice, first in line " + std::to_string(first->second));
      below.path += (below.path.empty() ? "" : ".") + key;
      const int line = below.line;
      data->members.push_back(
          {key, data->source, line, build(pair.second, std::move(below), depth + 1, bytes_left), false});
    }
  }
  return YamlNode(std::move(data));
}

YamlNode YamlNode::load_file(const std::string& path) {
  if (const std::string option = output_over(path); !option.empty())
    throw SettingsError(path + ": would be written over by " + option + "; give that a file of its own");
  std::string text;
  try {
    text = read_regular_file(path, kLargestSettings_bytes);
  } catch (const std::invalid_argument& error) {
    throw SettingsError(error.what());
  }
  return parse(text, path);
}

YamlNode YamlNode::parse(const std::string& text, const std::string& source_name) {
  Data root;
  root.source = source_name;
  long bytes_left = kMaxBytes;
  if (const std::size_t at = text.find('\0'); at != std::string::npos)
    fail_at(source_name,
            static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')) + 1, "",
            "not YAML: holds a byte of value 0, as no text does");
  try {
    check_size(text, source_name);
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.empty()) throw SettingsError(source_name + ": is empty");
    if (documents.size() > 1) throw SettingsError(source_name + ": holds more than one YAML document");
    return Data::build(documents[0], std::move(root), 0, bytes_left);
  } catch (const YAML::Exception& error) {
    fail_as_no_yaml(error, text, source_name);
  }
}

}  // namespace soft_robot_lab
