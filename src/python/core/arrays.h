// SPDX-License-Identifier: BSD-3-Clause
// Numbers and readings as Python has them: NumPy arrays and dictionaries.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "soft_robot_lab/mechanics/actuator.h"
#include "soft_robot_lab/mechanics/model.h"
#include "soft_robot_lab/mechanics/obstacle.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

pybind11::array_t<double> points_array(const Eigen::Matrix3Xd& columns);  // n x 3, a copy
pybind11::array_t<double> matrix_array(const Eigen::MatrixXd& matrix);    // of the same shape, a copy
pybind11::array_t<double> numbers_array(const std::vector<double>& numbers);

// Read-only, without a copy; `owner` is kept as long as the array is.
template <class Number>
pybind11::array_t<Number> array_view(const std::vector<pybind11::ssize_t>& shape, const Number* data,
                                     const pybind11::handle& owner) {
  pybind11::array_t<Number> view(shape, data, owner);
  pybind11::detail::array_proxy(view.ptr())->flags &= ~pybind11::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

// Finite numbers of this shape. Throws std::invalid_argument naming `what`.
Eigen::MatrixXd matrix_of(const pybind11::handle& array, Eigen::Index rows, Eigen::Index columns,
                          const std::string& what);
std::vector<double> numbers_of(const pybind11::handle& array, std::size_t count, const std::string& what);

// With the keys of result.json; what does not apply to an actuator is left out.
pybind11::dict reading_dict(const ActuatorReading& reading);
pybind11::dict readings_dict(const std::vector<ActuatorReading>& readings);  // by actuator
pybind11::list contacts_list(const std::vector<ContactReading>& contacts);   // of those that push
pybind11::dict contact_dict(const ContactReading& reading);
pybind11::list actuator_names(const Model& model);
pybind11::list marker_names(const Model& model);
pybind11::dict command_limits(const Model& model);  // of each actuator (rest, min, max, unit)
pybind11::list warning_list(const std::vector<SolveWarning>& warnings);

}  // namespace soft_robot_lab
