// SPDX-License-Identifier: BSD-3-Clause
// The panel in rviz that moves the robot. A thin window over PanelLink; twenty times a second it shows what changed.
#pragma once

#include <memory>
#include <vector>

#include <QComboBox>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QTabWidget>
#include <QTimer>
#include <QVBoxLayout>
#include <rviz/panel.h>

#include "actuator_editor.h"
#include "left_out_of_picks.h"
#include "number_box.h"
#include "panel_link.h"
#include "plot_view.h"
#include "poses.h"
#include "workspace_view.h"

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
  QWidget* make_chooser();
  QWidget* make_actuators();
  QWidget* make_target();
  QWidget* make_buttons();
  QWidget* make_poses();
  QWidget* make_views();
  QPushButton* button(const QString& text, const QString& hint, const std::function<void()>& press);
  void connect_to(const QString& session);
  void refresh();
  void end();
  void refresh_lamps();
  void watch_turns();
  void refresh_rows();
  void show_whole_rows();
  void refresh_scene();
  void refresh_solver();
  void refresh_view();
  void refresh_plot();
  void refresh_workspace();
  void refresh_target();
  void write_target();
  void show_target();
  Eigen::Vector3d target_m() const;
  void refresh_buttons();
  void read_poses();
  void refresh_poses();
  bool change_poses(const std::function<void()>& change);
  void report(const CallOutcome& outcome);
  void report_success(const QString& text);
  void report_failure(const QString& text);
  void optimise();
  void choose_scene(int index);
  void store_pose();
  void forget_pose();
  void save_pose();
  void play_pose();
  void calibrate();
  void reach(const ReachableTip& tip);

  QString session_;  // namespace; empty: that of rviz
  std::unique_ptr<PanelLink> link_;
  std::unique_ptr<LeftOutOfPicks> left_out_;
  Poses poses_;
  QString posed_;       // the scene whose poses are offered
  std::string framed_;  // the scene that the camera was set to
  int shown_revision_ = -1, shown_targets_ = -1;
  int target_of_ = -1;       // of which robot the numbers are
  bool with_balls_ = false;  // which step of a calibration comes next

  QTimer timer_;
  TurnWatch turns_;
  double diagnosed_s_ = 0.0;  // when the window was
  QLabel *lamps_ = nullptr, *message_ = nullptr, *empty_ = nullptr;
  QScrollArea* area_ = nullptr;
  QVBoxLayout* rows_ = nullptr;
  std::vector<ActuatorEditor*> editors_;
  PlotView* plot_ = nullptr;
  WorkspaceView* workspace_ = nullptr;
  std::optional<Eigen::Vector3d> wanted_;  // a tip that was chosen while something else is under way
  int undrawn_ = 0;                        // refreshes since the plot was drawn
  QComboBox* solver_ = nullptr;
  QProgressBar* training_ = nullptr;
  QComboBox *scene_ = nullptr, *marker_ = nullptr, *method_ = nullptr, *pose_ = nullptr;
  NumberBox* target_mm_[3] = {};
  QPushButton *optimise_ = nullptr, *execute_ = nullptr, *stop_ = nullptr, *reset_ = nullptr;
  QPushButton *zero_ = nullptr, *clear_ = nullptr, *calibrate_ = nullptr, *record_ = nullptr;
  QPushButton *store_ = nullptr, *play_ = nullptr, *save_ = nullptr, *forget_ = nullptr;
};

}  // namespace soft_robot_lab
