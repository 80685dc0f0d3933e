// SPDX-License-Identifier: BSD-3-Clause
#include "measured_tentacle.h"

#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "control/identification/pose_model.h"

namespace soft_robot_lab {
namespace {

Eigen::Vector3d vector_of(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

std::map<std::string, Eigen::Vector3d> places_of(const nlohmann::json& json) {
  std::map<std::string, Eigen::Vector3d> places;
  for (const auto& [name, place] : json.items()) places[name] = vector_of(place);
  return places;
}

TentacleMaterial material_of(const nlohmann::json& json) {
  return {json.at("youngs_modulus_pa"), json.at("poissons_ratio"), json.at("density_kg_m3")};
}

TentaclePose pose_of(const nlohmann::json& json) {
  TentaclePose pose;
  pose.measured.commands["tendon_1"] = json.at("tendon_tension_n").at(0);
  for (const auto& [name, marker] : json.at("markers").items()) {
    const Eigen::Vector3d deviation_m = vector_of(marker.at("std_m"));
    pose.measured.markers.push_back(
        {name, vector_of(marker.at("mean_m")), deviation_m.cwiseAbs2().asDiagonal().toDenseMatrix()});
  }
  pose.session = json.at("session");
  const nlohmann::json& source = json.at("source_model");
  pose.soromox_identified_m = source.at("identified").at("mean_error_m");
  if (source.contains("start")) pose.soromox_start_m = source.at("start").at("mean_error_m").get<double>();
  pose.rod_identified_m = json.at("converged_rod").at("mean_error_m");
  pose.rod_m = places_of(json.at("converged_rod").at("prediction_m"));
  return pose;
}

MeasuredTentacle tentacle_of(const nlohmann::json& json) {
  MeasuredTentacle tentacle{material_of(json.at("material_start")),
                            material_of(json.at("material_identified_by_source")),
                            {},
                            places_of(json.at("hanging_rest").at("markers_m"))};
  for (const nlohmann::json& pose : json.at("poses")) tentacle.poses.push_back(pose_of(pose));
  const nlohmann::json& known = json.at("errors_of_known_models");
  tentacle.soromox_start_m = known.at("source_start_parameters_session_A_only").at("mean_error_m");
  tentacle.soromox_identified_m = known.at("source_identified").at("mean_error_m");
  tentacle.fitted_rod_m = known.at("converged_rod_E365k_rho1270").at("mean_error_m");
  return tentacle;
}

}  // namespace

Overrides TentacleMaterial::overrides() const {
  return Overrides()
      .set({"body", "material", "youngs_modulus_pa"}, youngs_modulus_pa)
      .set({"body", "material", "poissons_ratio"}, poissons_ratio)
      .set({"body", "material", "density_kg_m3"}, density_kg_m3);
}

MeasuredTentacle read_measured_tentacle(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  try {
    return tentacle_of(nlohmann::json::parse(in));
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file + ": " + error.what());
  }
}

TentacleGap tentacle_gap(const std::string& robot, const SceneOptions& options,
                         const std::vector<MeasuredPose>& poses) {
  const std::vector<PosePrediction> predicted = PoseModel(robot, options, poses).predict(options.overrides);
  TentacleGap gap;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    const auto count = static_cast<double>(poses[p].markers.size());
    gap.markers_m.push_back(predicted[p].markers_m);
    gap.pose_mean_m.push_back(0.0);
    for (std::size_t m = 0; m < poses[p].markers.size(); ++m) {
      const MeasuredMarker& marker = poses[p].markers[m];
      const Eigen::Vector3d off_m = predicted[p].markers_m.col(static_cast<Eigen::Index>(m)) - marker.position_m;
      gap.pose_mean_m.back() += off_m.norm() / count;
      const auto mean = gap.offset_m.emplace(marker.name, Eigen::Vector3d::Zero()).first;
      mean->second += off_m / static_cast<double>(poses.size());
    }
    gap.mean_m += gap.pose_mean_m.back() / static_cast<double>(poses.size());
  }
  return gap;
}

}  // namespace soft_robot_lab
