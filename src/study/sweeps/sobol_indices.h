// SPDX-License-Identifier: BSD-3-Clause
// How much of a result's variance each parameter causes, alone and with the others (Sobol 2001).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "results_table.h"
#include "session/report/table.h"

namespace soft_robot_lab {

struct SobolIndex {
  double value = 0.0;
  double low = 0.0, high = 0.0;  // of 95 % of resampled base points
};

struct SobolIndices {
  std::string result;
  std::size_t base_points = 0;    // of which all tasks have a number
  std::vector<SobolIndex> first;  // of each parameter: alone
  std::vector<SobolIndex> total;  // and with what it does together with others
};

// Of a study by method sobol_indices, whose tasks are, for each base point: A, B, and for each parameter A with the
// value of B. First order by Saltelli et al. 2010, table 2 (b), total by Jansen 1999. Nothing where the result does not
// vary, or fewer than two base points are whole.
std::optional<SobolIndices> sobol_indices(const ResultsTable& table, std::size_t result);

// A row a parameter of each of the results.
Table sobol_table(const ResultsTable& table, const std::vector<std::size_t>& results);

}  // namespace soft_robot_lab
