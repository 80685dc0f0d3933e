// SPDX-License-Identifier: BSD-3-Clause
#include "plain_text.h"

#include <QStringList>

namespace soft_robot_lab {
namespace {

const char* colour_of(Lamp::Level level) {
  switch (level) {
    case Lamp::Level::ok:
      return "#2e8b57";
    case Lamp::Level::warn:
      return "#e08a00";
    case Lamp::Level::error:
      return "#c62828";
    case Lamp::Level::unknown:
      break;
  }
  return "#9e9e9e";
}

}  // namespace

QLabel* plain_label(const QString& text, QWidget* parent) {
  auto* label = new QLabel(parent);
  label->setTextFormat(Qt::PlainText);
  label->setText(text);
  return label;
}

QString plain_hint(const QString& text) {
  return "<span style='white-space:pre-wrap'>" + text.toHtmlEscaped() + "</span>";
}

QwtText plain_title(const QString& text) { return QwtText(text, QwtText::PlainText); }

QString lamp_text(const Lamp& lamp) {
  const std::string text = lamp.value.empty() ? lamp.name : lamp.name + " " + lamp.value;
  return QString("<span style='color:%1'>&#9679;</span>&nbsp;%2")
      .arg(colour_of(lamp.level), QString::fromStdString(text).toHtmlEscaped().replace(" ", "&nbsp;"));
}

QString lamp_reasons(const std::vector<Lamp>& lamps) {
  QStringList reasons;
  for (const Lamp& lamp : lamps) reasons << QString::fromStdString(lamp.name + ": " + lamp.reason);
  return plain_hint(reasons.join("\n"));
}

}  // namespace soft_robot_lab
