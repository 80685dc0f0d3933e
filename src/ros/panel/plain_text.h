// SPDX-License-Identifier: BSD-3-Clause
// Words of others in the window: names, messages, files. Qt takes for HTML what looks like it, and opens the files that
// such HTML names, so every label and every hint is made here.
#pragma once

#include <string>
#include <vector>

#include <QLabel>
#include <QString>
#include <qwt_text.h>

#include "lamps.h"

namespace soft_robot_lab {

QLabel* plain_label(const QString& text, QWidget* parent);
QString plain_hint(const QString& text);  // of a tooltip, whose format cannot be chosen
QwtText plain_title(const QString& text);

// Both are HTML.
QString lamp_text(const Lamp& lamp);  // of coloured points
QString lamp_reasons(const std::vector<Lamp>& lamps);

}  // namespace soft_robot_lab
