// SPDX-License-Identifier: BSD-3-Clause
// The panel in rviz that moves the robot. A thin window over PanelLink; twenty times a second it shows what changed.
#pragma once

#include <memory>
#include <string>

#include <QLabel>
#include <QTimer>
#include <rviz/panel.h>

#include "actuator_list.h"
#include "button_box.h"
#include "left_out_of_picks.h"
#include "panel_context.h"
#include "pose_box.h"
#include "scene_chooser.h"
#include "target_box.h"
#include "turn_watch.h"
#include "view_tabs.h"

namespace soft_robot_lab {

class SessionPanel : public rviz::Panel {
  Q_OBJECT
 public:
  explicit SessionPanel(QWidget* parent = nullptr);

  void onInitialize() override;
  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;
  bool eventFilter(QObject* window, QEvent* event) override;

 private:
  void connect_to(const QString& session);
  void refresh();
  void end();
  void watch_turns();
  void refresh_view();
  void refresh_lamps();
  void report(const CallOutcome& outcome);

  QString session_;  // namespace; empty: that of rviz
  PanelContext panel_;
  std::unique_ptr<LeftOutOfPicks> left_out_;
  std::string framed_;  // the scene that the camera was set to
  QTimer timer_;
  TurnWatch turns_;
  double diagnosed_s_ = 0.0;  // when the window was
  QLabel* lamps_;
  SceneChooser* chooser_;
  ActuatorList* actuators_;
  TargetBox* target_;
  ButtonBox* buttons_;
  PoseBox* poses_;
  ViewTabs* views_;
};

}  // namespace soft_robot_lab
