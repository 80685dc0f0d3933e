// SPDX-License-Identifier: BSD-3-Clause
#include "point_matching.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr Eigen::Index max_points = 16;

// Tries the first points one after the other with every second point, or none.
class MatchSearch {
 public:
  MatchSearch(const Eigen::Matrix3Xd& first_m, const Eigen::Matrix3Xd& second_m, double tolerance_m)
      : first_m_(first_m), second_m_(second_m), tolerance_m_(tolerance_m) {}

  PointMatching run(int match_count) {
    match_count_ = match_count;
    extend(0);
    return found_;
  }

 private:
  void extend(int next) {
    const int missing = match_count_ - static_cast<int>(matches_.size());
    if (!found_.rival.empty() || first_m_.cols() - next < missing) return;
    if (missing == 0) return complete();
    for (int second = 0; second < second_m_.cols(); ++second) {
      if (!fits({next, second})) continue;
      matches_.push_back({next, second});
      extend(next + 1);
      matches_.pop_back();
    }
    extend(next + 1);
  }

  bool fits(const PointMatch& match) const {
    return std::all_of(matches_.begin(), matches_.end(), [&](const PointMatch& other) {
      const double first_m = (first_m_.col(match.first) - first_m_.col(other.first)).norm();
      const double second_m = (second_m_.col(match.second) - second_m_.col(other.second)).norm();
      return match.second != other.second && std::abs(first_m - second_m) <= 2 * tolerance_m_;
    });
  }

  double rigid_miss_m() const {
    Eigen::Matrix3Xd first_m(3, match_count_), second_m(3, match_count_);
    for (int i = 0; i < match_count_; ++i) {
      first_m.col(i) = first_m_.col(matches_[static_cast<std::size_t>(i)].first);
      second_m.col(i) = second_m_.col(matches_[static_cast<std::size_t>(i)].second);
    }
    Eigen::Isometry3d motion;
    motion.matrix() = Eigen::umeyama(second_m, first_m, false);
    return (first_m - motion * second_m).colwise().norm().maxCoeff();
  }

  // Two matchings that leave out other points but agree on the rest say the same.
  bool contradicts(const std::vector<PointMatch>& other) const {
    return std::any_of(matches_.begin(), matches_.end(), [&](const PointMatch& match) {
      return std::any_of(other.begin(), other.end(), [&](const PointMatch& its) {
        return (match.first == its.first) != (match.second == its.second);
      });
    });
  }

  void complete() {
    const double miss_m = rigid_miss_m();
    if (miss_m > tolerance_m_) return;
    if (found_.best.empty() || (!contradicts(found_.best) && miss_m < best_miss_m_)) {
      found_.best = matches_;
      best_miss_m_ = miss_m;
    } else if (contradicts(found_.best)) {
      found_.rival = matches_;
    }
  }

  const Eigen::Matrix3Xd& first_m_;
  const Eigen::Matrix3Xd& second_m_;
  double tolerance_m_;
  int match_count_ = 0;
  std::vector<PointMatch> matches_;
  PointMatching found_;
  double best_miss_m_ = 0;
};

}  // namespace

PointMatching match_points(const Eigen::Matrix3Xd& first_m, const Eigen::Matrix3Xd& second_m, double tolerance_m,
                           int min_matches) {
  const Eigen::Index most = std::max(first_m.cols(), second_m.cols());
  if (most > max_points)
    throw std::invalid_argument(std::to_string(most) + " points are to be matched; allowed: up to " +
                                std::to_string(max_points));
  if (min_matches < 3) throw std::invalid_argument("min_matches is below 3, which no rigid motion can do with");
  if (!(tolerance_m > 0)) throw std::invalid_argument("tolerance_m must be > 0");
  for (int count = static_cast<int>(std::min(first_m.cols(), second_m.cols())); count >= min_matches; --count) {
    PointMatching matching = MatchSearch(first_m, second_m, tolerance_m).run(count);
    if (!matching.best.empty()) return matching;
  }
  return {};
}

}  // namespace soft_robot_lab
