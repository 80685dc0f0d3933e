// SPDX-License-Identifier: BSD-3-Clause
// A study's tasks as array jobs of Slurm. Each job of an array runs every Nth open task and appends its answers to a
// file of its own in FOLDER/slurm; the study collects them into its journal. Neither waits for the other over a
// network, so the study may end meanwhile: the next one takes what is there, and waits for jobs that still run.
#pragma once

#include <string>
#include <vector>

#include "journal.h"
#include "task_ledger.h"

namespace soft_robot_lab {

struct SlurmOptions {
  int jobs = 1;                   // of an array
  std::string sbatch = "sbatch";  // with arguments of the site
  std::string folder;             // the study's, on a disk that all nodes share
  ReportProgress report;
  Warn warn;
};

// Tasks without an answer go into another array; one whose job ended five times has failed. Throws std::runtime_error
// where sbatch or squeue fail, no job begins, or a job's files differ from the study's.
StudyProgress run_tasks_by_slurm(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
                                 const SlurmOptions& options);

// One job of an array: slot SLURM_ARRAY_TASK_ID of the tasks in FOLDER/tasks, answers to FOLDER/SLOT.answers. Begun
// again, it goes on where it was.
void run_array_job(const std::string& program, const std::string& folder);

}  // namespace soft_robot_lab
