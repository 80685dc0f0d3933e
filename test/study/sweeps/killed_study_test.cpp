// SPDX-License-Identifier: BSD-3-Clause
// Workers and masters that are killed: nothing is lost, nothing doubled, and the table is that of a serial run.
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "study_run.h"

extern char** environ;

namespace soft_robot_lab {
namespace {

// As a reader beside the running study; -1 before there is a journal.
int outcomes_in(const std::string& journal) {
  sqlite3* database = nullptr;
  sqlite3_stmt* count = nullptr;
  int found = -1;
  if (sqlite3_open_v2(journal.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK &&
      sqlite3_prepare_v2(database, "SELECT count(*) FROM outcomes", -1, &count, nullptr) == SQLITE_OK &&
      sqlite3_step(count) == SQLITE_ROW)
    found = sqlite3_column_int(count, 0);
  sqlite3_finalize(count);
  sqlite3_close(database);
  return found;
}

std::vector<pid_t> children_of(pid_t process) {
  const std::string name = std::to_string(process);
  std::ifstream file("/proc/" + name + "/task/" + name + "/children");
  std::vector<pid_t> children;
  for (pid_t child; file >> child;) children.push_back(child);
  return children;
}

pid_t start(const std::vector<std::string>& command) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_t process = -1;
  EXPECT_EQ(posix_spawn(&process, words[0], nullptr, nullptr, words.data(), environ), 0);
  return process;
}

bool ended(pid_t process, int& status) { return waitpid(process, &status, WNOHANG) == process; }

// Kills a worker after every `between` outcomes, and the master once there are `master_at`. Returns whether it came to
// that.
bool run_and_kill(pid_t master, const std::string& journal, int between, int master_at, std::mt19937& random) {
  int next = between, status = 0;
  while (!ended(master, status)) {
    const int done = outcomes_in(journal);
    const std::vector<pid_t> workers = children_of(master);
    if (done >= master_at) {
      kill(master, SIGKILL);
      waitpid(master, &status, 0);
      for (const pid_t worker : workers)
        for (int i = 0; i < 1000 && kill(worker, 0) == 0; ++i) usleep(10000);
      for (const pid_t worker : workers) EXPECT_NE(kill(worker, 0), 0) << "a worker outlived its master";
      return true;
    }
    if (done >= next && !workers.empty()) {
      kill(workers[random() % workers.size()], SIGKILL);
      next = done + between;
    }
    usleep(5000);
  }
  return false;
}

void expect_nothing_lost(int tasks, int between) {
  const SceneFolder folder;
  short_scene(folder);
  const std::string text = short_study(std::to_string(tasks));
  ASSERT_EQ(run_study(folder, text, "serial", "--workers 1").exit_status, 0);
  const std::vector<std::string> command = {
      SOFT_ROBOT_LAB_STUDY_PROGRAM, folder.path("study.yaml"), "--workers", "3", "--output", folder.path("killed")};
  const std::string journal = folder.path("killed/journal.sqlite");
  std::mt19937 random(1);
  EXPECT_TRUE(run_and_kill(start(command), journal, between, tasks / 2, random)) << "the master was not killed";
  EXPECT_FALSE(run_and_kill(start(command), journal, between, 2 * tasks, random));
  EXPECT_EQ(outcomes_in(journal), tasks);
  EXPECT_EQ(contents(folder.path("killed/results.csv")), contents(folder.path("serial/results.csv")));
}

TEST(KilledStudy, LosesAndDoublesNothing) { expect_nothing_lost(100, 8); }

TEST(KilledStudy, LosesAndDoublesNothingOfAThousandTasks) { expect_nothing_lost(1000, 50); }

}  // namespace
}  // namespace soft_robot_lab
