// SPDX-License-Identifier: BSD-3-Clause
#include "camera_tuning.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr double exposure_ratio = 1.05;  // between the longest good and the shortest bad exposure: near enough
constexpr int gain_step = 2;

class OutOfPictures {};

// Takes pictures, remembers the last good and the last bad one, and gives up after so many.
class Search {
 public:
  Search(const TuningOptions& options, const std::function<BallMeasure(const CameraSetting&)>& look)
      : options_(options), look_(look) {}

  CameraTuning run() {
    try {
      search();
    } catch (const OutOfPictures&) {
      end(TuningEnd::out_of_pictures, "no end after " + std::to_string(tuning_.pictures) +
                                          " pictures; does the light flicker, or does somebody stand before the box?");
    }
    return tuning_;
  }

 private:
  void search() {
    const CameraSettingLimits& limits = options_.limits;
    const CameraSetting lowest{false, limits.min_exposure, limits.min_gain};
    if (!good(lowest)) return refuse_lowest();
    CameraSetting best = lowest;
    best.exposure = longest_exposure(best);
    if (best.exposure == limits.max_exposure) best.gain = largest_gain(best);
    tuning_.setting = best;
    tuning_.measure = good_;
    judge();
  }

  bool good(const CameraSetting& setting) {
    if (tuning_.pictures == options_.max_pictures) throw OutOfPictures();
    ++tuning_.pictures;
    tuning_.setting = setting;
    tuning_.measure = look_(setting);
    const bool good = !balls_too_bright(tuning_.measure) && tuning_.measure.box_level <= options_.max_box_level;
    if (good)
      good_ = tuning_.measure;
    else
      too_bright_ = tuning_.measure;
    return good;
  }

  bool balls_too_bright(const BallMeasure& measure) const {
    return measure.saturated_share > options_.max_saturated_share || measure.brightest_level > options_.max_level;
  }

  // At the setting's gain; its own exposure is good.
  int longest_exposure(CameraSetting setting) {
    int known_good = setting.exposure;
    setting.exposure = options_.limits.max_exposure;
    if (known_good == setting.exposure || good(setting)) return setting.exposure;
    int bad = setting.exposure;
    while (bad - known_good > 1 && bad > exposure_ratio * known_good) {
      setting.exposure =
          std::clamp(static_cast<int>(std::lround(std::sqrt(double(known_good) * bad))), known_good + 1, bad - 1);
      (good(setting) ? known_good : bad) = setting.exposure;
    }
    return known_good;
  }

  // At the setting's exposure; its own gain is good.
  int largest_gain(CameraSetting setting) {
    int known_good = setting.gain;
    setting.gain = options_.limits.max_gain;
    if (known_good == setting.gain || good(setting)) return setting.gain;
    int bad = setting.gain;
    while (bad - known_good > gain_step) {
      setting.gain = (known_good + bad) / 2;
      (good(setting) ? known_good : bad) = setting.gain;
    }
    return known_good;
  }

  void end(TuningEnd why, const std::string& message) {
    tuning_.end = why;
    std::ostringstream text;
    text.precision(3);
    const BallMeasure& measure = tuning_.measure;
    text << message << " (exposure " << tuning_.setting.exposure << ", gain " << tuning_.setting.gain << ": balls "
         << 100 * measure.darkest_level << " to " << 100 * measure.brightest_level << " % of white, "
         << 100 * measure.saturated_share << " % of their pixels white, edge ";
    if (measure.edge_width_px)
      text << *measure.edge_width_px << " pixels wide";
    else
      text << "not to be seen";
    text << "; box " << 100 * measure.box_level << " %)";
    tuning_.message = text.str();
  }

  void refuse_lowest() {
    if (balls_too_bright(tuning_.measure))
      end(TuningEnd::ball_saturated, "a ball is too bright at the lowest settings; allowed: up to " +
                                         percent(options_.max_level) + " of white. Dim the light");
    else
      end(TuningEnd::box_bright, box_is_bright());
  }

  void judge() {
    const BallMeasure& measure = tuning_.measure;
    if (measure.darkest_level < options_.min_level) {
      const bool held_by_box = too_bright_ && !balls_too_bright(*too_bright_);
      const bool held_by_other = too_bright_ && balls_too_bright(*too_bright_);
      if (held_by_box) return end(TuningEnd::box_bright, box_is_bright());
      if (held_by_other)
        return end(TuningEnd::ball_dark, "a ball is too dark where another is as bright as allowed; allowed: " +
                                             percent(options_.min_level) + " of white or more. Light them alike");
      return end(TuningEnd::ball_dark, "a ball is too dark at the highest settings; allowed: " +
                                           percent(options_.min_level) + " of white or more. Light the box");
    }
    if (!measure.edge_width_px || *measure.edge_width_px > options_.max_edge_width_px) {
      std::ostringstream text;
      text << "a ball has no sharp edge; allowed: " << options_.max_edge_width_px
           << " pixels. Hold it still, clean the lens, or let it stand before something dark";
      return end(TuningEnd::blurred, text.str());
    }
    end(TuningEnd::crisp, "the balls are crisp, and the box is dark");
  }

  std::string box_is_bright() const {
    return "the box is too bright where the balls are not too dark; allowed: up to " + percent(options_.max_box_level) +
           " of white. Line it in black, or turn the lamps from its walls";
  }

  static std::string percent(double fraction) { return std::to_string(std::lround(100 * fraction)) + " %"; }

  const TuningOptions& options_;
  const std::function<BallMeasure(const CameraSetting&)>& look_;
  BallMeasure good_;                       // of the last good picture, which is the best so far
  std::optional<BallMeasure> too_bright_;  // of the last such picture
  CameraTuning tuning_;
};

}  // namespace

void TuningOptions::validate() const {
  const auto require = [](const std::string& field, double value, const AllowedRange& range) {
    if (!range.contains(value))
      throw std::invalid_argument(field + " is " + std::to_string(value) + "; allowed: " + range.to_string());
  };
  require("min_exposure", limits.min_exposure, {1, 1e6});
  require("max_exposure", limits.max_exposure, {double(limits.min_exposure), 1e6});
  require("min_gain", limits.min_gain, {0, 1e6});
  require("max_gain", limits.max_gain, {double(limits.min_gain), 1e6});
  require("max_level", max_level, {0, 1, true, false});
  require("min_level", min_level, {0, max_level, true, true});
  require("max_saturated_share", max_saturated_share, {0, 1, false, true});
  require("max_box_level", max_box_level, {0, 1, true, true});
  require("max_edge_width_px", max_edge_width_px, AllowedRange::positive());
  require("max_pictures", max_pictures, {1, 1e6});
}

CameraTuning tune_camera(const TuningOptions& options, const std::function<BallMeasure(const CameraSetting&)>& look) {
  options.validate();
  return Search(options, look).run();
}

}  // namespace soft_robot_lab
