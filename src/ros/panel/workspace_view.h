// SPDX-License-Identifier: BSD-3-Clause
// The panel's tab of reachable tips: has them searched for, shows what was found, and hands on the tip that is clicked
// at, or chosen by its number.
#pragma once

#include <functional>
#include <vector>

#include <QComboBox>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>
#include <QWidget>

#include <Eigen/Geometry>

#include "reachable_tips.h"
#include "workspace_search.h"

class QwtPlot;
class QwtPlotRescaler;

namespace soft_robot_lab {

class WorkspaceView : public QWidget {
  Q_OBJECT
 public:
  using Shown = std::function<void(const ReachableTips&, const TipQuantity& coloured_by)>;

  // `shown` is called with all tips, also with none; `chosen` with one of them.
  WorkspaceView(Shown shown, std::function<void(const ReachableTip&)> chosen, QWidget* parent);

  // What a search would be about. Of another robot or marker nothing is shown that was found before.
  void set_steps(int steps) { search_.set_steps(steps); }  // as of the search
  int steps() const { return search_.steps(); }

  void follow(const QString& scene, const QString& marker, int actuators);

 private:
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
  QString wanted_colour_;
  ReachableTips tips_;
  std::vector<TipQuantity> quantities_;
  QPushButton* find_;
  QComboBox *view_, *colour_;
  QSpinBox* number_;
  QLabel* state_;
  QwtPlot* plot_;
  QwtPlotRescaler* rescaler_ = nullptr;
  WorkspaceSearch search_;
};

}  // namespace soft_robot_lab
