// SPDX-License-Identifier: BSD-3-Clause
// Hands the tasks of a study to its workers, and their outcomes to the journal.
#pragma once

#include <string>
#include <vector>

#include "journal.h"
#include "task_ledger.h"
#include "worker_channel.h"

namespace soft_robot_lab {

struct RunOptions {
  std::vector<WorkerCommand> workers;
  std::string version;  // of the program, which each worker must have
  ReportProgress report;
  Warn warn;  // of workers that ended
};

// A task whose worker or program was killed runs again, and fails at the fifth time. A worker that ended is started
// again; one that does not come up three times is left out. Throws std::runtime_error where none is left, or a worker
// refuses: another version, another scene.
StudyProgress run_tasks(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
                        const RunOptions& options);

}  // namespace soft_robot_lab
