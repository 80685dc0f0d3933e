// SPDX-License-Identifier: BSD-3-Clause
#include "label_picture.h"

#include <algorithm>
#include <utility>

#include <QFontMetricsF>
#include <QLinearGradient>
#include <QPainter>
#include <QPainterPath>

namespace soft_robot_lab {
namespace {

const QColor kInk(25, 30, 40), kLeader(60, 70, 90, 170), kPaper(255, 255, 255, 225), kBorder(60, 70, 90, 60);
const QColor kAim(213, 30, 30), kTarget(230, 120, 0);
constexpr double kPadding_px = 4.0, kRing_px = 10.0;

QPointF point(const Eigen::Vector2d& at) { return {at.x(), at.y()}; }

QFont font_of(const LabelPicture::Text& text, QFont font) {
  font.setBold(text.strong);
  return font;
}

Eigen::Vector2d size_px(const LabelPicture::Text& text, const QFont& font) {
  const QSizeF size = QFontMetricsF(font_of(text, font)).size(0, text.text);
  return {size.width() + 2.0 * kPadding_px, size.height() + kPadding_px};
}

void paint_leader(const QPointF& anchor, const QRectF& box, QPainter& painter) {
  const QPointF end(std::clamp(anchor.x(), box.left(), box.right()), std::clamp(anchor.y(), box.top(), box.bottom()));
  painter.setPen(QPen(QColor(255, 255, 255, 150), 3.0));
  painter.drawLine(anchor, end);
  painter.setPen(QPen(kLeader, 1.2));
  painter.drawLine(anchor, end);
  painter.setPen(Qt::NoPen);
  painter.setBrush(kInk);
  painter.drawEllipse(anchor, 2.0, 2.0);
}

void paint_text(const LabelPicture::Text& text, const QRectF& box, QPainter& painter) {
  painter.setPen(QPen(text.strong ? kTarget : kBorder, 1.0));
  painter.setBrush(kPaper);
  painter.drawRoundedRect(box, 4.0, 4.0);
  painter.setPen(kInk);
  painter.setFont(font_of(text, painter.font()));
  painter.drawText(box, Qt::AlignCenter, text.text);
}

// Dashed, as it is seen through what stands before it.
void paint_aim(const LabelPicture::Aim& aim, QPainter& painter) {
  painter.setBrush(Qt::NoBrush);
  for (const auto& [colour, width] : {std::pair(QColor(255, 255, 255, 170), 4.0), std::pair(kAim, 1.8)}) {
    painter.setPen(QPen(colour, width, width < 3.0 ? Qt::DashLine : Qt::SolidLine, Qt::RoundCap));
    painter.drawLine(point(aim.from_px), point(aim.to_px));
  }
  for (const auto& [colour, width] : {std::pair(QColor(255, 255, 255, 200), 5.0), std::pair(kTarget, 2.5)}) {
    painter.setPen(QPen(colour, width));
    painter.drawEllipse(point(aim.to_px), kRing_px, kRing_px);
  }
}

constexpr double kTop_px = 10.0, kGap_px = 8.0;

// In the middle of the window.
void paint_scale(const LabelPicture& picture, const QSize& window_px, QPainter& painter) {
  if (picture.scale.size() < 2) return;
  const QFontMetricsF metrics(painter.font());
  const double height_px = 0.6 * metrics.height(), width_px = std::min(180.0, 0.4 * window_px.width());
  const QRectF bar(0.5 * (window_px.width() - width_px), kTop_px + 0.5 * (metrics.height() - height_px), width_px,
                   height_px);
  QLinearGradient gradient(bar.topLeft(), bar.topRight());
  for (std::size_t i = 0; i < picture.scale.size(); ++i)
    gradient.setColorAt(static_cast<double>(i) / static_cast<double>(picture.scale.size() - 1), picture.scale[i]);
  painter.setPen(QPen(kBorder, 1.0));
  painter.setBrush(gradient);
  painter.drawRoundedRect(bar, 3.0, 3.0);
  painter.setPen(kInk);
  const QRectF line(0.0, kTop_px, bar.left() - kGap_px, metrics.height());
  painter.drawText(line, Qt::AlignRight | Qt::AlignVCenter, "tension  0");
  painter.drawText(QRectF(bar.right() + kGap_px, kTop_px, window_px.width() - bar.right(), metrics.height()),
                   Qt::AlignLeft | Qt::AlignVCenter, picture.scale_end);
}

// Below the scale, as a narrow window has no room beside it.
void paint_caption(const LabelPicture& picture, const QSize& window_px, QPainter& painter) {
  const QFontMetricsF metrics(painter.font());
  const double top_px = picture.scale.size() < 2 ? kTop_px : kTop_px + metrics.height() + 0.5 * kGap_px;
  painter.setPen(kInk);
  painter.drawText(QRectF(0.0, top_px, window_px.width(), metrics.height()), Qt::AlignCenter, picture.caption);
}

bool are_near(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return (a - b).cwiseAbs().maxCoeff() < 0.3; }

}  // namespace

bool look_alike(const LabelPicture& a, const LabelPicture& b) {
  const auto same_text = [](const LabelPicture::Text& x, const LabelPicture::Text& y) {
    return x.key == y.key && x.text == y.text && x.strong == y.strong && are_near(x.anchor_px, y.anchor_px);
  };
  const auto same_aim = [](const LabelPicture::Aim& x, const LabelPicture::Aim& y) {
    return are_near(x.from_px, y.from_px) && are_near(x.to_px, y.to_px);
  };
  return a.scale == b.scale && a.scale_end == b.scale_end && a.caption == b.caption &&
         std::equal(a.texts.begin(), a.texts.end(), b.texts.begin(), b.texts.end(), same_text) &&
         std::equal(a.aims.begin(), a.aims.end(), b.aims.begin(), b.aims.end(), same_aim);
}

QImage LabelPainter::paint(const LabelPicture& picture, const CoveredCells& body, const QSize& window_px,
                           const QFont& font) {
  QImage image(window_px, QImage::Format_ARGB32_Premultiplied);
  image.fill(Qt::transparent);
  QPainter painter(&image);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setFont(font);
  for (const LabelPicture::Aim& aim : picture.aims) paint_aim(aim, painter);
  paint_scale(picture, window_px, painter);
  paint_caption(picture, window_px, painter);
  paint_texts(picture, body, window_px, painter);
  return image;
}

void LabelPainter::paint_texts(const LabelPicture& picture, const CoveredCells& body, const QSize& window_px,
                               QPainter& painter) {
  std::vector<Label> labels;
  for (const LabelPicture::Text& text : picture.texts) {
    labels.push_back({text.anchor_px, size_px(text, painter.font()), std::nullopt});
    const auto before = offsets_px_.find(text.key);
    if (before != offsets_px_.end()) labels.back().offset_px = before->second;
  }
  const std::vector<Eigen::Vector2d> centers =
      place_labels(labels, body, Eigen::Vector2d(window_px.width(), window_px.height()));
  offsets_px_.clear();
  std::vector<QRectF> boxes;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    offsets_px_[picture.texts[i].key] = centers[i] - labels[i].anchor_px;
    const Eigen::Vector2d corner = centers[i] - 0.5 * labels[i].size_px;
    boxes.emplace_back(corner.x(), corner.y(), labels[i].size_px.x(), labels[i].size_px.y());
    paint_leader(point(labels[i].anchor_px), boxes.back(), painter);
  }
  const QFont font = painter.font();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    painter.setFont(font);
    paint_text(picture.texts[i], boxes[i], painter);
  }
}

}  // namespace soft_robot_lab
