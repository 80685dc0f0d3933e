// SPDX-License-Identifier: BSD-3-Clause
// The panel's plot of the last seconds: one quantity.
#pragma once

#include <map>
#include <string>

#include <QComboBox>
#include <QWidget>

#include "history.h"

class QwtPlot;
class QwtPlotCurve;

namespace soft_robot_lab {

class PlotView : public QWidget {
 public:
  explicit PlotView(QWidget* parent);

  void show_history(const History& history);

  // What chooses the quantity, for a place above the plot.
  QWidget* title() { return title_; }

 private:
  void offer(const History& history);
  QwtPlotCurve* curve(const std::string& name);

  QComboBox* title_;
  QwtPlot* plot_;
  std::map<std::string, QwtPlotCurve*> curves_;  // owned by the plot
  QString wanted_;                               // what was chosen, though there may be nothing of it yet
  std::string shown_;                            // the title that these belong to
};

}  // namespace soft_robot_lab
