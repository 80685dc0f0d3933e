// SPDX-License-Identifier: BSD-3-Clause
// An object whose __init__ never ran, as Class.__new__(Class) gives, is refused. pybind11 would hand out memory that
// nothing has been written to.
#pragma once

#include <pybind11/pybind11.h>

namespace soft_robot_lab {

template <class Type>
class MadeCaster : public pybind11::detail::type_caster_base<Type> {
 public:
  bool load(pybind11::handle object, bool convert) {
    if (pybind11::isinstance<Type>(object) &&
        !reinterpret_cast<pybind11::detail::instance*>(object.ptr())->get_value_and_holder().holder_constructed())
      throw pybind11::type_error("an object whose __init__ was not called");
    return pybind11::detail::type_caster_base<Type>::load(object, convert);
  }
};

}  // namespace soft_robot_lab
