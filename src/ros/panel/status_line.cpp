// SPDX-License-Identifier: BSD-3-Clause
#include "status_line.h"

#include "plain_text.h"

namespace soft_robot_lab {

QLabel* StatusLine::make_label(QWidget* parent) {
  label_ = plain_label("Waits for a session.", parent);
  label_->setWordWrap(true);
  label_->setMinimumHeight(3 * label_->fontMetrics().lineSpacing());
  label_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  return label_;
}

void StatusLine::show_success(const QString& text) {
  label_->setStyleSheet("");
  label_->setText(text);
}

void StatusLine::show_failure(const QString& text) {
  label_->setStyleSheet("color: #c62828");
  label_->setText(text);
}

}  // namespace soft_robot_lab
