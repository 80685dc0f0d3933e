// SPDX-License-Identifier: BSD-3-Clause
// What a session is asked for by one press.
#pragma once

#include <QPushButton>
#include <QWidget>

#include "panel_context.h"
#include "target_box.h"

namespace soft_robot_lab {

class ButtonBox : public QWidget {
 public:
  ButtonBox(PanelContext& panel, TargetBox& target, QWidget* parent);

  void refresh();
  void show_calibrated();  // a step of a calibration succeeded

 private:
  PanelContext& panel_;
  TargetBox& target_;
  QPushButton *optimise_, *execute_, *stop_, *reset_, *record_, *zero_, *clear_, *calibrate_;
  bool with_balls_ = false;  // which step of a calibration comes next
};

}  // namespace soft_robot_lab
