// SPDX-License-Identifier: BSD-3-Clause
// The long functions of Eigen's decompositions, compiled once for all parts, in dense_kernels.cpp, and not in every
// batch that uses one. A part of the precompiled header: no file includes it, and without it each compiles its own.
#pragma once

#include <Eigen/Dense>

#ifndef SOFT_ROBOT_LAB_DENSE
#define SOFT_ROBOT_LAB_DENSE extern template
#endif

namespace Eigen {

SOFT_ROBOT_LAB_DENSE void ColPivHouseholderQR<MatrixXd>::computeInPlace();
SOFT_ROBOT_LAB_DENSE void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;

SOFT_ROBOT_LAB_DENSE void PartialPivLU<MatrixXd>::compute();

SOFT_ROBOT_LAB_DENSE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
SOFT_ROBOT_LAB_DENSE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);

SOFT_ROBOT_LAB_DENSE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
SOFT_ROBOT_LAB_DENSE SelfAdjointEigenSolver<Matrix3d>& SelfAdjointEigenSolver<Matrix3d>::compute(
    const EigenBase<Matrix3d>&, int);

}  // namespace Eigen
