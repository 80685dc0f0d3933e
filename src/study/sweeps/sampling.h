// SPDX-License-Identifier: BSD-3-Clause
// The points of a study: the same on every machine for the same seed.
#pragma once

#include <vector>

#include "study_file.h"

namespace soft_robot_lab {

// One row a task, one value a parameter. A grid's last parameter runs fastest. A Latin hypercube (McKay, Beckman and
// Conover 1979) has one point in each of `samples` equal slices of each parameter. Sobol's sequence has the directions
// of Joe and Kuo 2008 and is shifted digitally by the seed. Method sobol_indices has the points that sobol_indices.h
// needs. Throws std::invalid_argument for more than kMostTasks.
std::vector<std::vector<double>> sample(const StudySettings& study);

// A parameter's value at a fraction in [0, 1] of its range, its list or its distribution.
double value_at(const StudyParameter& parameter, double fraction);

}  // namespace soft_robot_lab
