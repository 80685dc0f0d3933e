// SPDX-License-Identifier: BSD-3-Clause
// A slider whose groove is filled from rest to where it stands: what is asked of an actuator, and to which side.
#pragma once

#include <QSlider>

namespace soft_robot_lab {

class RestSlider : public QSlider {
 public:
  explicit RestSlider(QWidget* parent) : QSlider(Qt::Horizontal, parent) {}

  void set_rest(int position) { rest_ = position; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  int rest_ = 0;
};

}  // namespace soft_robot_lab
