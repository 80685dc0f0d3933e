// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mechanics/contact/skin_pairs.h"
#include "snapshots.h"
#include "train.h"

namespace soft_robot_lab {

// States of the full model, from which a reduced one is made.
struct TrainingSet {
  std::vector<Snapshot> snapshots;
  int failed = 0;             // solves
  std::vector<FacePair> met;  // of skin
};

// From 0 to 1, and what is done.
using TrainingProgress = std::function<void(double, const std::string&)>;

// Throws as train(); `progress` may be empty.
TrainingSet collect_training(const std::shared_ptr<const Model>& model, const ReducedTraining& training,
                             const TrainingProgress& progress);

}  // namespace soft_robot_lab
