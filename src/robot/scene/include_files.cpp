// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "sections.h"
#include "settings/named_file.h"

namespace soft_robot_lab {
namespace {

// A `model` over an included `preset` replaces it, so that it must state its moduli; a modulus alone does not.
void check_material(const YamlNode& section, const YamlNode& included) {
  const std::optional<YamlNode> below = included.optional_child("material"), over = section.optional_child("material");
  if (!below || !over || !below->is_map() || !over->is_map() || over->has("preset")) return;
  if (!below->has("preset")) return;
  const std::string preset = below->text("preset"), file = below->source();
  if (!over->has("model")) {
    for (const char* key : {"youngs_modulus_pa", "c10_pa", "c01_pa", "c1_pa", "c2_pa", "c3_pa"})
      if (over->has(key))
        over->child(key).fail("stands over `preset: " + preset + "` of " + file +
                              "; give the `model` of this modulus beside it, which replaces the preset with all its "
                              "keys, or a `stiffness_ratio` of the preset instead");
  } else if (over->text("model") == "neo_hookean" && !over->has("youngs_modulus_pa")) {
    over->child("model").fail("replaces `preset: " + preset + "` of " + file +
                              " with all its keys: give youngs_modulus_pa beside it, or leave it out");
  }
}

void check_body(const YamlNode& scene, const YamlNode& included) {
  if (!scene.is_map() || !included.is_map()) return;
  const std::optional<YamlNode> body = scene.optional_child("body"), below = included.optional_child("body");
  if (body && below && body->is_map() && below->is_map()) check_material(*body, *below);
}

// The same for all names of one file. A name that no file can have is left as it is.
std::string plain_path(const std::string& path) {
  std::error_code failed;
  const std::filesystem::path plain = std::filesystem::weakly_canonical(path, failed);
  return failed ? path : plain.string();
}

// `open_files`: those that led here, to find circles.
YamlNode resolve(const YamlNode& settings, std::vector<std::string> open_files) {
  const std::optional<YamlNode> include = settings.optional_child("include");
  if (!include) return settings;
  open_files.push_back(plain_path(settings.source()));
  const std::string base = named_file(*include);
  if (std::find(open_files.begin(), open_files.end(), plain_path(base)) != open_files.end()) {
    include->fail("'" + include->as_text() + "' includes itself");
  }
  std::error_code ignored;
  if (!std::filesystem::exists(base, ignored)) include->fail("there is no file " + base);
  const YamlNode included = resolve(YamlNode::load_file(base), open_files);
  check_body(settings, included);
  return merge_settings(included, settings);
}

}  // namespace

YamlNode with_includes(const YamlNode& settings) { return resolve(settings, {}); }

std::vector<std::string> files_of_scene(const std::string& path) {
  std::vector<std::string> files;
  std::string at = plain_path(path);
  while (std::find(files.begin(), files.end(), at) == files.end()) {
    files.push_back(at);
    const YamlNode settings = YamlNode::load_file(at);
    if (settings.is_map() && settings.has("include")) at = plain_path(named_file(settings.child("include")));
  }
  return files;
}

}  // namespace soft_robot_lab
