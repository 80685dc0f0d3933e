// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLabel>
#include <QString>

namespace soft_robot_lab {

// The last line of the panel.
class StatusLine {
 public:
  QLabel* make_label(QWidget* parent);  // once, before all else
  void show_success(const QString& text);
  void show_failure(const QString& text);  // in red

 private:
  QLabel* label_ = nullptr;
};

}  // namespace soft_robot_lab
