// SPDX-License-Identifier: BSD-3-Clause
// Buttons of the panel's parts.
#pragma once

#include <functional>
#include <vector>

#include <QGridLayout>
#include <QPushButton>
#include <QString>

namespace soft_robot_lab {

QPushButton* make_button(const QString& text, const QString& hint, const std::function<void()>& press, QWidget* parent);

// Off where there is a reason, which its hint then says, in the window's status bar too.
void enable(QPushButton* button, const QString& why_not);

// Row by row, without margins.
void add_grid(QGridLayout* grid, const std::vector<QWidget*>& widgets, int columns);

}  // namespace soft_robot_lab
