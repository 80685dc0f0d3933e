// SPDX-License-Identifier: BSD-3-Clause
#include "fit_statistics.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <sstream>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr double kPart = 0.3;       // of a unit direction: a parameter takes part in it
constexpr double kTogether = 0.95;  // correlation beyond which two parameters are identified together only
constexpr double kOnBound = 1e-6;   // of the range

std::string short_text(double value) {
  std::ostringstream text;
  text << std::setprecision(3) << value;
  return text.str();
}

std::string commands_text(const std::map<std::string, double>& commands) {
  std::string text;
  for (const auto& [name, value] : commands) text += (text.empty() ? "" : ", ") + name + " " + short_text(value);
  return text.empty() ? "rest" : text;
}

std::string configurations_text(const std::vector<FittedConfiguration>& configurations) {
  std::ostringstream text;
  text << std::setprecision(3) << (configurations.empty() ? "" : "gap by configuration, before and after\n");
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    const FittedConfiguration& one = configurations[i];
    text << "  " << i + 1 << " (" << commands_text(one.commands) << "): " << 1e3 * one.before_m << " mm, "
         << 1e3 * one.after_m << " mm" << (one.outlying ? ", far beyond the others" : "") << "\n";
  }
  return text.str();
}

// Directions, in shares of the bounds' widths, in which the data say less than the bounds.
void warn_of_blind_directions(const std::vector<FitNumber>& numbers, const Eigen::MatrixXd& information,
                              FitResult& result) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  for (Eigen::Index k = 0; k < information.cols() && eigen.eigenvalues()[k] < 1.0; ++k) {
    std::string names;
    int parts = 0;
    for (Eigen::Index i = 0; i < information.rows(); ++i) {
      if (std::abs(eigen.eigenvectors()(i, k)) < kPart) continue;
      names += (parts++ ? ", " : "") + numbers[static_cast<std::size_t>(i)].name;
    }
    result.warnings.push_back(parts == 1
                                  ? "the data cannot identify " + names
                                  : "the data cannot distinguish " + names + ": some combination of them stays open");
  }
}

void warn_of_pairs(const std::vector<FitNumber>& numbers, FitResult& result) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t j = i + 1; j < numbers.size(); ++j) {
      const double together = result.correlations(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      if (std::abs(together) < kTogether) continue;
      result.warnings.push_back(numbers[i].name + " and " + numbers[j].name +
                                " are identified together only (correlation " + short_text(together) +
                                "): changed together they fit nearly as well");
    }
  }
}

constexpr double kLate = 0.5;               // of a hold, from where drives and swings are over
constexpr double kLateInShort = 1.0 / 3.0;  // of one with few windows
constexpr int kParts = 4;                   // of what is late
constexpr double kCreeps = 0.5;             // times what the model may miss
constexpr double kSurely = 3.0;             // standard errors
constexpr double kMostKept = 0.95;          // of a drift, from part to part: beyond it creep looks steady
constexpr int kMany = 20;                   // drifts

// Mean places of a marker in the late parts of a hold, and their variances.
struct LatePlaces {
  Eigen::Vector3d sums_m[kParts];
  double variances_m2[kParts] = {};  // of the sums
  int counts[kParts] = {};

  LatePlaces(const MeasuredPose& pose, const std::string& name, double from) {
    for (Eigen::Vector3d& sum_m : sums_m) sum_m.setZero();
    if (!(pose.held_s > 0.0)) return;
    for (const MarkersAt& at : pose.seen) {
      const double late = (at.time_s / pose.held_s - from) / (1.0 - from);
      if (late < 0.0) continue;
      const int part = std::min(kParts - 1, static_cast<int>(kParts * late));
      for (const MeasuredMarker& marker : at.markers) {
        if (marker.name != name) continue;
        sums_m[part] += marker.position_m;
        variances_m2[part] += marker.covariance_m2.trace();
        ++counts[part];
      }
    }
  }
  bool whole() const { return std::find(std::begin(counts), std::end(counts), 0) == std::end(counts); }
  // From the middle of the last part on, if drifts fall to a share of `kept` from part to part.
  Eigen::Vector3d still_to_come_m(double kept) const {
    const Eigen::Vector3d first_m = (drift_m(0) + kept * drift_m(1)) / (1.0 + kept * kept);
    return kept * kept * kept / (1.0 - kept * kept) * first_m;
  }
  // To the next part but one.
  Eigen::Vector3d drift_m(int from) const { return sums_m[from + 2] / counts[from + 2] - sums_m[from] / counts[from]; }
  double drift_variance_m2(int from) const {
    return variances_m2[from] / (counts[from] * counts[from]) +
           variances_m2[from + 2] / (counts[from + 2] * counts[from + 2]);
  }
};

LatePlaces late_places(const MeasuredPose& pose, const std::string& name) {
  LatePlaces places(pose, name, kLate);
  return places.whole() ? places : LatePlaces(pose, name, kLateInShort);
}

// Drifts of all markers in all holds: from the first late part to the third, and from the second to the fourth. They
// share no measurement, so noise makes neither their cosine nor their product.
struct LateDrifts {
  int count = 0, unjudged_count = 0;
  double unjudged_s = 0.0;  // the longest hold that too little was seen of
  double cosines = 0.0;     // sums of all
  double products_m2 = 0.0, squared_products_m4 = 0.0;
  double first_m2 = 0.0;                   // squares of the first less their noise
  double firsts_m4 = 0.0, mixed_m4 = 0.0;  // of these with themselves, and with the products

  explicit LateDrifts(const std::vector<MeasuredPose>& poses) {
    for (const MeasuredPose& pose : poses)
      for (const MeasuredMarker& marker : pose.markers) {
        const LatePlaces places = late_places(pose, marker.name);
        if (places.whole())
          add(places);
        else if (pose.held_s > 0.0)
          add_unjudged(pose.held_s);
      }
  }

  void add_unjudged(double held_s) {
    unjudged_s = std::max(unjudged_s, held_s);
    ++unjudged_count;
  }

  void add(const LatePlaces& places) {
    const Eigen::Vector3d first_m = places.drift_m(0), second_m = places.drift_m(1);
    const double product_m2 = first_m.dot(second_m);
    ++count;
    cosines += first_m.normalized().dot(second_m.normalized());
    products_m2 += product_m2;
    squared_products_m4 += product_m2 * product_m2;
    const double square_m2 = first_m.squaredNorm() - places.drift_variance_m2(0);
    first_m2 += square_m2;
    firsts_m4 += square_m2 * square_m2;
    mixed_m4 += square_m2 * product_m2;
  }

  // By their directions, where a few holds drift far; by their sizes too, where many drift little. A cosine of noise
  // has a variance of a third.
  bool more_than_noise() const {
    return products_m2 > 0.0 && (cosines > kSurely * std::sqrt(count / 3.0) ||
                                 (count >= kMany && products_m2 > kSurely * std::sqrt(squared_products_m4)));
  }

  // Of a drift, from part to part; 0 where none is seen.
  double kept() const { return products_m2 > 0.0 ? products_m2 / std::max(first_m2, products_m2 / kMostKept) : 0.0; }

  // As large as it may be by how much markers and holds differ in it.
  double most_kept() const {
    const double mean = kept();
    const double scatter_m4 = squared_products_m4 - 2.0 * mean * mixed_m4 + mean * mean * firsts_m4;
    return mean > 0.0 ? std::min(kMostKept,
                                 mean + kOf95Percent * std::sqrt(std::max(0.0, scatter_m4)) / std::max(first_m2, 1e-30))
                      : 0.0;
  }

  // By how much markers still move after a hold, if they go on to slow down as in it [m].
  double still_to_come_m() const {
    if (!more_than_noise()) return 0.0;
    const double kept = this->kept();
    return std::sqrt(products_m2 / count) * std::pow(kept, 2.5) / (1.0 - kept * kept);
  }
};

}  // namespace

Eigen::VectorXd bound_widths(const std::vector<FitNumber>& numbers) {
  Eigen::VectorXd widths(static_cast<Eigen::Index>(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i)
    widths[static_cast<Eigen::Index>(i)] = (numbers[i].max - numbers[i].min) / (2.0 * kOf95Percent);
  return widths;
}

double residual_variance(const std::vector<double>& residuals, Eigen::Index unknowns) {
  const auto count = static_cast<Eigen::Index>(residuals.size());
  const double squares = Eigen::Map<const Eigen::VectorXd>(residuals.data(), count).squaredNorm();
  return std::max(1.0, squares / static_cast<double>(std::max<Eigen::Index>(1, count - unknowns)));
}

ModelGap gap_of(const std::vector<MeasuredPose>& poses, const MarkerPlace& modelled) {
  ModelGap gap;
  std::map<std::string, int> counts;
  int count = 0;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    for (std::size_t m = 0; m < poses[p].markers.size(); ++m) {
      const MeasuredMarker& marker = poses[p].markers[m];
      const double squared = (modelled(p, static_cast<Eigen::Index>(m)) - marker.position_m).squaredNorm();
      gap.rms_m += squared;
      gap.marker_rms_m[marker.name] += squared;
      ++counts[marker.name];
      ++count;
    }
  }
  gap.rms_m = std::sqrt(gap.rms_m / std::max(1, count));
  for (auto& [name, rms] : gap.marker_rms_m) rms = std::sqrt(rms / counts[name]);
  return gap;
}

std::vector<double> pose_gaps_m(const std::vector<MeasuredPose>& poses, const MarkerPlace& modelled) {
  std::vector<double> gaps_m;
  for (std::size_t p = 0; p < poses.size(); ++p)
    gaps_m.push_back(gap_of({poses[p]}, [&](std::size_t, Eigen::Index m) { return modelled(p, m); }).rms_m);
  return gaps_m;
}

Eigen::MatrixXd dense(const ceres::CRSMatrix& matrix) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(matrix.num_rows, matrix.num_cols);
  for (int row = 0; row < matrix.num_rows; ++row)
    for (int k = matrix.rows[static_cast<std::size_t>(row)]; k < matrix.rows[static_cast<std::size_t>(row) + 1]; ++k)
      all(row, matrix.cols[static_cast<std::size_t>(k)]) = matrix.values[static_cast<std::size_t>(k)];
  return all;
}

// The bounds count as a normal distribution whose 95 % they hold, so that every deviation is finite: where the data
// identify a parameter, this changes nothing that counts.
void add_statistics(const FitParameters& parameters, const Eigen::VectorXd& values, const Eigen::MatrixXd& jacobian,
                    const std::vector<double>& residuals, const Eigen::VectorXd& unseen, FitResult& result) {
  const std::vector<FitNumber>& numbers = parameters.numbers();
  const auto count = static_cast<Eigen::Index>(numbers.size());
  const Eigen::VectorXd widths = bound_widths(numbers);
  Eigen::VectorXd in_sizes(count);
  for (Eigen::Index i = 0; i < count; ++i) in_sizes[i] = widths[i] / numbers[static_cast<std::size_t>(i)].size;
  const double variance = residual_variance(residuals, count);
  const Eigen::MatrixXd scaled = jacobian * in_sizes.asDiagonal();
  const Eigen::MatrixXd information = scaled.transpose() * scaled / variance;
  const Eigen::MatrixXd covariance = (information + Eigen::MatrixXd::Identity(count, count)).inverse();
  const Eigen::VectorXd spread = covariance.diagonal().cwiseSqrt();
  Eigen::VectorXd variances = covariance.diagonal();
  if (unseen.size() > 0) variances += (covariance * (scaled.transpose() * unseen) / variance).cwiseAbs2();

  result.correlations = spread.cwiseInverse().asDiagonal() * covariance * spread.cwiseInverse().asDiagonal();
  for (Eigen::Index i = 0; i < count; ++i) {
    const FitNumber& number = numbers[static_cast<std::size_t>(i)];
    FittedValue fitted;
    fitted.name = number.name;
    fitted.start = number.start;
    fitted.value = values[i];
    fitted.min = number.min;
    fitted.max = number.max;
    fitted.deviation = std::sqrt(variances[i]) * widths[i];
    fitted.low = std::max(number.min, fitted.value - kOf95Percent * fitted.deviation);
    fitted.high = std::min(number.max, fitted.value + kOf95Percent * fitted.deviation);
    fitted.identifiable = covariance(i, i) < kUnidentified;
    const double range = number.max - number.min;
    const bool low = fitted.value - number.min < kOnBound * range, high = number.max - fitted.value < kOnBound * range;
    if (low || high)
      result.warnings.push_back(number.name + " ended on its bound " + short_text(fitted.value) +
                                "; something else may be wrong with the model, or the bound");
    result.values.push_back(std::move(fitted));
  }
  warn_of_blind_directions(numbers, information, result);
  warn_of_pairs(numbers, result);
}

Eigen::Matrix3Xd still_to_come_m(const std::vector<MeasuredPose>& poses) {
  const double kept = LateDrifts(poses).most_kept();
  Eigen::Index count = 0, at = 0;
  for (const MeasuredPose& pose : poses) count += static_cast<Eigen::Index>(pose.markers.size());
  Eigen::Matrix3Xd all_m = Eigen::Matrix3Xd::Zero(3, count);
  for (const MeasuredPose& pose : poses)
    for (const MeasuredMarker& marker : pose.markers) {
      const LatePlaces places = late_places(pose, marker.name);
      if (places.whole()) all_m.col(at) = places.still_to_come_m(kept);
      ++at;
    }
  return all_m;
}

std::set<std::string> unidentified(const FitResult& result) {
  std::set<std::string> names;
  for (const FittedValue& value : result.values)
    if (!value.identifiable) names.insert(value.name);
  return names;
}

void warn_of_creep(const std::vector<MeasuredPose>& poses, const FitRequest& request, FitResult& result) {
  const LateDrifts drifts(poses);
  const double still_m = drifts.still_to_come_m();
  const std::string remedy = "; hold longer, or fit creep";
  if (drifts.unjudged_count > drifts.count)
    result.warnings.push_back(
        "most commands were held for " + short_text(drifts.unjudged_s) +
        " s at most, and seen too seldom in it to say whether the robot creeps: intervals may exclude the truth" +
        remedy);
  if (still_m > kCreeps * request.model_error_m)
    result.warnings.push_back("by their drift late in the holds markers would still move by " +
                              short_text(1e3 * still_m) +
                              " mm or more: the robot creeps, and intervals are wider by that" + remedy);
}

// As far as `outlier_deviations` times the median of all is nothing special.
void add_configurations(const std::vector<MeasuredPose>& poses, const std::vector<double>& before_m,
                        const std::vector<double>& after_m, const FitRequest& request, FitResult& result) {
  std::vector<double> seen_m;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    if (!poses[p].left_out.empty())
      result.warnings.push_back("a hold of (" + commands_text(poses[p].commands) +
                                ") is left out: " + poses[p].left_out);
    if (poses[p].markers.empty()) continue;
    result.configurations.push_back({poses[p].commands, before_m[p], after_m[p], false});
    seen_m.push_back(after_m[p]);
  }
  const double usual_m = seen_m.empty() ? 0.0 : median(std::move(seen_m));
  const double far_m = request.outlier_deviations * std::max(usual_m, request.model_error_m);
  for (std::size_t i = 0; i < result.configurations.size(); ++i) {
    FittedConfiguration& one = result.configurations[i];
    one.outlying = one.after_m > far_m;
    if (one.outlying)
      result.warnings.push_back("configuration " + std::to_string(i + 1) + " (" + commands_text(one.commands) +
                                ") is missed by " + short_text(1e3 * one.after_m) + " mm, the median of all is " +
                                short_text(1e3 * usual_m) + " mm: look at what happened there, or leave it out");
  }
}

void add_by_logarithms(const std::vector<FitNumber>& numbers, const Eigen::VectorXd& values,
                       const Eigen::MatrixXd& information, FitResult& result) {
  const Eigen::Index count = values.size(), before = result.correlations.rows();
  Eigen::VectorXd widths(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const FitNumber& number = numbers[static_cast<std::size_t>(i)];
    widths[i] = std::log(number.max / number.min) / (2.0 * kOf95Percent);
  }
  const Eigen::MatrixXd known = widths.cwiseAbs2().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd covariance = (information + known).inverse();
  const Eigen::VectorXd spread = covariance.diagonal().cwiseSqrt();
  Eigen::MatrixXd correlations = Eigen::MatrixXd::Identity(before + count, before + count);
  correlations.topLeftCorner(before, before) = result.correlations;
  correlations.bottomRightCorner(count, count) =
      spread.cwiseInverse().asDiagonal() * covariance * spread.cwiseInverse().asDiagonal();
  result.correlations = correlations;
  for (Eigen::Index i = 0; i < count; ++i) {
    const FitNumber& number = numbers[static_cast<std::size_t>(i)];
    const double low = values[i] * std::exp(-kOf95Percent * spread[i]);
    const double high = values[i] * std::exp(kOf95Percent * spread[i]);
    result.values.push_back({number.name, number.start, values[i], spread[i] * values[i], std::max(number.min, low),
                             std::min(number.max, high), number.min, number.max,
                             covariance(i, i) < kUnidentified * widths[i] * widths[i]});
  }
}

std::string summary(const FitResult& result) {
  std::ostringstream text;
  for (const FittedValue& value : result.values)
    text << value.name << " = " << std::setprecision(5) << value.value << " +- " << std::setprecision(2)
         << value.deviation << std::setprecision(5) << " (95 %: " << value.low << " to " << value.high << "; was "
         << value.start << ")"
         << (value.identifiable ? "" : ", not identifiable from the data: left as the scene has it") << "\n";
  text << std::setprecision(3) << "rms gap " << 1e3 * result.before.rms_m << " mm before, " << 1e3 * result.after.rms_m
       << " mm after\n";
  for (const auto& [marker, rms_m] : result.before.marker_rms_m)
    text << "  " << marker << ": " << 1e3 * rms_m << " mm, " << 1e3 * result.after.marker_rms_m.at(marker) << " mm\n";
  text << configurations_text(result.configurations);
  if (result.swings > 0)
    text << result.swings << (result.swings == 1 ? " swing" : " swings") << " missed by " << 1e3 * result.swing_rms_m
         << " mm rms\n";
  for (const std::string& warning : result.warnings) text << "warning: " << warning << "\n";
  text << result.iterations << " iterations, " << result.cpu_s << " s of CPU time: " << result.message << "\n";
  return text.str();
}

}  // namespace soft_robot_lab
