// SPDX-License-Identifier: BSD-3-Clause
#include "ros/controller/policy_request.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

PolicyAnswer answer_at(double distance_m) {
  PolicyAnswer answer;
  answer.summaries.resize(1);
  answer.summaries[0].usable = true;
  answer.summaries[0].final_distance_m = distance_m;
  return answer;
}

TEST(PolicyRequest, CountsATargetAsReachedWithinWhatTheModelKnows) {
  PolicyAnswer near = answer_at(2.0e-4), far = answer_at(7.0e-4), strict = answer_at(2.0e-5);
  OptimisePolicy::Request request;
  count_as_reached(request, near);
  count_as_reached(request, far);
  EXPECT_TRUE(near.summaries[0].target_reached);
  EXPECT_FALSE(far.summaries[0].target_reached);
  request.tolerance_m = 1.0e-5;
  count_as_reached(request, strict);
  EXPECT_FALSE(strict.summaries[0].target_reached);  // as the search said
}

}  // namespace
}  // namespace soft_robot_lab
