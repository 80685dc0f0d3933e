// SPDX-License-Identifier: BSD-3-Clause
// Execution for a node: takes topics' messages, and answers with the last of them.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/MotorState.h>

#include "ros/messages/messages.h"
#include "session/execution.h"

namespace soft_robot_lab {

MotorWatchReport motor_report(const MotorState& state);

class PolicyExecution {
 public:
  using Send = decltype(ExecutionHost::send);

  PolicyExecution(const ClosedLoopOptions& loop_options, Send send);

  // Throws as Execution::execute does.
  ExecutePolicy::Response execute(const ExecutionOrder& order);
  ExecutionReport follow(const ExecutionOrder& order) { return execution_.execute(order); }

  bool running() const { return execution_.running(); }
  bool has_motors() const { return execution_.has_motors(); }
  // False where nothing is executed or prepared.
  bool cancel();

  // As long as what it returns is kept, an execution is prepared, which may be cancelled too.
  std::shared_ptr<void> prepare();
  bool cancelled() const { return cancelled_; }  // since prepare()

  // Messages that are not whole stand in the log; the next ones count.
  void add_simulated(const MarkerObservations& markers);
  void add_measured(const MarkerObservations& markers);
  void add_motors(const MotorState& state) { execution_.add_motors(motor_report(state)); }
  void add_drives(const ActuatorState& state);

 private:
  MarkerObservations last(const MarkerObservations& heard) const;
  void keep(const MarkerObservations& markers, MarkerObservations& heard);

  Execution execution_;
  std::atomic<bool> preparing_{false}, cancelled_{false};
  mutable std::mutex mutex_;                 // guards what follows
  MarkerObservations simulated_, measured_;  // the last, also while nothing is executed
};

}  // namespace soft_robot_lab
