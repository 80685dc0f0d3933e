// SPDX-License-Identifier: BSD-3-Clause
#include "actuator_editor.h"

#include <QGridLayout>
#include <QSignalBlocker>
#include <QToolButton>

#include "plain_text.h"

namespace soft_robot_lab {
namespace {

QLabel* small_label(double value, const ActuatorRow& row, QWidget* parent) {
  auto* label = plain_label(QString::number(value, 'g', 4) + (row.unit.empty() ? "" : " ") + row.unit.c_str(), parent);
  label->setStyleSheet("color: #707070; font-size: small");  // paler than what can be changed
  return label;
}

// Of a name's own "&" the window makes no key.
QString title_of(const ActuatorRow& row, int number) {
  QString name = QString::fromStdString(row.name).replace("&", "&&");
  return number <= 9 ? QString("&%1  %2").arg(number).arg(name) : name;
}

}  // namespace

ActuatorEditor::ActuatorEditor(const ActuatorRow& row, int number, const Edit& edit, QWidget* parent)
    : QWidget(parent), slider_(new RestSlider(this)), number_(new NumberBox(this)), measured_(plain_label("", this)) {
  slider_->setRange(0, row.positions() - 1);
  slider_->set_rest(row.position_of(row.rest));
  slider_->setPageStep(row.positions() / 10);
  number_->setDecimals(row.decimals);
  number_->setRange(row.min, row.max);
  number_->setSingleStep(row.step);
  if (!row.unit.empty()) number_->setSuffix(QString(" ") + row.unit.c_str());
  measured_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  measured_->setToolTip("As reached within the drive's speed, and what it measures");
  lay_out(row, number, edit);
  connect(slider_, &QSlider::valueChanged, this, [row, edit](int position) { edit(row.value_at(position)); });
  connect(number_, qOverload<double>(&QDoubleSpinBox::valueChanged), this, edit);
  show_row(row);
}

void ActuatorEditor::lay_out(const ActuatorRow& row, int number, const Edit& edit) {
  auto* name = plain_label(title_of(row, number), this);
  name->setBuddy(slider_);
  auto* rest = new QToolButton(this);
  rest->setText("rest");
  rest->setToolTip("Back to " + QString::number(row.rest, 'g', 6) + ", which asks for nothing");
  connect(rest, &QToolButton::clicked, this, [row, edit] { edit(row.rest); });

  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(0, 2, 0, 2);
  grid->setVerticalSpacing(1);
  grid->addWidget(name, 0, 0, 1, 2);
  grid->addWidget(measured_, 0, 2, 1, 3);
  grid->addWidget(small_label(row.min, row, this), 1, 0);
  grid->addWidget(slider_, 1, 1);
  grid->addWidget(small_label(row.max, row, this), 1, 2);
  grid->addWidget(number_, 1, 3);
  grid->addWidget(rest, 1, 4);
  grid->setColumnStretch(1, 1);
}

void ActuatorEditor::show_row(const ActuatorRow& row) {
  const QSignalBlocker quiet_slider(slider_), quiet_number(number_);
  if (!slider_->isSliderDown()) slider_->setValue(row.position());
  if (!number_->hasFocus() || number_->value() != row.shown) number_->setValue(row.shown);
  measured_->setText(QString::fromStdString(row.measured));
}

}  // namespace soft_robot_lab
