// SPDX-License-Identifier: BSD-3-Clause
#include "sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>

#include <boost/random/sobol.hpp>

namespace soft_robot_lab {
namespace {

using Points = std::vector<std::vector<double>>;

// The standard fixes what this engine draws, but not what its distributions make of it.
class Random {
 public:
  explicit Random(int seed) : engine_(static_cast<std::uint64_t>(seed)) {}
  std::uint64_t bits() { return engine_(); }
  double uniform() { return std::ldexp(static_cast<double>(engine_() >> 11), -53); }  // [0, 1)
  std::size_t below(std::size_t count) {
    return std::min(static_cast<std::size_t>(uniform() * static_cast<double>(count)), count - 1);
  }

 private:
  std::mt19937_64 engine_;
};

// `fraction` in [0, 1].
double on_range(const StudyParameter& parameter, double fraction) {
  const double value =
      parameter.logarithmic
          ? std::exp(std::log(parameter.min) + fraction * (std::log(parameter.max) - std::log(parameter.min)))
          : parameter.min + fraction * (parameter.max - parameter.min);
  return std::clamp(value, parameter.min, parameter.max);
}

double at(const StudyParameter& parameter, double fraction) {
  if (parameter.values.empty()) return on_range(parameter, fraction);
  const std::size_t count = parameter.values.size();
  return parameter.values[std::min(static_cast<std::size_t>(fraction * static_cast<double>(count)), count - 1)];
}

std::vector<double> steps_of(const StudyParameter& parameter) {
  if (!parameter.values.empty()) return parameter.values;
  std::vector<double> values;
  for (int i = 0; i < parameter.steps; ++i)
    values.push_back(on_range(parameter, static_cast<double>(i) / (parameter.steps - 1)));
  return values;
}

Points grid(const StudySettings& study) {
  Points points = {{}};
  for (const StudyParameter& parameter : study.parameters) {
    const std::vector<double> values = steps_of(parameter);
    if (points.size() * values.size() > static_cast<std::size_t>(kMostTasks))
      throw std::invalid_argument("parameters: the grid has more than " + std::to_string(kMostTasks) + " points");
    Points longer;
    for (const std::vector<double>& point : points)
      for (const double value : values) {
        longer.push_back(point);
        longer.back().push_back(value);
      }
    points = std::move(longer);
  }
  return points;
}

Points latin_hypercube(const StudySettings& study) {
  const auto count = static_cast<std::size_t>(study.samples);
  Points points(count);
  Random random(study.seed);
  std::vector<std::size_t> slices(count);
  for (const StudyParameter& parameter : study.parameters) {
    std::iota(slices.begin(), slices.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i) std::swap(slices[i - 1], slices[random.below(i)]);
    for (std::size_t i = 0; i < count; ++i)
      points[i].push_back(at(parameter, (static_cast<double>(slices[i]) + random.uniform()) / study.samples));
  }
  return points;
}

Points sobol(const StudySettings& study) {
  Random random(study.seed);
  std::vector<std::uint64_t> shifts(study.parameters.size());
  for (std::uint64_t& shift : shifts) shift = random.bits();
  boost::random::sobol sequence(study.parameters.size());
  Points points(static_cast<std::size_t>(study.samples));
  for (std::vector<double>& point : points)
    for (std::size_t i = 0; i < study.parameters.size(); ++i) {
      const std::uint64_t bits = sequence() ^ shifts[i];
      point.push_back(at(study.parameters[i], std::ldexp(static_cast<double>(bits >> 11), -53)));
    }
  return points;
}

}  // namespace

std::vector<std::vector<double>> sample(const StudySettings& study) {
  if (study.method == SamplingMethod::grid) return grid(study);
  return study.method == SamplingMethod::sobol ? sobol(study) : latin_hypercube(study);
}

}  // namespace soft_robot_lab
