// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <optional>

#include "sections.h"
#include "soft_robot_lab/settings/config_folder.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

// Names of the files in config/materials.
std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(config_folder() + "/materials"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Material read_preset(const YamlNode& node) {
  const std::string name = node.choice("preset", preset_names());
  for (const char* key : {"model", "youngs_modulus_pa", "c10_pa", "c01_pa", "c1_pa", "c2_pa", "c3_pa"})
    if (node.has(key)) node.child(key).fail("belongs to the preset '" + name + "'; leave out one of them");
  const YamlNode file = YamlNode::load_file(config_folder() + "/materials/" + name + ".yaml");
  const Material material = read_material(file);
  file.require_all_read();
  return material;
}

Material read_model(const YamlNode& node) {
  Material material;
  const std::string model = node.choice_or("model", "neo_hookean", {"neo_hookean", "mooney_rivlin", "yeoh"});
  if (model == "neo_hookean") {
    material.youngs_modulus_pa = node.number_or("youngs_modulus_pa", material.youngs_modulus_pa);
    return material;
  }
  return model == "mooney_rivlin"
             ? Material::mooney_rivlin(node.number("c10_pa"), node.number("c01_pa"), material.poissons_ratio,
                                       material.density_kg_m3)
             : Material::yeoh(node.number("c1_pa"), node.number_or("c2_pa", 0.0), node.number_or("c3_pa", 0.0),
                              material.poissons_ratio, material.density_kg_m3);
}

// A share of every modulus, whatever the model.
void scale(Material& material, double ratio) {
  for (double* modulus_pa : {&material.youngs_modulus_pa, &material.c01_pa, &material.c2_pa, &material.c3_pa})
    *modulus_pa *= ratio;
}

}  // namespace

// The constants of mooney_rivlin and yeoh say the shear modulus, so Young's modulus follows Poisson's ratio with them.
Material read_material(const YamlNode& node) {
  Material material = node.has("preset") ? read_preset(node) : read_model(node);
  scale(material, node.number_or("stiffness_ratio", 1.0, AllowedRange::positive()));
  const double mu_pa = material.lame_mu_pa();
  material.poissons_ratio = node.number_or("poissons_ratio", material.poissons_ratio);
  material.density_kg_m3 = node.number_or("density_kg_m3", material.density_kg_m3);
  if (material.model != MaterialModel::neo_hookean)
    material.youngs_modulus_pa = 2.0 * mu_pa * (1.0 + material.poissons_ratio);
  in_section(node, [&] { material.validate(); });
  return material;
}

std::optional<YamlNode> stated_modulus(const YamlNode& node) {
  if (node.has("preset") || node.has("stiffness_ratio")) return std::nullopt;
  const std::string model = node.text_or("model", "neo_hookean");
  if (model == "neo_hookean") return node.optional_child("youngs_modulus_pa");
  if (model == "yeoh") return node.child("c1_pa");
  return node.child(node.number("c10_pa") >= node.number("c01_pa") ? "c10_pa" : "c01_pa");
}

}  // namespace soft_robot_lab
