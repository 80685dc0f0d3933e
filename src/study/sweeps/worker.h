// SPDX-License-Identifier: BSD-3-Clause
// A worker: takes tasks as lines of JSON, runs each as a child process, and answers with a line each.
//   worker:  {"slot": 0, "version": HASH}                               once, of the program that tasks run
//   master:  {"slot": 0, "program": ..., "scene": ..., "set": [[NAME, VALUE], ...], ..., "hash": HASH}
//   worker:  {"slot": 0, "hash": HASH, "state": "good", "reason": "", "result": {...}, "wall_s": 0.4}
//         or {"slot": 0, "hash": HASH, "lost": "killed"}                run it again
//         or {"slot": 0, "hash": HASH, "refused": "..."}                files that differ from the study's
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace soft_robot_lab {

struct WorkerLink {
  std::function<std::optional<std::string>()> receive;  // the next line; nothing where the master is gone
  std::function<void(const std::string&)> send;
};

// Until the master is gone. `program` is that of all tasks.
void run_worker(const std::string& program, int slot, const WorkerLink& link);

// The same over standard input and output. The whole process ends at once when its input does, with what it runs.
void run_worker_on_pipes(const std::string& program);

void print_line(const std::string& line);  // on the standard output; ends the process where nobody reads it

}  // namespace soft_robot_lab
