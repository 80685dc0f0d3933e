// SPDX-License-Identifier: BSD-3-Clause
#include "actuator_list.h"

#include <algorithm>

#include "plain_text.h"
#include "ros/base/machine_time.h"

namespace soft_robot_lab {
namespace {

constexpr int rows_at_once = 3;

}  // namespace

ActuatorList::ActuatorList(PanelContext& panel, QWidget* parent) : QScrollArea(parent), panel_(panel) {
  setWidgetResizable(true);
  setFrameShape(QFrame::NoFrame);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* inside = new QWidget(this);
  rows_ = new QVBoxLayout(inside);
  rows_->setContentsMargins(0, 0, 4, 0);
  empty_ = plain_label("No actuators yet.", inside);
  rows_->addWidget(empty_);
  rows_->addStretch(1);
  setWidget(inside);
}

void ActuatorList::refresh() {
  const ActuatorValues& values = panel_.link->state().values();
  if (values.revision() != shown_revision_) make_rows();
  for (std::size_t i = 0; i < editors_.size(); ++i) editors_[i]->show_row(values.rows()[i]);
}

void ActuatorList::make_rows() {
  const ActuatorValues& values = panel_.link->state().values();
  for (ActuatorEditor* editor : editors_) editor->deleteLater();
  editors_.clear();
  for (const ActuatorRow& row : values.rows()) {
    const auto edit = [this, name = row.name](double value) {
      panel_.link->state().values().edit(name, value, machine_time_s());
    };
    editors_.push_back(new ActuatorEditor(row, static_cast<int>(editors_.size()) + 1, edit, this));
    rows_->insertWidget(rows_->count() - 1, editors_.back());
  }
  empty_->setVisible(editors_.empty());
  show_whole_rows();
  shown_revision_ = values.revision();
  if (!editors_.empty()) panel_.status.show_success("Move a slider, or type a number.");
}

// No row is cut where there is no need to scroll, nor the last one that fits.
void ActuatorList::show_whole_rows() {
  if (editors_.empty()) return;
  const int rows = std::min(rows_at_once, static_cast<int>(editors_.size()));
  const int row_px = editors_.front()->sizeHint().height() + rows_->spacing();
  setMinimumHeight(rows * row_px);
  setMaximumHeight(static_cast<int>(editors_.size()) * row_px + rows_->spacing());
}

}  // namespace soft_robot_lab
