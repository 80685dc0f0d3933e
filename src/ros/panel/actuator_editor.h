// SPDX-License-Identifier: BSD-3-Clause
// One actuator in the panel: name, slider with its limits, typed number, what is measured, and back to rest.
#pragma once

#include <functional>

#include <QLabel>
#include <QWidget>

#include "actuator_values.h"
#include "number_box.h"
#include "rest_slider.h"

namespace soft_robot_lab {

class ActuatorEditor : public QWidget {
 public:
  using Edit = std::function<void(double value)>;

  // `number` from 1; up to 9 it is the key that, with Alt, leads to the slider.
  ActuatorEditor(const ActuatorRow& row, int number, const Edit& edit, QWidget* parent);

  void show_row(const ActuatorRow& row);  // sends nothing

 private:
  void lay_out(const ActuatorRow& row, int number, const Edit& edit);

  RestSlider* slider_;
  NumberBox* number_;
  QLabel* measured_;
};

}  // namespace soft_robot_lab
