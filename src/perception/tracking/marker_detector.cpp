// SPDX-License-Identifier: BSD-3-Clause
#include "marker_detector.h"

#include <algorithm>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

#include "blob_shape.h"
#include "segmentation.h"

namespace soft_robot_lab {
namespace {

// Regions are small: OpenCV's thread pool costs more than it saves, and was seen to hold up the end of a program.
void keep_to_one_thread() {
  static const bool once = (cv::setNumThreads(1), true);
  (void)once;
}

std::vector<cv::Mat> segment(const cv::Mat& rgb, const DetectorSettings& settings) {
  cv::Mat hsv;
  cv::cvtColor(rgb, hsv, cv::COLOR_RGB2HSV);
  if (settings.method == SegmentationMethod::contrast) return {contrast_mask(hsv, settings.value_threshold)};
  std::vector<cv::Mat> masks;
  for (const MarkerColour& colour : settings.colours) masks.push_back(with_holes_filled(colour_mask(hsv, colour)));
  return masks;
}

cv::Rect grown(const cv::Rect& box, int margin_px) {
  return {box.x - margin_px, box.y - margin_px, box.width + 2 * margin_px, box.height + 2 * margin_px};
}

bool touches_edge(const cv::Rect& box, const cv::Size& size) {
  return box.x == 0 || box.y == 0 || box.br().x == size.width || box.br().y == size.height;
}

bool acceptable(const MarkerBlob& blob, const DetectorSettings& settings) {
  return blob.area_px >= settings.min_area_px && blob.area_px <= settings.max_area_px &&
         blob.contrast >= settings.min_contrast && (blob.partial || blob.roundness >= settings.min_roundness);
}

// The blob with one label, in pixels of the region.
MarkerBlob measure(const cv::Mat& rgb, const cv::Mat& labels, int label, const cv::Mat& all, const cv::Rect& found,
                   const DetectorSettings& settings) {
  MarkerBlob blob;
  blob.box = grown(found, kBlobMargin_px) & cv::Rect({0, 0}, rgb.size());
  BlobPatch patch{rgb(blob.box), labels(blob.box) == label, {}};
  patch.others = all(blob.box) & ~patch.own;
  measure_blob(patch, settings, blob);
  cv::Mat near;
  cv::dilate(patch.own, near, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(5, 5)));
  blob.partial = touches_edge(found, rgb.size()) || cv::countNonZero(near & patch.others) > 0;
  return blob;
}

// Where it is known how many markers there are, what is smaller is none.
void keep_largest(int count, std::vector<MarkerBlob>& blobs) {
  const auto kept = static_cast<std::size_t>(count);
  if (count <= 0 || blobs.size() <= kept) return;
  std::stable_sort(blobs.begin(), blobs.end(), [](const auto& a, const auto& b) { return a.area_px > b.area_px; });
  blobs.resize(kept);
}

}  // namespace

std::vector<MarkerBlob> detect_markers(const cv::Mat& rgb, const cv::Rect& region, const DetectorSettings& settings) {
  if (rgb.type() != CV_8UC3) throw std::invalid_argument("detect_markers: the image is not rgb8 (CV_8UC3)");
  keep_to_one_thread();
  const cv::Rect within = region & cv::Rect({0, 0}, rgb.size());
  std::vector<MarkerBlob> blobs;
  if (within.empty()) return blobs;
  const cv::Mat view = rgb(within);
  const std::vector<cv::Mat> masks = segment(view, settings);
  cv::Mat all = masks.front().clone();
  for (const cv::Mat& mask : masks) all |= mask;
  for (std::size_t colour = 0; colour < masks.size(); ++colour) {
    cv::Mat labels, stats, centroids;
    const int count = cv::connectedComponentsWithStats(masks[colour], labels, stats, centroids, 8, CV_32S);
    for (int label = 1; label < count; ++label) {
      const int* of = stats.ptr<int>(label);
      // The mask misses some of the soft edge, by which the area is judged later.
      if (of[cv::CC_STAT_AREA] < 0.3 * settings.min_area_px || of[cv::CC_STAT_AREA] > settings.max_area_px) continue;
      const cv::Rect found(of[cv::CC_STAT_LEFT], of[cv::CC_STAT_TOP], of[cv::CC_STAT_WIDTH], of[cv::CC_STAT_HEIGHT]);
      MarkerBlob blob = measure(view, labels, label, all, found, settings);
      blob.colour = settings.method == SegmentationMethod::colour ? static_cast<int>(colour) : -1;
      if (!acceptable(blob, settings)) continue;
      blob.box += within.tl();
      blob.centre_px += Eigen::Vector2d(blob.box.x, blob.box.y);
      blobs.push_back(std::move(blob));
    }
  }
  keep_largest(settings.marker_count, blobs);
  return blobs;
}

}  // namespace soft_robot_lab
