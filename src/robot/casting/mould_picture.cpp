// SPDX-License-Identifier: BSD-3-Clause
#include "mould_picture.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>

#include "ray_tree.h"

namespace soft_robot_lab {
namespace {

constexpr int kLongerSide_px = 640, kMargin_px = 10;
constexpr double kElevation = 48 * M_PI / 180, kAzimuth = -58 * M_PI / 180;
constexpr double kSharpCosine = 0.88;  // normals that differ by more have an edge between them

// A camera at infinity. Its axes as columns: right, up, towards it.
struct View {
  Eigen::Matrix3d axes;
  Eigen::Vector3d low, high;  // of the surface along these
  double pixel_m = 0;
  int width = 0, height = 0;

  explicit View(const Surface& surface) {
    const Eigen::Vector3d towards(std::cos(kElevation) * std::cos(kAzimuth), std::cos(kElevation) * std::sin(kAzimuth),
                                  std::sin(kElevation));
    const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(towards).normalized();
    axes << right, towards.cross(right), towards;
    const Eigen::Matrix3Xd seen = axes.transpose() * surface.vertices_m;
    low = seen.rowwise().minCoeff();
    high = seen.rowwise().maxCoeff();
    const Eigen::Vector3d size = high - low;
    pixel_m = std::max(size.x(), size.y()) / (kLongerSide_px - 2 * kMargin_px);
    width = static_cast<int>(std::ceil(size.x() / pixel_m)) + 2 * kMargin_px;
    height = static_cast<int>(std::ceil(size.y() / pixel_m)) + 2 * kMargin_px;
  }

  Eigen::Vector3d origin_m(int row, int column) const {
    return axes * Eigen::Vector3d(low.x() + (column - kMargin_px + 0.5) * pixel_m,
                                  high.y() - (row - kMargin_px + 0.5) * pixel_m, high.z() + 10 * pixel_m);
  }
};

struct Seen {
  double distance_m = INFINITY;  // infinite: nothing
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  int triangle = -1;
};

std::vector<Seen> look(const Surface& surface, const View& view) {
  const RayTree tree(surface);
  std::vector<Seen> all;
  for (int row = 0; row < view.height; ++row)
    for (int column = 0; column < view.width; ++column) {
      const auto hit = tree.first_hit(view.origin_m(row, column), -view.axes.col(2), 0);
      all.push_back(hit ? Seen{hit->distance_m, surface.normals.col(hit->triangle), hit->triangle} : Seen{});
    }
  return all;
}

bool edge_between(const Seen& a, const Seen& b, double pixel_m) {
  if (std::isinf(a.distance_m) != std::isinf(b.distance_m)) return true;
  if (std::isinf(a.distance_m)) return false;
  return a.normal.dot(b.normal) < kSharpCosine || std::abs(a.distance_m - b.distance_m) > 8 * pixel_m;
}

cv::Vec3b shaded(const Seen& seen, const std::function<Paint(int)>& paint_of) {
  if (std::isinf(seen.distance_m)) return {255, 255, 255};
  const Paint paint = paint_of(seen.triangle);
  const Eigen::Vector3d light = Eigen::Vector3d(-0.35, -0.45, 0.82).normalized();
  const double bright = 255 * (0.5 + 0.5 * std::max(0.0, seen.normal.dot(light)));
  return {cv::saturate_cast<uchar>(bright * paint.blue), cv::saturate_cast<uchar>(bright * paint.green),
          cv::saturate_cast<uchar>(bright * paint.red)};
}

}  // namespace

std::string picture_png(const Surface& surface, const Paint& paint) {
  return picture_png(surface, [&](int) { return paint; });
}

std::string picture_png(const Surface& surface, const std::function<Paint(int)>& paint_of) {
  const View view(surface);
  const std::vector<Seen> seen = look(surface, view);
  const auto at = [&](int row, int column) { return seen[static_cast<size_t>(row) * view.width + column]; };
  cv::Mat image(view.height, view.width, CV_8UC3);
  for (int row = 0; row < view.height; ++row)
    for (int column = 0; column < view.width; ++column) {
      const bool edge = row > 0 && column > 0 &&
                        (edge_between(at(row, column), at(row - 1, column), view.pixel_m) ||
                         edge_between(at(row, column), at(row, column - 1), view.pixel_m));
      image.at<cv::Vec3b>(row, column) = edge ? cv::Vec3b{50, 40, 40} : shaded(at(row, column), paint_of);
    }
  std::vector<uchar> bytes;
  if (!cv::imencode(".png", image, bytes)) throw std::runtime_error("a picture cannot be made as PNG");
  return {bytes.begin(), bytes.end()};
}

}  // namespace soft_robot_lab
