// SPDX-License-Identifier: BSD-3-Clause
#include "bad_scenes.h"

#include <cstddef>
#include <random>
#include <utility>

#include <yaml-cpp/yaml.h>

namespace soft_robot_lab {
namespace {

struct GoodScene {
  const char* name;
  const char* text;
};

// Small bodies, so that one that is still valid runs in a moment; together they have every kind of key.
const std::vector<GoodScene> kGoodScenes = {
    {"cables",
     "body:\n"
     "  solid: {box: {size_m: [0.02, 0.02, 0.06], center_m: [0, 0, -0.03]}}\n"
     "  element: quadratic\n"
     "  element_size_m: 0.02\n"
     "  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}\n"
     "  damping: {rayleigh_stiffness_s: 0.004}\n"
     "  fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}, axes: [x, y, z]}]\n"
     "loads: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.0599]}, force_n: [0.01, 0, 0]}]\n"
     "gravity_m_s2: [0, 0, -9.81]\n"
     "cables:\n"
     "  - {name: left, points_m: [[-0.006, 0, 0], [-0.006, 0, -0.06]], command: contraction, compliance_m_n: 1.0e-5,\n"
     "     sheath_radius_m: 0.001, plug_radius_m: 0.003, min_contraction: 0.7, pull_speed_m_s: 0.02}\n"
     "  - {name: right, points_m: [[0.006, 0, 0], [0.006, 0, -0.06]], model: friction, friction_coefficient: 0.1}\n"
     "markers: [{name: tip, position_m: [0, 0, -0.06]}]\n"
     "solver: {method: newton, integrator: implicit_euler, time_step_s: 0.0166667, tolerance: 1.0e-6}\n"
     "run: {mode: dynamic, duration_s: 0.1, record_every_s: 0.05, commands: [{time_s: 0, left: 0.95}]}\n"},
    {"chamber",
     "body:\n"
     "  solid:\n"
     "    difference:\n"
     "      - box: {size_m: [0.03, 0.03, 0.05], center_m: [0, 0, 0]}\n"
     "      - {name: cavity, box: {size_m: [0.018, 0.018, 0.038], center_m: [0, 0, 0]}}\n"
     "  element_size_m: 0.02\n"
     "  material: {model: yeoh, c1_pa: 44000, c2_pa: 0, c3_pa: 0, poissons_ratio: 0.499, density_kg_m3: 1070}\n"
     "  fixed: [{box: {min_m: [-1, -1, 0.0249], max_m: [1, 1, 1]}}]\n"
     "chambers:\n"
     "  - {name: main, surface: cavity, initial_pressure_pa: 101000, command: beta, max_beta: 5, flow_ml_s: 20}\n"
     "markers: [{name: wall, position_m: [0.015, 0, 0]}]\n"
     "run: {mode: equilibrium, commands: [{time_s: 0, main: 1.1}]}\n"},
    {"modes",
     "body:\n"
     "  solid:\n"
     "    union:\n"
     "      - cylinder: {start_m: [0, 0, 0], end_m: [0, 0, -0.04], radius_m: 0.008}\n"
     "      - sphere: {radius_m: 0.01, center_m: [0, 0, -0.04]}\n"
     "  element: linear\n"
     "  linear_volume: vertex_averaged\n"
     "  element_size_m: 0.01\n"
     "  material: {youngs_modulus_pa: 100000, poissons_ratio: 0.45, density_kg_m3: 1000}\n"
     "  fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]\n"
     "run: {mode: modal, modes: 2}\n"}};

const std::vector<const char*> kBadValues = {".nan",
                                             ".inf",
                                             "-.inf",
                                             "-1",
                                             "0",
                                             "1.0e300",
                                             "1.0e-300",
                                             "1.0e9",
                                             "99999999999999999999",
                                             "yes",
                                             "''",
                                             "[]",
                                             "{}",
                                             "[1, 2]",
                                             "{a: 1}",
                                             "\"\\0\"",
                                             "~",
                                             "\"a\\\"b'c\"",
                                             "0x10",
                                             "1e",
                                             "../..",
                                             "/dev/null",
                                             "[[1]]",
                                             "\"\\xff\"",
                                             "-9223372036854775809",
                                             "!!binary x"};

// Of a number in a list, whose neighbours get the same.
const std::vector<const char*> kBadNumbers = {".nan", "1.0e300", "-1.0e9", "x", "[1]"};

// A place in the tree: keys and indices from the root on.
using Path = std::vector<std::pair<std::string, std::size_t>>;

std::string words(const Path& path) {
  std::string text;
  for (const auto& [key, index] : path) text += (text.empty() ? "" : ".") + (key.empty() ? std::to_string(index) : key);
  return text;
}

void collect(const YAML::Node& node, const Path& here, std::vector<Path>& all) {
  if (!here.empty()) all.push_back(here);
  if (node.IsMap())
    for (const auto& item : node) {
      Path below = here;
      below.emplace_back(item.first.as<std::string>(), 0);
      collect(item.second, below, all);
    }
  if (node.IsSequence())
    for (std::size_t i = 0; i < node.size(); ++i) {
      Path below = here;
      below.emplace_back("", i);
      collect(node[i], below, all);
    }
}

// The tree as flow-style YAML, with `at` written by `write` instead: plain text, as not every bad scene is a tree.
template <typename Write>
void emit(const YAML::Node& node, const Path& here, const Path& at, const Write& write, std::string& out) {
  if (here == at) return write(node, out);
  if (node.IsMap()) {
    out += "{";
    bool first = true;
    for (const auto& item : node) {
      Path below = here;
      below.emplace_back(item.first.as<std::string>(), 0);
      out += (first ? "" : ", ") + item.first.as<std::string>() + ": ";
      emit(item.second, below, at, write, out);
      first = false;
    }
    out += "}";
  } else if (node.IsSequence()) {
    out += "[";
    for (std::size_t i = 0; i < node.size(); ++i) {
      Path below = here;
      below.emplace_back("", i);
      out += i ? ", " : "";
      emit(node[i], below, at, write, out);
    }
    out += "]";
  } else {
    out += node.as<std::string>();
  }
}

template <typename Write>
std::string with(const YAML::Node& root, const Path& at, const Write& write) {
  std::string out;
  emit(root, {}, at, write, out);
  return out + "\n";
}

std::string plain(const YAML::Node& node) {
  std::string out;
  emit(
      node, {}, {{"no such place", 1}}, [](const YAML::Node&, std::string&) {}, out);
  return out;
}

void add_values(const GoodScene& good, const YAML::Node& root, const Path& path, std::vector<BadScene>& all) {
  for (const char* value : path.back().first.empty() ? kBadNumbers : kBadValues)
    all.push_back({std::string(good.name) + ": " + words(path) + " is " + value,
                   with(root, path, [&](const YAML::Node&, std::string& out) { out += value; })});
}

// Of a key: written wrongly, left out, given twice.
void add_key_faults(const GoodScene& good, const YAML::Node& root, const Path& path, std::vector<BadScene>& all) {
  if (path.back().first.empty()) return;
  const std::string what = std::string(good.name) + ": " + words(path);
  const std::string key = path.back().first;
  Path parent(path.begin(), path.end() - 1);
  const auto in_parent = [&](const auto& item_text) {
    return with(root, parent, [&](const YAML::Node& map, std::string& out) {
      out += "{";
      for (const auto& item : map) {
        const std::string name = item.first.as<std::string>();
        out += item_text(name, plain(item.second));
      }
      out += "}";
    });
  };
  all.push_back({what + " is misspelt", in_parent([&](const std::string& name, const std::string& value) {
                   return (name == key ? name + "x" : name) + ": " + value + ", ";
                 })});
  all.push_back({what + " is left out", in_parent([&](const std::string& name, const std::string& value) {
                   return name == key ? std::string() : name + ": " + value + ", ";
                 })});
  all.push_back({what + " is given twice", in_parent([&](const std::string& name, const std::string& value) {
                   const std::string item = name + ": " + value + ", ";
                   return name == key ? item + item : item;
                 })});
}

void add_list_faults(const GoodScene& good, const YAML::Node& root, const Path& path, std::vector<BadScene>& all) {
  YAML::Node node = YAML::Clone(root);
  for (const auto& [key, index] : path) {
    const YAML::Node below = key.empty() ? node[index] : node[key];
    node.reset(below);
  }
  if (!node.IsSequence() || node.size() == 0) return;
  all.push_back({std::string(good.name) + ": " + words(path) + " is doubled",
                 with(root, path, [](const YAML::Node& list, std::string& out) {
                   std::string items = plain(list);
                   items = items.substr(1, items.size() - 2);
                   out += "[" + items + ", " + items + "]";
                 })});
}

void add_text_faults(const GoodScene& good, std::mt19937& random, std::vector<BadScene>& all) {
  const std::string text = good.text;
  for (int i = 0; i < 20; ++i) {
    const std::size_t at = random() % text.size();
    all.push_back({std::string(good.name) + ": cut off after " + std::to_string(at) + " bytes", text.substr(0, at)});
    std::string changed = text;
    for (int k = 0; k < 3; ++k) changed[random() % changed.size()] = static_cast<char>(random() % 256);
    all.push_back({std::string(good.name) + ": three other bytes, " + std::to_string(i), changed});
  }
}

}  // namespace

std::vector<BadScene> bad_scenes(unsigned int seed) {
  std::mt19937 random(seed);
  std::vector<BadScene> all;
  for (const GoodScene& good : kGoodScenes) {
    const YAML::Node root = YAML::Load(good.text);
    std::vector<Path> paths;
    collect(root, {}, paths);
    for (const Path& path : paths) {
      add_values(good, root, path, all);
      add_key_faults(good, root, path, all);
      add_list_faults(good, root, path, all);
    }
    add_text_faults(good, random, all);
  }
  return all;
}

}  // namespace soft_robot_lab
