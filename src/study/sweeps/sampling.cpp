// SPDX-License-Identifier: BSD-3-Clause
#include "sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>

#include <boost/math/special_functions/erf.hpp>
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

double probability(double standard) { return 0.5 * std::erfc(-standard * std::sqrt(0.5)); }

double standard_normal(double fraction) { return -std::sqrt(2.0) * boost::math::erfc_inv(2.0 * fraction); }

// Where it is cut off, what is left is stretched over the whole fraction.
double on_distribution(const StudyParameter& parameter, double fraction) {
  const bool logarithm = parameter.distribution == Distribution::log_normal;
  const auto law = [&](double value) { return logarithm ? std::log(value) : value; };
  const double middle = law(parameter.centre);
  const double least = probability((law(parameter.min) - middle) / parameter.deviation);
  const double most = probability((law(parameter.max) - middle) / parameter.deviation);
  constexpr double end = 1.0e-12;  // the ends of an endless distribution are no numbers
  const double at = std::clamp(least + fraction * (most - least), end, 1.0 - end);
  const double value = middle + parameter.deviation * standard_normal(at);
  return std::clamp(logarithm ? std::exp(value) : value, parameter.min, parameter.max);
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
      points[i].push_back(value_at(parameter, (static_cast<double>(slices[i]) + random.uniform()) / study.samples));
  }
  return points;
}

// Points in [0, 1) of so many dimensions.
class SobolSequence {
 public:
  SobolSequence(std::size_t dimensions, int seed) : shifts_(dimensions), sequence_(dimensions) {
    Random random(seed);
    for (std::uint64_t& shift : shifts_) shift = random.bits();
  }

  std::vector<double> next() {
    std::vector<double> point;
    for (const std::uint64_t shift : shifts_)
      point.push_back(std::ldexp(static_cast<double>((sequence_() ^ shift) >> 11), -53));
    return point;
  }

 private:
  std::vector<std::uint64_t> shifts_;
  boost::random::sobol sequence_;
};

std::vector<double> at(const StudySettings& study, const std::vector<double>& fractions) {
  std::vector<double> point;
  for (std::size_t i = 0; i < study.parameters.size(); ++i)
    point.push_back(value_at(study.parameters[i], fractions[i]));
  return point;
}

Points sobol(const StudySettings& study) {
  SobolSequence sequence(study.parameters.size(), study.seed);
  Points points;
  for (int i = 0; i < study.samples; ++i) points.push_back(at(study, sequence.next()));
  return points;
}

// For each base point: A, B, and A with one value of B for each parameter.
Points sobol_indices_points(const StudySettings& study) {
  const std::size_t count = study.parameters.size();
  if (static_cast<std::size_t>(study.samples) * (count + 2) > static_cast<std::size_t>(kMostTasks))
    throw std::invalid_argument("samples: sobol_indices makes samples * (parameters + 2) tasks, more than " +
                                std::to_string(kMostTasks));
  SobolSequence sequence(2 * count, study.seed);
  Points points;
  for (int i = 0; i < study.samples; ++i) {
    const std::vector<double> both = sequence.next();
    const std::vector<double> a = at(study, both);
    const std::vector<double> b = at(study, {both.begin() + static_cast<std::ptrdiff_t>(count), both.end()});
    points.insert(points.end(), {a, b});
    for (std::size_t p = 0; p < count; ++p) {
      points.push_back(a);
      points.back()[p] = b[p];
    }
  }
  return points;
}

}  // namespace

double value_at(const StudyParameter& parameter, double fraction) {
  if (parameter.distribution != Distribution::even) return on_distribution(parameter, fraction);
  if (parameter.values.empty()) return on_range(parameter, fraction);
  const std::size_t count = parameter.values.size();
  return parameter.values[std::min(static_cast<std::size_t>(fraction * static_cast<double>(count)), count - 1)];
}

std::vector<std::vector<double>> sample(const StudySettings& study) {
  switch (study.method) {
    case SamplingMethod::grid:
      return grid(study);
    case SamplingMethod::latin_hypercube:
      return latin_hypercube(study);
    case SamplingMethod::sobol:
      return sobol(study);
    case SamplingMethod::sobol_indices:
      return sobol_indices_points(study);
  }
  throw std::logic_error("no such method");
}

}  // namespace soft_robot_lab
