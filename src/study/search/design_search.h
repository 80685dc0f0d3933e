// SPDX-License-Identifier: BSD-3-Clause
// A search over designs by pagmo2: CMA-ES, differential evolution, or NSGA-II where there are several objectives.
#pragma once

#include "design_evaluator.h"

namespace soft_robot_lab {

// Until search.designs are known, no generation brings new ones any more, or the evaluator is stopped. It repeats
// itself by its seed, so that with the same journal it goes on where it was stopped. True unless stopped.
bool search_designs(const SearchSettings& search, DesignEvaluator& evaluator);

// Of designs that are good: those that no other is better than in one objective and as good as in all others. In the
// order of the first objective, best first; of one objective the best alone.
std::vector<std::size_t> pareto_front(const std::vector<Design>& designs);

}  // namespace soft_robot_lab
