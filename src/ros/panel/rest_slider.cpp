// SPDX-License-Identifier: BSD-3-Clause
#include "rest_slider.h"

#include <algorithm>

#include <QPainter>
#include <QStyle>
#include <QStyleOptionSlider>

namespace soft_robot_lab {

void RestSlider::paintEvent(QPaintEvent* /*event*/) {
  QStyleOptionSlider option;
  initStyleOption(&option);
  const QRect handle = style()->subControlRect(QStyle::CC_Slider, &option, QStyle::SC_SliderHandle, this);
  const auto x_of = [&](int position) {
    return handle.width() / 2 +
           QStyle::sliderPositionFromValue(minimum(), maximum(), position, width() - handle.width());
  };
  const int groove_px = 5, top = height() / 2 - groove_px / 2;
  const auto [from, to] = std::minmax({x_of(rest_), x_of(value())});
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(palette().mid(), 1.0));
  painter.setBrush(palette().midlight());
  painter.drawRoundedRect(handle.width() / 2, top, width() - handle.width(), groove_px, 2, 2);
  painter.fillRect(from, top, to - from, groove_px, palette().highlight());
  painter.fillRect(x_of(rest_) - 1, top - 4, 2, groove_px + 8, palette().dark());
  option.subControls = QStyle::SC_SliderHandle;
  style()->drawComplexControl(QStyle::CC_Slider, &option, &painter, this);
}

}  // namespace soft_robot_lab
