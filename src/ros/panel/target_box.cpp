// SPDX-License-Identifier: BSD-3-Clause
#include "target_box.h"

#include <QGridLayout>
#include <QSignalBlocker>

namespace soft_robot_lab {

TargetBox::TargetBox(PanelContext& panel, QWidget* parent)
    : QGroupBox("Target [mm, robot_base]", parent),
      panel_(panel),
      marker_(new QComboBox(this)),
      method_(new QComboBox(this)) {
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(4, 2, 4, 2);
  marker_->setToolTip("The marker that shall reach the target");
  method_->addItems({"gauss_newton", "rmsprop", "pid", "pid_projected", "cma_es", "differential_evolution"});
  method_->setMinimumContentsLength(8);
  method_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  grid->addWidget(marker_, 0, 0);
  grid->addWidget(method_, 0, 1, 1, 2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    NumberBox* number = target_mm_[axis] = new NumberBox(this);
    number->setDecimals(1);
    number->setRange(-9999.0, 9999.0);
    number->setPrefix(QString("xyz"[axis]) + " ");
    number->setMinimumWidth(0);
    connect(number, qOverload<double>(&QDoubleSpinBox::valueChanged), this, [this] { show_target(); });
    grid->addWidget(number, 1, static_cast<int>(axis));
  }
  connect(marker_, QOverload<int>::of(&QComboBox::activated), this, [this] {
    shown_targets_ = panel_.link->state().targets();
    write_target();
    show_target();
  });
}

void TargetBox::refresh() {
  const SessionState& state = panel_.link->state();
  QStringList names;
  for (const std::string& name : state.markers().names) names << QString::fromStdString(name);
  refresh_markers(names);
  if (shown_targets_ == state.targets() || names.isEmpty()) return;
  shown_targets_ = state.targets();
  if (const int asked = names.indexOf(QString::fromStdString(state.target_marker())); asked >= 0)
    marker_->setCurrentIndex(asked);
  write_target();
}

void TargetBox::refresh_markers(const QStringList& names) {
  QStringList shown;
  for (int i = 0; i < marker_->count(); ++i) shown << marker_->itemText(i);
  if (names == shown) return;
  marker_->clear();
  marker_->addItems(names);
  const int tip = names.indexOf("tip");  // else the last, as the controller's ball
  marker_->setCurrentIndex(tip >= 0 ? tip : names.size() - 1);
  shown_targets_ = -1;
}

void TargetBox::write_target() {
  const SessionState& state = panel_.link->state();
  const auto target = state.target(marker().toStdString());
  if (!target) return;
  const bool another_robot = target_of_ != state.robots();
  target_of_ = state.robots();
  const double position_m[3] = {target->x, target->y, target->z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const QSignalBlocker quiet(target_mm_[axis]);
    if (another_robot || !target_mm_[axis]->hasFocus()) target_mm_[axis]->setValue(1e3 * position_m[axis]);
  }
}

Eigen::Vector3d TargetBox::target_m() const {
  return 1e-3 * Eigen::Vector3d(target_mm_[0]->value(), target_mm_[1]->value(), target_mm_[2]->value());
}

// What is chosen here is what stands in rviz's scene.
void TargetBox::show_target() {
  if (panel_.link && has_markers()) panel_.link->show_target(marker().toStdString(), target_m());
}

void TargetBox::optimise() {
  panel_.link->optimise(method_->currentText().toStdString(), marker().toStdString(), target_m());
  panel_.status.show_success("Searches ...");
}

}  // namespace soft_robot_lab
