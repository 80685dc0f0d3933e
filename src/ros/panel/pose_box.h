// SPDX-License-Identifier: BSD-3-Clause
// Poses of the robot that runs, kept in the user's folder.
#pragma once

#include <functional>

#include <QComboBox>
#include <QPushButton>
#include <QString>
#include <QWidget>

#include "panel_context.h"
#include "poses.h"

namespace soft_robot_lab {

class PoseBox : public QWidget {
 public:
  PoseBox(PanelContext& panel, QWidget* parent);

  void refresh();

 private:
  void read();
  void show_names();
  bool change(const std::function<void()>& change);
  void store();
  void forget();
  void save();
  void play();
  std::string name() const { return pose_->currentText().toStdString(); }

  PanelContext& panel_;
  Poses poses_;
  QString scene_;  // whose poses are offered
  QComboBox* pose_;
  QPushButton *store_, *play_, *save_, *forget_;
};

}  // namespace soft_robot_lab
