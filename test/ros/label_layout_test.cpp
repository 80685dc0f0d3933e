// SPDX-License-Identifier: BSD-3-Clause
#include "ros/view/label_layout.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

using Box = Eigen::AlignedBox2d;

const Eigen::Vector2d window_px(780.0, 700.0);

Box box_of(const Label& label, const Eigen::Vector2d& center_px) {
  return {center_px - 0.5 * label.size_px, center_px + 0.5 * label.size_px};
}

Label label_at(double x, double y) { return {{x, y}, {70.0, 20.0}, std::nullopt}; }

CoveredCells body_over(const Box& box) {
  CoveredCells body(window_px);
  body.add_triangle(box.min(), box.corner(Box::BottomRight), box.max());
  body.add_triangle(box.min(), box.max(), box.corner(Box::TopLeft));
  return body;
}

void expect_readable(const std::vector<Label>& labels, const CoveredCells& body) {
  const std::vector<Eigen::Vector2d> centers = place_labels(labels, body, window_px);
  ASSERT_EQ(centers.size(), labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Box box = box_of(labels[i], centers[i]);
    EXPECT_TRUE(Box(Eigen::Vector2d::Zero(), window_px).contains(box)) << i;
    EXPECT_EQ(body.share_of(box), 0.0) << i << " lies on the body";
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_TRUE(box.intersection(box_of(labels[j], centers[j])).isEmpty()) << i << " over " << j;
  }
}

// As the markers along a robot that hangs, nearer to one another than a label is high.
TEST(LabelLayout, KeepsLabelsApartAndOffTheBody) {
  std::vector<Label> labels;
  for (int i = 0; i < 12; ++i) labels.push_back(label_at(390.0 + 3.0 * i, 200.0 + 12.0 * i));
  expect_readable(labels, body_over({Eigen::Vector2d(340, 180), Eigen::Vector2d(460, 360)}));
}

TEST(LabelLayout, KeepsLabelsOfOnePlaceApart) {
  expect_readable(std::vector<Label>(8, label_at(400.0, 300.0)), CoveredCells(window_px));
}

TEST(LabelLayout, KeepsLabelsInTheWindow) {
  for (const Eigen::Vector2d& corner_px :
       {Eigen::Vector2d(1, 1), Eigen::Vector2d(779, 1), Eigen::Vector2d(1, 699), Eigen::Vector2d(779, 699)})
    expect_readable({label_at(corner_px.x(), corner_px.y()), label_at(corner_px.x(), corner_px.y())},
                    CoveredCells(window_px));
}

// A name that jumps from side to side while its robot moves cannot be read.
TEST(LabelLayout, KeepsALabelWhereItStoodUnlessTheBodyComesThere) {
  Label label = label_at(400.0, 300.0);
  label.offset_px = Eigen::Vector2d(-55.0, 30.0);
  const Eigen::Vector2d stood_px = label.anchor_px + *label.offset_px;
  EXPECT_EQ(place_labels({label}, CoveredCells(window_px), window_px).at(0), stood_px);
  const CoveredCells body = body_over({stood_px - Eigen::Vector2d(50, 30), stood_px + Eigen::Vector2d(50, 30)});
  EXPECT_NE(place_labels({label}, body, window_px).at(0), stood_px);
}

// A window may be as small as its user likes.
TEST(LabelLayout, PlacesLabelsWhereThereIsNoRoom) {
  const Eigen::Vector2d small_px(30.0, 20.0);
  for (const Eigen::Vector2d& center :
       place_labels({label_at(10, 10), label_at(20, 10)}, CoveredCells(small_px), small_px))
    EXPECT_TRUE(center.allFinite());
}

TEST(LabelLayout, TakesTrianglesAsFarAsTheyAreInTheWindow) {
  CoveredCells body(window_px);
  body.add_triangle({-100.0, -100.0}, {40.0, -100.0}, {40.0, 60.0});
  EXPECT_GT(body.share_of({Eigen::Vector2d(0, 0), Eigen::Vector2d(39, 20)}), 0.3);
  EXPECT_EQ(body.share_of({Eigen::Vector2d(100, 100), Eigen::Vector2d(200, 200)}), 0.0);
  body.add_triangle({0.0, 0.0}, {1e9, 0.0}, {NAN, 60.0});
  EXPECT_EQ(body.share_of({Eigen::Vector2d(100, 100), Eigen::Vector2d(200, 200)}), 0.0);
}

}  // namespace
}  // namespace soft_robot_lab
