// SPDX-License-Identifier: BSD-3-Clause
// Batches that lie anywhere in memory. By value alone: Clang takes what a reference names to lie at a multiple of its
// size.
#pragma once

#include "batches.h"

namespace soft_robot_lab {

typedef double LooseBatch __attribute__((vector_size(kLanes * sizeof(double)), aligned(sizeof(double)), may_alias));

inline LooseBatch load(const double* from) { return *reinterpret_cast<const LooseBatch*>(from); }
inline void store(LooseBatch batch, double* to) { *reinterpret_cast<LooseBatch*>(to) = batch; }
inline double sum_of_lanes(LooseBatch b) { return (b[0] + b[1]) + (b[2] + b[3]); }

}  // namespace soft_robot_lab
