// SPDX-License-Identifier: BSD-3-Clause
// Workers and masters that are killed: nothing is lost, nothing doubled, and the table is that of a serial run.
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
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

using Words = std::vector<std::string>;

// As a reader beside the running study: the answer's first cell, "" before there is a journal.
std::string ask(const std::string& journal, const char* question) {
  sqlite3* database = nullptr;
  sqlite3_stmt* answer = nullptr;
  std::string found;
  if (sqlite3_open_v2(journal.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK &&
      sqlite3_prepare_v2(database, question, -1, &answer, nullptr) == SQLITE_OK && sqlite3_step(answer) == SQLITE_ROW)
    found = reinterpret_cast<const char*>(sqlite3_column_text(answer, 0));
  sqlite3_finalize(answer);
  sqlite3_close(database);
  return found;
}

int outcomes_in(const std::string& journal) {
  return std::atoi(("0" + ask(journal, "SELECT count(*) FROM outcomes")).c_str());
}

// Children, their children, and so on; some may have ended meanwhile.
std::vector<pid_t> descendants_of(pid_t process) {
  const std::string name = std::to_string(process);
  std::ifstream file("/proc/" + name + "/task/" + name + "/children");
  std::vector<pid_t> all;
  for (pid_t child; file >> child;) {
    all.push_back(child);
    for (const pid_t below : descendants_of(child)) all.push_back(below);
  }
  return all;
}

// Whether it runs still; one that nobody waited for yet does not.
bool runs(pid_t process) {
  std::string text;
  std::getline(std::ifstream("/proc/" + std::to_string(process) + "/stat"), text);
  const std::size_t name_end = text.rfind(')');
  return name_end != std::string::npos && text.substr(name_end, 4).find('Z') == std::string::npos;
}

pid_t start(const Words& command) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_t process = -1;
  EXPECT_EQ(posix_spawn(&process, words[0], nullptr, nullptr, words.data(), environ), 0);
  return process;
}

void kill_master(pid_t master) {
  const std::vector<pid_t> workers = descendants_of(master);
  kill(master, SIGKILL);
  waitpid(master, nullptr, 0);
  for (const pid_t worker : workers) {
    for (int i = 0; i < 1000 && runs(worker); ++i) usleep(10000);
    EXPECT_FALSE(runs(worker)) << "a worker outlived its master";
  }
}

// Kills a process of the workers after every `between` outcomes, and the master once there are `master_at`. Returns how
// many were killed.
int run_and_kill(pid_t master, const std::string& journal, int between, int master_at, std::mt19937& random) {
  int next = outcomes_in(journal) + between, killed = 0;
  for (; waitpid(master, nullptr, WNOHANG) != master; usleep(5000)) {
    const int done = outcomes_in(journal);
    if (done >= master_at) return kill_master(master), killed;
    const std::vector<pid_t> workers = descendants_of(master);
    if (done < next || workers.empty() || kill(workers[random() % workers.size()], SIGKILL) != 0) continue;
    ++killed;
    next = done + between;
  }
  return killed;
}

void expect_nothing_lost(const SceneFolder& folder, int tasks, int kills, const Words& way) {
  short_scene(folder);
  ASSERT_EQ(run_study(folder, short_study(std::to_string(tasks)), "serial", "--workers 1").exit_status, 0);
  Words command = {SOFT_ROBOT_LAB_STUDY_PROGRAM, folder.path("study.yaml"), "--output", folder.path("killed")};
  command.insert(command.end(), way.begin(), way.end());
  const std::string journal = folder.path("killed/journal.sqlite");
  const int between = tasks / (kills + 2);
  std::mt19937 random(1);
  int killed = run_and_kill(start(command), journal, between, tasks / 2, random);
  EXPECT_LT(outcomes_in(journal), tasks) << "the master was not killed";
  killed += run_and_kill(start(command), journal, between, tasks + 1, random);
  EXPECT_GE(killed, kills);
  EXPECT_EQ(outcomes_in(journal), tasks);
  EXPECT_EQ(ask(journal, "PRAGMA integrity_check"), "ok");
  EXPECT_EQ(contents(folder.path("killed/results.csv")), contents(folder.path("serial/results.csv")));
}

// Three hosts as ssh reaches them: each command in a session of its own, which a process here waits for.
void expect_nothing_lost_on_hosts(int tasks, int kills) {
  const SceneFolder folder;
  const std::string shell = folder.write("shell", "#!/bin/sh\nshift\nsetsid -w sh -c \"$*\"\n");
  std::filesystem::permissions(shell, std::filesystem::perms::owner_all);
  const std::string hosts = folder.write("hosts", "one\ntwo\nthree 2\n");
  expect_nothing_lost(folder, tasks, kills, {"--hosts", hosts, "--ssh", shell});
}

TEST(KilledStudy, LosesAndDoublesNothingOnThreeHosts) { expect_nothing_lost_on_hosts(60, 3); }

TEST(KilledStudy, LosesAndDoublesNothingOfAThousandTasksOnThreeHosts) { expect_nothing_lost_on_hosts(1000, 20); }

#ifdef SOFT_ROBOT_LAB_MPIRUN
const Words three_ranks = {"--mpi", SOFT_ROBOT_LAB_MPIRUN " --oversubscribe -n 3"};

TEST(KilledStudy, LosesAndDoublesNothingOverMpi) { expect_nothing_lost(SceneFolder(), 40, 1, three_ranks); }

TEST(KilledStudy, LosesAndDoublesNothingOfAThousandTasksOverMpi) {
  expect_nothing_lost(SceneFolder(), 1000, 20, three_ranks);
}
#endif

}  // namespace
}  // namespace soft_robot_lab
