// SPDX-License-Identifier: BSD-3-Clause
// What is known of a study's tasks, in FOLDER/journal.sqlite: written by one program, read by any while it grows.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "task.h"

struct sqlite3;
struct sqlite3_stmt;

namespace soft_robot_lab {

class Journal {
 public:
  // Makes the folder and the journal where there is none. Throws std::runtime_error where another program writes to
  // it, or the file is no journal; WriteError for a full disk.
  explicit Journal(const std::string& folder);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // The study's tasks, in place of those of an earlier run. Outcomes stay.
  void set_tasks(const StudySettings& study, const std::vector<StudyTask>& tasks);

  // Each call is a transaction: after it the outcome outlives this program, however that ends. One that is there
  // already stays as it is.
  void add(const TaskOutcome& outcome);

  std::optional<TaskOutcome> find(const std::string& hash) const;
  void forget_failures(const std::vector<StudyTask>& tasks);  // so that they run again

 private:
  class Statement;
  void run(const char* sql);
  [[noreturn]] void fail() const;

  std::string file_;
  int lock_ = -1;
  sqlite3* database_ = nullptr;
};

}  // namespace soft_robot_lab
