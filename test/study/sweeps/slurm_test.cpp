// SPDX-License-Identifier: BSD-3-Clause
// `study --slurm` with programs in the place of Slurm's, which run an array's jobs here. test/nightly/slurm.sh has the
// real ones.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "running_study.h"
#include "study_run.h"

namespace soft_robot_lab {
namespace {

// Notes each job's process in `jobs`. Of the first array job 0 never runs, as where its node is down.
const char* const kSbatch = R"sh(#!/bin/sh
cd "$(dirname "$0")"
for word; do
  case $word in
    --array=0-*) last=${word#--array=0-} ;;
    --wrap=*) wrap=${word#--wrap=} ;;
  esac
done
first=1
[ -e jobs ] && first=0
: >>jobs
for slot in $(seq $first "$last"); do
  SLURM_ARRAY_TASK_ID=$slot setsid sh -c "$wrap" >/dev/null 2>&1 &
  echo $! >>jobs
done
)sh";

const char* const kSqueue = R"sh(#!/bin/sh
cd "$(dirname "$0")"
echo JOBID
[ ! -e jobs ] || for job in $(cat jobs); do kill -0 "$job" 2>/dev/null && echo "$job"; done
exit 0
)sh";

class SlurmStudy : public testing::Test {
 protected:
  SlurmStudy() {
    short_scene(folder);
    for (const auto& [name, text] : {std::pair{"sbatch", kSbatch}, {"squeue", kSqueue}})
      std::filesystem::permissions(folder.write(name, text), std::filesystem::perms::owner_all);
    setenv("PATH", (folder.path(".") + ":" + path).c_str(), 1);
  }
  ~SlurmStudy() override { setenv("PATH", path.c_str(), 1); }

  std::string table(const std::string& name) const { return contents(folder.path(name + "/results.csv")); }

  const std::string path = std::getenv("PATH");
  const SceneFolder folder;
};

TEST_F(SlurmStudy, FindsWhatASerialRunFindsThoughAJobOfTheArrayNeverRan) {
  ASSERT_EQ(run_study(folder, short_study("9"), "serial", "--workers 1").exit_status, 0);
  const Outcome slurm = run_study(folder, short_study("9"), "slurm", "--slurm 3");
  EXPECT_EQ(slurm.exit_status, 0) << slurm.err;
  EXPECT_NE(slurm.err.find("3 tasks have no answer; they run in another array"), std::string::npos) << slurm.err;
  EXPECT_EQ(table("slurm"), table("serial"));
  EXPECT_FALSE(std::filesystem::exists(folder.path("slurm/slurm"))) << "answers that are in the journal";
}

TEST_F(SlurmStudy, GoesOnWhereItsMasterWasKilled) {
  ASSERT_EQ(run_study(folder, short_study("24"), "serial", "--workers 1").exit_status, 0);
  const pid_t master = start(
      {SOFT_ROBOT_LAB_STUDY_PROGRAM, folder.path("study.yaml"), "--slurm", "2", "--output", folder.path("slurm")});
  const std::string journal = folder.path("slurm/journal.sqlite");
  for (int i = 0; i < 6000 && outcomes_in(journal) < 3; ++i) usleep(5000);
  kill(master, SIGKILL);
  waitpid(master, nullptr, 0);
  const Outcome again = run_study(folder, short_study("24"), "slurm", "--slurm 2");
  EXPECT_EQ(again.exit_status, 0) << again.err;
  EXPECT_EQ(outcomes_in(journal), 24);
  EXPECT_EQ(table("slurm"), table("serial"));
}

TEST_F(SlurmStudy, EndsWhereNoJobBegins) {
  folder.write("sbatch", "#!/bin/sh\n");
  const Outcome outcome = run_study(folder, short_study("2"), "slurm", "--slurm 1");
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("no job of the array began to run tasks; see "), std::string::npos) << outcome.err;
}

TEST_F(SlurmStudy, SaysWhySbatchTookNoArray) {
  folder.write("sbatch", "#!/bin/sh\necho 'invalid partition' >&2; exit 1\n");
  const Outcome outcome = run_study(folder, short_study("2"), "slurm", "--slurm 1");
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("sbatch did not take the array: invalid partition"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace soft_robot_lab
