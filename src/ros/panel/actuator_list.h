// SPDX-License-Identifier: BSD-3-Clause
// A row for each actuator of what runs, which scroll where there are many.
#pragma once

#include <vector>

#include <QLabel>
#include <QScrollArea>
#include <QVBoxLayout>

#include "actuator_editor.h"
#include "panel_context.h"

namespace soft_robot_lab {

class ActuatorList : public QScrollArea {
 public:
  ActuatorList(PanelContext& panel, QWidget* parent);

  void refresh();
  void begin_anew() { shown_revision_ = -1; }  // another session
  bool empty() const { return editors_.empty(); }

 private:
  void make_rows();
  void show_whole_rows();

  PanelContext& panel_;
  QVBoxLayout* rows_;
  QLabel* empty_;
  std::vector<ActuatorEditor*> editors_;
  int shown_revision_ = -1;
};

}  // namespace soft_robot_lab
