// SPDX-License-Identifier: BSD-3-Clause
// Designs as tasks of a study, many at a time: first whether each can be cast, then what those are worth that can.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "search_file.h"
#include "study/sweeps/journal.h"
#include "study/sweeps/task_runner.h"

namespace soft_robot_lab {

// Each parameter's share of its range, in [0, 1]; what the logarithm is spread by counts so.
using DesignPoint = std::vector<double>;

struct Design {
  std::vector<double> values;  // of the parameters
  bool good = false;           // assessed, and castable where that is asked for
  std::string why_not;
  std::vector<double> fitness;    // one an objective; less is better
  nlohmann::ordered_json result;  // of the assessment
};

class DesignEvaluator {
 public:
  // `report`: after each task and each second, with the number of designs that are done; false: stop.
  DesignEvaluator(const SearchSettings& search, Journal& journal, int workers,
                  std::function<bool(std::size_t done)> report, Warn warn);

  // Points are rounded to a thousandth of each range first, so that no design is asked for twice. False where it was
  // stopped: then some are not known.
  bool evaluate(const std::vector<DesignPoint>& points);

  bool knows(const DesignPoint& point) const { return places_.count(rounded(point)) > 0; }
  const Design& at(const DesignPoint& point) const { return designs_[places_.at(rounded(point))]; }
  const std::vector<Design>& designs() const { return designs_; }  // as they were asked for first

 private:
  using Key = std::vector<int>;
  struct DesignStep {
    StudySettings study;
    std::string version, scene;  // hashes
  };

  static Key rounded(const DesignPoint& point);
  std::vector<double> values_of(const Key& key) const;
  DesignStep step(const std::string& program, const std::vector<std::string>& arguments) const;
  std::optional<std::vector<TaskOutcome>> run(const DesignStep& step, const std::vector<Design*>& designs,
                                              std::size_t done);
  void judge_castings(const std::vector<TaskOutcome>& outcomes, const std::vector<Design*>& designs) const;
  void judge_assessments(const std::vector<TaskOutcome>& outcomes, const std::vector<Design*>& designs) const;

  const SearchSettings& search_;
  Journal& journal_;
  int workers_;
  std::function<bool(std::size_t)> report_;
  Warn warn_;
  DesignStep casting_, assessment_;
  std::map<Key, std::size_t> places_;
  std::vector<Design> designs_;
};

}  // namespace soft_robot_lab
