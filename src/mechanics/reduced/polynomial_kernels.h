// SPDX-License-Identifier: BSD-3-Clause
// The arithmetic of cubic polynomials whose coefficients stand in the order of VolumePolynomials.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "mechanics/linear_algebra/batches.h"

namespace soft_robot_lab {

// Polynomials are gone through in blocks of batches, which stay in the nearest cache: batches for `numbers`, in whole
// blocks.
constexpr std::size_t kBlock = 8;
constexpr std::size_t blocks_for(std::size_t numbers) {
  return (numbers + kLanes * kBlock - 1) / (kLanes * kBlock) * kBlock;
}

void fill_monomials(const double* q, Eigen::Index modes, double* monomials);

// `sum` += the polynomials' coefficients, each times its scale.
void add_polynomials(const Batch* coefficients, std::size_t row, Eigen::Index count, const double* scales, Batch* sum);

// The same, and the value of each polynomial, in one pass.
void evaluate_polynomials(const Batch* coefficients, std::size_t row, Eigen::Index count, const Batch* monomials,
                          const double* scales, double* values, Batch* sum);

struct CubicAt {
  const double* coefficients;
  const double* monomials;
  const double* q;
  Eigen::Index modes;
};

// Fills the gradient, and `slopes`, per pair the polynomial's derivative by it where the triple's first factor stays.
void polynomial_gradient(const CubicAt& polynomial, double* slopes, double* gradient);

// Adds what gives the Hessian once its transpose is added: modes x modes.
void add_polynomial_hessian(const CubicAt& polynomial, const double* slopes, double* half);

}  // namespace soft_robot_lab
