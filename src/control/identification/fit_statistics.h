// SPDX-License-Identifier: BSD-3-Clause
// How sure a fit is, and what its data cannot identify.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include <ceres/crs_matrix.h>

#include "fit_parameters.h"

namespace soft_robot_lab {

constexpr double kOf95Percent = 1.96;  // standard deviations
constexpr double kUnidentified = 0.5;  // share of the variance that the bounds alone would leave

// Of each number what the bounds alone would leave of it: standard deviation of the normal distribution whose 95 % they
// hold.
Eigen::VectorXd bound_widths(const std::vector<FitNumber>& numbers);

// Of residuals in standard deviations, which so many unknowns were fitted to; at least the one expected.
double residual_variance(const std::vector<double>& residuals, Eigen::Index unknowns);

// Where a pose's marker is, as measured, by a model.
using MarkerPlace = std::function<Eigen::Vector3d(std::size_t pose, Eigen::Index marker)>;
ModelGap gap_of(const std::vector<MeasuredPose>& poses, const MarkerPlace& modelled);
std::vector<double> pose_gaps_m(const std::vector<MeasuredPose>& poses,
                                const MarkerPlace& modelled);  // 0 without markers

Eigen::MatrixXd dense(const ceres::CRSMatrix& matrix);

// Fills values, correlations and warnings. Jacobian and residuals at the solution, in standard deviations per `size` of
// a number. `unseen` is what the residuals may be wrong by, all together, beside their noise; empty for nothing. It
// widens the deviations by what it would move the values.
void add_statistics(const FitParameters& parameters, const Eigen::VectorXd& values, const Eigen::MatrixXd& jacobian,
                    const std::vector<double>& residuals, const Eigen::VectorXd& unseen, FitResult& result);

// By how much the poses' markers, in their order, would still move after their holds, if they go on to slow down as
// late in these; 0 of those that were seen too seldom.
Eigen::Matrix3Xd still_to_come_m(const std::vector<MeasuredPose>& poses);

// Names of values that the data do not identify.
std::set<std::string> unidentified(const FitResult& result);

// Says so where markers still move while commands are held, and creep is not fitted: a rest then counts creep as
// stiffness.
void warn_of_creep(const std::vector<MeasuredPose>& poses, const FitRequest& request, FitResult& result);

// Fills configurations, and warns of those that lie far beyond the others and of holds that are left out. Gaps [m] are
// one for each pose.
void add_configurations(const std::vector<MeasuredPose>& poses, const std::vector<double>& before_m,
                        const std::vector<double>& after_m, const FitRequest& request, FitResult& result);

// Appends values that a separate fit found, with the information that it has of their logarithms. The bounds count as
// weak knowledge of these.
void add_by_logarithms(const std::vector<FitNumber>& numbers, const Eigen::VectorXd& values,
                       const Eigen::MatrixXd& information, FitResult& result);

}  // namespace soft_robot_lab
