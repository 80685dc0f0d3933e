// SPDX-License-Identifier: BSD-3-Clause
#include "assignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The row of each column for a finite matrix with at least as many columns as rows; -1 where free. Row by row, the
// shortest path of exchanges from the new row to a free column, with dual prices that keep reduced costs >= 0.
std::vector<int> rows_of_columns(const Eigen::MatrixXd& costs) {
  const int rows = static_cast<int>(costs.rows()), columns = static_cast<int>(costs.cols());
  // One column more, the last, holds the row that seeks a place.
  std::vector<int> row_of(columns + 1, -1), way(columns + 1, columns);
  std::vector<double> row_price(rows, 0), column_price(columns + 1, 0);
  for (int row = 0; row < rows; ++row) {
    std::vector<double> distance(columns + 1, kInfinity);
    std::vector<bool> done(columns + 1, false);
    int at = columns;
    row_of[at] = row;
    while (row_of[at] >= 0) {
      done[at] = true;
      const int from = row_of[at];
      int next = columns;
      double step = kInfinity;
      for (int j = 0; j < columns; ++j) {
        if (done[j]) continue;
        const double reduced = costs(from, j) - row_price[from] - column_price[j];
        if (reduced < distance[j]) {
          distance[j] = reduced;
          way[j] = at;
        }
        if (distance[j] < step) {
          step = distance[j];
          next = j;
        }
      }
      for (int j = 0; j <= columns; ++j) {
        if (done[j]) {
          row_price[row_of[j]] += step;
          column_price[j] -= step;
        } else {
          distance[j] -= step;
        }
      }
      at = next;
    }
    for (; at != columns; at = way[at]) row_of[at] = row_of[way[at]];
    row_of[columns] = -1;
  }
  row_of.pop_back();
  return row_of;
}

}  // namespace

std::vector<int> assign(const Eigen::MatrixXd& costs, double cost_of_none) {
  if (costs.hasNaN() || std::isnan(cost_of_none)) throw std::invalid_argument("assign: a cost is not a number");
  const Eigen::Index rows = costs.rows(), columns = costs.cols();
  std::vector<int> column_of(rows, -1);
  if (rows == 0 || columns == 0) return column_of;
  // Each row has a column of its own for none, so that every row finds a place.
  Eigen::MatrixXd square = Eigen::MatrixXd::Constant(rows, columns + rows, cost_of_none);
  square.leftCols(columns) = costs.cwiseMin(cost_of_none + 1);
  const std::vector<int> row_of = rows_of_columns(square);
  for (Eigen::Index j = 0; j < columns; ++j)
    if (row_of[j] >= 0 && costs(row_of[j], j) < cost_of_none) column_of[row_of[j]] = static_cast<int>(j);
  return column_of;
}

}  // namespace soft_robot_lab
