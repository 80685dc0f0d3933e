// SPDX-License-Identifier: BSD-3-Clause
// What is written over rviz's window: labels beside what they name with a line to it, targets seen through whatever
// stands before them, and the scale of tensions. Knows no rviz.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <QColor>
#include <QFont>
#include <QImage>

#include "label_layout.h"

class QPainter;

namespace soft_robot_lab {

// Places in pixels of the window.
struct LabelPicture {
  struct Text {
    std::string key;  // the same as long as it names the same
    QString text;
    Eigen::Vector2d anchor_px;
    bool strong = false;
  };
  struct Aim {  // a marker and the target that it shall reach
    Eigen::Vector2d from_px, to_px;
  };
  std::vector<Text> texts;  // the first has the first choice of its place
  std::vector<Aim> aims;
  std::vector<QColor> scale;  // from 0 to what `scale_end` says; empty: none
  QString scale_end;
  QString caption;
};

// Whether an eye would see the same.
bool look_alike(const LabelPicture& a, const LabelPicture& b);

class LabelPainter {
 public:
  // Premultiplied ARGB as large as the window. Where a label stood before, it stays if it can.
  QImage paint(const LabelPicture& picture, const CoveredCells& body, const QSize& window_px, const QFont& font);

 private:
  void paint_texts(const LabelPicture& picture, const CoveredCells& body, const QSize& window_px, QPainter& painter);

  std::map<std::string, Eigen::Vector2d> offsets_px_;  // of labels' middles from their anchors
};

}  // namespace soft_robot_lab
