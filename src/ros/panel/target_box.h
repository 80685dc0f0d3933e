// SPDX-License-Identifier: BSD-3-Clause
// Which marker shall reach which place, by which search.
#pragma once

#include <array>

#include <Eigen/Core>
#include <QComboBox>
#include <QGroupBox>
#include <QString>

#include "number_box.h"
#include "panel_context.h"

namespace soft_robot_lab {

class TargetBox : public QGroupBox {
 public:
  TargetBox(PanelContext& panel, QWidget* parent);

  // Follows what is searched for, and of which marker; a number that is being typed stays, unless another robot came.
  void refresh();
  void begin_anew() { shown_targets_ = -1; }  // another session
  QString marker() const { return marker_->currentText(); }
  bool has_markers() const { return marker_->count() > 0; }
  void optimise();

 private:
  void refresh_markers(const QStringList& names);
  void write_target();
  void show_target();
  Eigen::Vector3d target_m() const;

  PanelContext& panel_;
  QComboBox *marker_, *method_;
  std::array<NumberBox*, 3> target_mm_;
  int shown_targets_ = -1;
  int target_of_ = -1;  // of which robot the numbers are
};

}  // namespace soft_robot_lab
