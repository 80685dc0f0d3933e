// SPDX-License-Identifier: BSD-3-Clause
// Workers and masters that are killed: nothing is lost, nothing doubled, and the table is that of a serial run.
#include <filesystem>
#include <random>
#include <string>

#include "running_study.h"
#include "study_run.h"

namespace soft_robot_lab {
namespace {

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

TEST(KilledStudy, LosesAndDoublesNothingOverMpi) { expect_nothing_lost(SceneFolder(), 24, 1, three_ranks); }

TEST(KilledStudy, LosesAndDoublesNothingOfAThousandTasksOverMpi) {
  expect_nothing_lost(SceneFolder(), 1000, 20, three_ranks);
}
#endif

}  // namespace
}  // namespace soft_robot_lab
