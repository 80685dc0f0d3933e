// SPDX-License-Identifier: BSD-3-Clause
// The panel's tab of reachable tips: starts the program `workspace` beside the window, shows what it found, and hands
// on the tip that is clicked at, or chosen by its number.
#pragma once

#include <functional>
#include <optional>

#include <QComboBox>
#include <QDateTime>
#include <QLabel>
#include <QProcess>
#include <QPushButton>
#include <QSpinBox>
#include <QWidget>

#include <Eigen/Geometry>

#include "reachable_tips.h"

class QwtPlot;
class QwtPlotRescaler;

namespace soft_robot_lab {

class WorkspaceView : public QWidget {
  Q_OBJECT
 public:
  using Shown = std::function<void(const ReachableTips&, const TipQuantity& coloured_by)>;

  // `shown` is called with all tips, also with none; `chosen` with one of them.
  WorkspaceView(Shown shown, std::function<void(const ReachableTip&)> chosen, QWidget* parent);
  ~WorkspaceView() override;

  // What a search would be about. Of another robot or marker nothing is shown that was found before.
  void set_steps(int steps) { steps_ = steps; }  // of each command of robots with two actuators
  int steps() const { return steps_; }

  void follow(const QString& scene, const QString& marker, int actuators);

 private:
  void toggle();
  void start();
  void read_progress();
  void load_what_came();
  void finish(int status);
  void load();
  void take(ReachableTips tips);
  void recolour();
  void show_tips();
  void frame(const std::vector<Eigen::Vector2d>& places);  // so that all are seen
  void choose(int number);
  void choose_nearest(const QPointF& place_mm);
  Eigen::Vector2d seen_mm(const ReachableTip& tip) const;  // in the view that is chosen
  const TipQuantity& coloured_by() const;

  Shown shown_;
  std::function<void(const ReachableTip&)> chosen_;
  QString scene_, marker_, wanted_colour_;
  int actuators_ = 0, steps_ = 21;
  QString folder_, log_;        // of the search; its last line
  QDateTime started_, loaded_;  // the search; when that was written which is shown
  ReachableTips tips_;
  std::vector<TipQuantity> quantities_;
  QProcess process_;
  QPushButton* find_;
  QComboBox *view_, *colour_;
  QSpinBox* number_;
  QLabel* state_;
  bool outdated_ = false;  // what runs was asked for before another robot or marker came
  QwtPlot* plot_;
  QwtPlotRescaler* rescaler_ = nullptr;
};

}  // namespace soft_robot_lab
