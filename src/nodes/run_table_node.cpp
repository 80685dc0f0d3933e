// Drives a session through every pair of an experiment's contractions, as table 6.5 of the thesis, waits for rest at
// each, and tells how large the gap between robot and simulation is there.
//
// Usage: run_table_node EXPERIMENT.yaml [HOLD_S]. Each pair is held for 3 s, or as long as is asked for: silicone
// creeps, and a fit takes the end of a hold. Exit status: 0 done, 1 a part failed, 2 bad file or arguments.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/RealityGap.h>

#include "nodes/session_client.h"
#include "soft_robot_lab/ros/topics.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {
namespace {

constexpr double ramp_s = 1.0, usual_hold_s = 3.0, longest_hold_s = 600.0;
constexpr int least_gaps = 3;
constexpr double patience_s = 10.0;  // for so many

// Root mean square of all gaps heard while the robot rests.
class RestingGap {
 public:
  explicit RestingGap(ros::NodeHandle& node)
      : subscriber_(node.subscribe(topics::reality_gap, 100, &RestingGap::add, this)) {}

  // [m]; negative without a tracker.
  double during(double hold_s) {
    count_ = 0;
    sum_m2_ = 0.0;
    begin_ = ros::Time::now();
    for (double held_s = 0.0; ros::ok() && (held_s < hold_s || (count_ < least_gaps && held_s < hold_s + patience_s));
         held_s = (ros::Time::now() - begin_).toSec())
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
    return count_ > 0 ? std::sqrt(sum_m2_ / count_) : -1.0;
  }

 private:
  void add(const RealityGap& gap) {
    if (gap.header.stamp < begin_) return;
    sum_m2_ += gap.rms_m * gap.rms_m;
    ++count_;
  }

  ros::Time begin_;
  int count_ = 0;
  double sum_m2_ = 0.0;
  ros::Subscriber subscriber_;
};

std::vector<double> read_contractions(const std::string& path) {
  const SettingsNode file = SettingsNode::load_file(path);
  const Eigen::VectorXd contractions = file.child("contractions").as_numbers();
  return std::vector<double>(contractions.begin(), contractions.end());
}

double read_hold_s(const std::string& text) {
  std::size_t used = 0;
  double hold_s = -1.0;
  try {
    hold_s = std::stod(text, &used);
  } catch (const std::logic_error&) {  // no number, or too large a one
  }
  if (used != text.size() || !(hold_s > 0.0 && hold_s <= longest_hold_s))
    throw std::invalid_argument("HOLD_S: '" + text + "' is not in (0, 600]");
  return hold_s;
}

ExecutePolicy::Request row_of(double left, double right) {
  ExecutePolicy::Request request;
  request.policy.names = {"left", "right"};
  request.policy.steps.resize(1);
  request.policy.steps[0].time_s = ramp_s;
  request.policy.steps[0].values = {left, right};
  request.wait_until_rest = true;
  return request;
}

// By way of slack cables: paid out from a pull, a drive would stop short of its zero by its backlash.
void return_to_rest(ros::NodeHandle& node, const std::vector<double>& contractions) {
  double slack = 1.05;
  for (const double contraction : contractions) slack = std::max(slack, contraction);
  call<ExecutePolicy>(node, topics::execute_policy, row_of(slack, slack));
  call<ExecutePolicy>(node, topics::execute_policy, row_of(1.0, 1.0));
}

void run_table(const std::vector<double>& contractions, double hold_s) {
  ros::NodeHandle node;
  RestingGap gap(node);
  std::printf("left   right  at rest after   gap [mm rms]\n");
  for (const double left : contractions)
    for (const double right : contractions) {
      const auto answer = call<ExecutePolicy>(node, topics::execute_policy, row_of(left, right));
      const double gap_m = gap.during(hold_s);
      std::printf("%-6g %-6g %6.2f s", left, right, answer.duration_s);
      std::printf(gap_m < 0.0 ? "        no tracker\n" : "        %.3f\n", 1e3 * gap_m);
      std::fflush(stdout);
      if (!ros::ok()) throw std::runtime_error("the session ended");
    }
  return_to_rest(node, contractions);
}

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  ros::init(argc, argv, "run_table");
  if (argc != 2 && argc != 3) {
    std::fprintf(stderr, "usage: run_table_node EXPERIMENT.yaml [HOLD_S]\n");
    return 2;
  }
  try {
    run_table(read_contractions(argv[1]), argc == 3 ? read_hold_s(argv[2]) : usual_hold_s);
    return 0;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
