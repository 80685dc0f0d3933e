// SPDX-License-Identifier: BSD-3-Clause
// More points of a workspace where its neighbouring tips are farthest apart, as where the body snaps.
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/simulation.h"
#include "study/sweeps/journal.h"
#include "workspace_plan.h"

namespace soft_robot_lab {

constexpr int kMostBetween = 7;  // points between two neighbours

// How many of `count` points come into each of these gaps: each point in turn into the one whose parts are longest, if
// they shrank evenly. A gap of no length takes none.
std::vector<int> points_between(const std::vector<double>& lengths, int count);

// Adds that many points to a plan whose points are found: between neighbours, evenly, each sought from the one before
// it, from the end that is nearer to rest on. So what is found hangs on what the journal has, and on `count`.
void refine_workspace(WorkspacePlan& plan, const Model& model, int count, const std::string& version,
                      const Journal& journal);

}  // namespace soft_robot_lab
