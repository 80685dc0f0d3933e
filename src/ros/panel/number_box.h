// SPDX-License-Identifier: BSD-3-Clause
// A field for a number in whatever locale: it shows a decimal point, and takes a typed comma for one.
#pragma once

#include <QDoubleSpinBox>
#include <QLocale>

namespace soft_robot_lab {

class NumberBox : public QDoubleSpinBox {
 public:
  explicit NumberBox(QWidget* parent) : QDoubleSpinBox(parent) {
    QLocale plain = QLocale::c();  // would take a comma for a separator of thousands: 12,5 for 125
    plain.setNumberOptions(QLocale::OmitGroupSeparator | QLocale::RejectGroupSeparator);
    setLocale(plain);
    setKeyboardTracking(false);  // a number counts when it is typed to its end
  }

  QValidator::State validate(QString& text, int& position) const override {
    text.replace(',', '.');
    return QDoubleSpinBox::validate(text, position);
  }
};

}  // namespace soft_robot_lab
