// SPDX-License-Identifier: BSD-3-Clause
#include "buttons.h"

#include <QVariant>

namespace soft_robot_lab {

QPushButton* make_button(const QString& text, const QString& hint, const std::function<void()>& press,
                         QWidget* parent) {
  auto* made = new QPushButton(text, parent);
  made->setToolTip(hint);
  made->setMinimumWidth(made->fontMetrics().horizontalAdvance(text) + 16);  // narrower than the style's own
  QObject::connect(made, &QPushButton::clicked, parent, press);
  return made;
}

void enable(QPushButton* button, const QString& why_not) {
  if (!button->property("hint").isValid()) button->setProperty("hint", button->toolTip());
  const QString hint = button->property("hint").toString() + (why_not.isEmpty() ? "" : ".\nNot now: " + why_not);
  button->setEnabled(why_not.isEmpty());
  if (hint == button->toolTip()) return;
  button->setToolTip(hint);
  button->setStatusTip(why_not.isEmpty() ? "" : "Not now: " + why_not);
}

void add_grid(QGridLayout* grid, const std::vector<QWidget*>& widgets, int columns) {
  for (int i = 0; i < static_cast<int>(widgets.size()); ++i)
    grid->addWidget(widgets[static_cast<std::size_t>(i)], i / columns, i % columns);
  grid->setContentsMargins(0, 0, 0, 0);
}

}  // namespace soft_robot_lab
