// SPDX-License-Identifier: BSD-3-Clause
#include "view_tabs.h"

namespace soft_robot_lab {

ViewTabs::ViewTabs(PanelContext& panel, QWidget* parent)
    : QTabWidget(parent), panel_(panel), plot_(new PlotView(this)) {
  workspace_ = new WorkspaceView(
      [this](const ReachableTips& tips, const TipQuantity& coloured_by) {
        if (panel_.link) panel_.link->show_tips(tips, coloured_by);
      },
      [this](const ReachableTip& tip) { wanted_ = tip.position_m; }, this);
  addTab(plot_, "P&lot");
  addTab(workspace_, "&Workspace");
  QWidget* title = plot_->title();
  setCornerWidget(title);
  connect(this, &QTabWidget::currentChanged, title, [=] { title->setVisible(currentWidget() == plot_); });
}

void ViewTabs::refresh(const QString& marker, int since_ms) {
  panel_.link->state().plot(marker.toStdString());
  refresh_plot(since_ms);
  refresh_workspace(marker);
}

// Ten times a second is enough for an eye.
void ViewTabs::refresh_plot(int since_ms) {
  undrawn_ms_ += since_ms;
  if (undrawn_ms_ < 100) return;
  undrawn_ms_ = 0;
  plot_->show_history(panel_.link->state().history());
}

// Of tips that are chosen fast one after the other the last counts.
void ViewTabs::refresh_workspace(const QString& marker) {
  const SessionState& state = panel_.link->state();
  if (state.scene() != scene_) wanted_.reset();
  scene_ = state.scene();
  workspace_->follow(QString::fromStdString(scene_), marker, static_cast<int>(state.values().rows().size()));
  if (!wanted_ || panel_.link->busy()) return;
  panel_.link->optimise("gauss_newton", marker.toStdString(), *wanted_);
  wanted_.reset();
}

}  // namespace soft_robot_lab
