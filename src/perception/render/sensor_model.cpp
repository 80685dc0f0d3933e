// SPDX-License-Identifier: BSD-3-Clause
#include "sensor_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

struct Field {
  const char* name;
  double SensorModel::*value;
  AllowedRange range;
};

const Field fields[] = {
    {"exposure_gain", &SensorModel::exposure_gain, AllowedRange::positive()},
    {"light_gradient", &SensorModel::light_gradient, {0, 1}},
    {"gloss", &SensorModel::gloss, {0, 1}},
    {"blur_px", &SensorModel::blur_px, {0, 50}},
    {"exposure_time_s", &SensorModel::exposure_time_s, {0, 1}},
    {"readout_time_s", &SensorModel::readout_time_s, {0, 1}},
    {"electrons_at_white", &SensorModel::electrons_at_white, AllowedRange::not_negative()},
    {"read_noise", &SensorModel::read_noise, {0, 1}},
    {"baseline_m", &SensorModel::baseline_m, AllowedRange::positive()},
    {"field_of_view_deg", &SensorModel::field_of_view_deg, {0, 180, true, true}},
    {"disparity_noise_px", &SensorModel::disparity_noise_px, {0, 10}},
    {"noise_correlation_px", &SensorModel::noise_correlation_px, {0, 20}},
    {"disparity_step_px", &SensorModel::disparity_step_px, {0, 10}},
    {"depth_step_m", &SensorModel::depth_step_m, {0, 0.1}},
    {"edge_hole_px", &SensorModel::edge_hole_px, {0, 50}},
    {"low_texture_level", &SensorModel::low_texture_level, {0, 1}},
};

constexpr double exposure_unit_s = 1e-4;  // of CameraSetting
constexpr double gain_octave = 32;        // steps that double the brightness

void require_within(const char* name, int value, int min, int max) {
  if (value < min || value > max)
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + "; allowed: [" +
                                std::to_string(min) + ", " + std::to_string(max) + "]");
}

}  // namespace

SensorModel SensorModel::d415() {
  SensorModel model;
  model.light_gradient = 0.1;
  model.gloss = 0.5;
  model.blur_px = 0.6;
  model.exposure_time_s = 0.008;
  model.readout_time_s = 0.030;
  model.electrons_at_white = 5000;
  model.read_noise = 0.006;
  model.disparity_noise_px = 0.08;
  model.noise_correlation_px = 1.5;
  model.disparity_step_px = 1.0 / 32;
  model.edge_hole_px = 1.5;
  model.stereo_shadow = true;
  model.low_texture_level = 0.1;
  return model;
}

void SensorModel::validate() const {
  for (const Field& field : fields)
    if (!field.range.contains(this->*field.value))
      throw std::invalid_argument("sensor." + std::string(field.name) + " is " + std::to_string(this->*field.value) +
                                  "; allowed: " + field.range.to_string());
}

CameraSetting own_setting(const SensorModel& model) {
  CameraSetting setting;
  const CameraSettingLimits limits;
  if (model.exposure_time_s > 0)
    setting.exposure = std::clamp(static_cast<int>(std::lround(model.exposure_time_s / exposure_unit_s)),
                                  limits.min_exposure, limits.max_exposure);
  return setting;
}

SensorModel exposed(SensorModel model, const CameraSetting& setting) {
  const CameraSettingLimits limits;
  require_within("exposure", setting.exposure, limits.min_exposure, limits.max_exposure);
  require_within("gain", setting.gain, limits.min_gain, limits.max_gain);
  if (setting.automatic) return model;
  const CameraSetting own = own_setting(model);
  const double gain = std::exp2((setting.gain - own.gain) / gain_octave);
  model.exposure_gain *= gain * setting.exposure / own.exposure;
  model.electrons_at_white /= gain;
  model.read_noise *= gain;
  if (model.exposure_time_s > 0) model.exposure_time_s = exposure_unit_s * setting.exposure;
  return model;
}

SensorModel read_sensor_model(const YamlNode& node) {
  const auto named = [](const std::string& name) { return name == "d415" ? SensorModel::d415() : SensorModel{}; };
  if (!node.is_map()) {
    const std::string name = node.as_text();
    if (name != "exact" && name != "d415") node.fail("'" + name + "' is not one of exact, d415, nor a map of keys");
    return named(name);
  }
  SensorModel model = named(node.choice_or("base", "exact", {"exact", "d415"}));
  for (const Field& field : fields) model.*field.value = node.number_or(field.name, model.*field.value, field.range);
  model.stereo_shadow = node.boolean_or("stereo_shadow", model.stereo_shadow);
  return model;
}

}  // namespace soft_robot_lab
