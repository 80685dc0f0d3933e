// SPDX-License-Identifier: BSD-3-Clause
#include "sobol_indices.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>

#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr int kResamples = 400;
constexpr std::uint64_t kResampleSeed = 1;

// A result at one base point: A, B, and A with one value of B for each parameter.
using BasePoint = std::vector<double>;

std::vector<BasePoint> whole_points(const std::vector<double>& values, std::size_t tasks_each) {
  std::vector<BasePoint> points;
  for (std::size_t begin = 0; begin + tasks_each <= values.size(); begin += tasks_each) {
    BasePoint point(values.begin() + static_cast<std::ptrdiff_t>(begin),
                    values.begin() + static_cast<std::ptrdiff_t>(begin + tasks_each));
    if (std::all_of(point.begin(), point.end(), [](double value) { return std::isfinite(value); }))
      points.push_back(std::move(point));
  }
  return points;
}

// First, then total indices; empty where nothing varies. `chosen` holds places of points, some more than once.
std::vector<double> indices(const std::vector<BasePoint>& points, const std::vector<std::size_t>& chosen) {
  const double count = static_cast<double>(chosen.size());
  double mean = 0.0, variance = 0.0;
  for (const std::size_t i : chosen) mean += (points[i][0] + points[i][1]) / (2.0 * count);
  for (const std::size_t i : chosen)
    variance += (std::pow(points[i][0] - mean, 2) + std::pow(points[i][1] - mean, 2)) / (2.0 * count);
  if (variance <= 1.0e-24 * mean * mean) return {};
  const std::size_t parameters = points[0].size() - 2;
  std::vector<double> found(2 * parameters, 0.0);
  for (const std::size_t i : chosen)
    for (std::size_t p = 0; p < parameters; ++p) {
      const double step = points[i][2 + p] - points[i][0];
      found[p] += (points[i][1] - mean) * step / (count * variance);
      found[parameters + p] += step * step / (2.0 * count * variance);
    }
  return found;
}

std::vector<std::vector<double>> resampled(const std::vector<BasePoint>& points) {
  std::mt19937_64 random(kResampleSeed);
  std::vector<std::vector<double>> all;
  std::vector<std::size_t> chosen(points.size());
  for (int i = 0; i < kResamples; ++i) {
    for (std::size_t& place : chosen) place = random() % points.size();
    if (auto found = indices(points, chosen); !found.empty()) all.push_back(std::move(found));
  }
  return all;
}

SobolIndex with_interval(double value, const std::vector<std::vector<double>>& samples, std::size_t place) {
  std::vector<double> values;
  for (const std::vector<double>& sample : samples) values.push_back(sample[place]);
  return values.empty() ? SobolIndex{value, value, value}
                        : SobolIndex{value, quantile(values, 0.025), quantile(values, 0.975)};
}

}  // namespace

std::optional<SobolIndices> sobol_indices(const ResultsTable& table, std::size_t result) {
  const std::size_t parameters = table.parameters.size();
  const std::vector<BasePoint> points = whole_points(table.numbers(result), parameters + 2);
  if (points.size() < 2) return std::nullopt;
  std::vector<std::size_t> all(points.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<double> found = indices(points, all);
  if (found.empty()) return std::nullopt;
  const std::vector<std::vector<double>> samples = resampled(points);
  SobolIndices answer{table.results[result], points.size(), {}, {}};
  for (std::size_t p = 0; p < parameters; ++p) {
    answer.first.push_back(with_interval(found[p], samples, p));
    answer.total.push_back(with_interval(found[parameters + p], samples, parameters + p));
  }
  return answer;
}

Table sobol_table(const ResultsTable& table, const std::vector<std::size_t>& results) {
  Table all{
      {{"result"}, {"parameter"}, {"alone"}, {"from"}, {"to"}, {"with others"}, {"from"}, {"to"}, {"base points"}}, {}};
  for (const std::size_t result : results)
    if (const auto found = sobol_indices(table, result))
      for (std::size_t p = 0; p < table.parameters.size(); ++p)
        all.rows.push_back({found->result, table.parameters[p], found->first[p].value, found->first[p].low,
                            found->first[p].high, found->total[p].value, found->total[p].low, found->total[p].high,
                            static_cast<double>(found->base_points)});
  return all;
}

}  // namespace soft_robot_lab
