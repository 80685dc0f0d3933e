// SPDX-License-Identifier: BSD-3-Clause
// Which robot is simulated, and by which solver.
#pragma once

#include <QComboBox>
#include <QProgressBar>
#include <QWidget>

#include "panel_context.h"

namespace soft_robot_lab {

class SceneChooser : public QWidget {
 public:
  SceneChooser(PanelContext& panel, QWidget* parent);

  void refresh();  // follows what runs

 private:
  void refresh_scene();
  void refresh_solver();
  void refresh_training();
  void choose_scene(int index);
  void choose_solver();

  PanelContext& panel_;
  QComboBox *scene_, *solver_;
  QProgressBar* training_;
};

}  // namespace soft_robot_lab
