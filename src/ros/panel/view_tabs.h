// SPDX-License-Identifier: BSD-3-Clause
// Tabs of what is seen of a session over time, and of where its marker can go.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <QTabWidget>

#include "panel_context.h"
#include "plot_view.h"
#include "workspace_view.h"

namespace soft_robot_lab {

class ViewTabs : public QTabWidget {
 public:
  ViewTabs(PanelContext& panel, QWidget* parent);

  void refresh(const QString& marker, int since_ms);  // so long after the refresh before
  void set_steps(int steps) { workspace_->set_steps(steps); }
  int steps() const { return workspace_->steps(); }

 private:
  void refresh_plot(int since_ms);
  void refresh_workspace(const QString& marker);

  PanelContext& panel_;
  PlotView* plot_;
  WorkspaceView* workspace_;
  int undrawn_ms_ = 0;                     // since the plot was drawn
  std::string scene_;                      // of the tips
  std::optional<Eigen::Vector3d> wanted_;  // a tip that was chosen while something else is under way
};

}  // namespace soft_robot_lab
