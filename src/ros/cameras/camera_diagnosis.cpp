// SPDX-License-Identifier: BSD-3-Clause
#include "camera_diagnosis.h"

#include <sstream>
#include <utility>

#include "ros/tracking/tracking_input.h"

namespace soft_robot_lab {

CameraDiagnosis::CameraDiagnosis(std::string camera) : camera_(std::move(camera)) {}

CameraDiagnosis::Finding CameraDiagnosis::diagnose(double passed_s, const std::string& missing) {
  silent_s_ = colour_ > 0 && depth_ > 0 ? 0 : silent_s_ + passed_s;
  const Finding finding = judge(missing);
  colour_ = depth_ = frames_ = 0;
  own_sights_ = all_sights_ = 0;
  problem_.clear();
  return finding;
}

CameraDiagnosis::Finding CameraDiagnosis::judge(const std::string& missing) const {
  if (silent_s_ > 0) {
    std::ostringstream text;
    text.precision(2);
    text << "nothing on " << (colour_ == 0 ? colour_topic(camera_) : depth_topic(camera_)) << " for " << silent_s_
         << " s: is it plugged in?";
    return {Level::error, text.str()};
  }
  if (!problem_.empty()) return {Level::warning, problem_};
  if (!missing.empty()) return {Level::error, missing};
  if (frames_ == 0) return {Level::warning, "colour and depth come, but never with the same stamp"};
  if (own_sights_ == 0 && all_sights_ > 0) return {Level::warning, "it sees none of the markers, others do"};
  return {Level::ok, "its images are used"};
}

}  // namespace soft_robot_lab
