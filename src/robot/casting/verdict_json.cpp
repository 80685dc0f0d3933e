// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <nlohmann/json.hpp>

#include "check_casting.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json vector(const Eigen::Vector3d& value) { return {number(value.x()), number(value.y()), number(value.z())}; }

Json test_json(const CastingTest& test) {
  Json json;
  json["passed"] = test.passed;
  for (const auto& [key, value] : test.numbers) json[key] = number(value);
  if (test.at_m) json["at_m"] = vector(*test.at_m);
  if (!test.cause.empty()) json["cause"] = test.cause;
  if (!test.why.empty()) json["why"] = test.why;
  if (!test.by.empty()) json["by"] = test.by;
  return json;
}

}  // namespace

std::string verdict_json(const CastingVerdict& verdict) {
  Json json;
  json["castable"] = verdict.castable;
  json["direction"] = vector(verdict.direction);
  json["direction_given"] = verdict.direction_given;
  for (const CastingTest& test : verdict.tests) json["tests"][test.name] = test_json(test);
  if (!verdict.note.empty()) json["note"] = verdict.note;
  return json.dump(2) + "\n";
}

}  // namespace soft_robot_lab
