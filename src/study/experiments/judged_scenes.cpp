// SPDX-License-Identifier: BSD-3-Clause
#include "judged_scenes.h"

#include <fstream>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

namespace soft_robot_lab {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JudgedScene, name, method, apart_m, moved_m, motion_s, rest_after_s, cpu_s, said,
                                   failed, open)

namespace {

void write_line(const std::string& file, std::ios::openmode mode, const nlohmann::json& line) {
  std::ofstream out(file, mode);
  if (!(out << line << '\n' << std::flush)) throw std::runtime_error(file + ": cannot be written");
}

// The last line may be cut off.
nlohmann::json next_line(std::istream& in) {
  std::string line;
  if (!std::getline(in, line)) return nullptr;
  const auto read = nlohmann::json::parse(line, nullptr, false);
  return read.is_object() ? read : nlohmann::json();
}

}  // namespace

JudgedScenes::JudgedScenes(std::string file, const std::string& settings) : file_(std::move(file)) {
  std::ifstream in(file_);
  const nlohmann::json first = next_line(in);
  const bool same = first.is_object() && first.value("settings", "") == settings;
  for (nlohmann::json line = next_line(in); same && line.is_object(); line = next_line(in))
    judged_[line.at("scene").get<int>()] = line.at("judged").get<std::vector<JudgedScene>>();
  of_earlier_run_ = static_cast<int>(judged_.size());
  write_line(file_, std::ios::trunc, {{"settings", settings}});
  for (const auto& [scene, judged] : judged_) write_line(file_, std::ios::app, {{"scene", scene}, {"judged", judged}});
}

const std::vector<JudgedScene>* JudgedScenes::find(int scene) const {
  const auto found = judged_.find(scene);
  return found == judged_.end() ? nullptr : &found->second;
}

void JudgedScenes::add(int scene, const std::vector<JudgedScene>& judged) {
  judged_[scene] = judged;
  write_line(file_, std::ios::app, {{"scene", scene}, {"judged", judged}});
}

}  // namespace soft_robot_lab
