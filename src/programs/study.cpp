// SPDX-License-Identifier: BSD-3-Clause
// study STUDY.yaml --output FOLDER: runs a program over many values of a scene's numbers, here or on many machines.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <thread>

#include "progress_bar.h"
#include "settings/command_line.h"
#include "settings/interrupted.h"
#include "settings/limits.h"
#include "study/sweeps/hosts.h"
#include "study/sweeps/slurm.h"
#include "study/sweeps/study_report.h"
#include "study/sweeps/worker.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string study, output, hosts, mpi, worker, array_job;
  std::string ssh = "ssh -o BatchMode=yes";
  std::string sbatch = "sbatch";
  int slurm = 0;
  int workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool retry_failed = false;
};

// Where tasks run: one way at a time.
void declare_ways(CommandLine& app, Arguments& arguments) {
  const Argument workers =
      app.add_option("--workers", arguments.workers, "how many tasks run at a time, each in one thread")
          .type_name("N")
          .range(1, limits::kThreads)
          .show_default();
  const Argument hosts =
      app.add_option("--hosts", arguments.hosts, "run on these machines: lines of a name and a number of workers")
          .type_name("FILE");
  app.add_option("--ssh", arguments.ssh, "what starts a command on a host").type_name("COMMAND").show_default();
  const Argument mpi =
      app.add_option("--mpi", arguments.mpi, "run in the ranks that this command starts, as \"mpirun -n 8\"")
          .type_name("COMMAND");
  const Argument slurm = app.add_option("--slurm", arguments.slurm, "run in an array of so many jobs of Slurm")
                             .type_name("N")
                             .range(1, limits::kJobs);
  app.add_option("--sbatch", arguments.sbatch, "what takes such an array, with arguments of the site")
      .type_name("COMMAND")
      .show_default();
  hosts.excludes(workers);
  mpi.excludes(workers).excludes(hosts);
  slurm.excludes(workers).excludes(hosts).excludes(mpi);
}

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("STUDY", arguments.study, "the study's file").type_name("FILE");
  app.add_option("--output", arguments.output, "the folder of journal.sqlite, results.csv, results.npy and report.html")
      .type_name("FOLDER");
  declare_ways(app, arguments);
  app.add_flag("--retry-failed", arguments.retry_failed, "run the tasks that failed before once more");
  app.add_option("--worker", arguments.worker).group("");  // how the study starts itself
  app.add_option("--array-job", arguments.array_job).group("");
  app.footer(
      "The same command goes on where it was stopped. Exit status: 0 all tasks are good, 1 some are not or were not\n"
      "run, 2 bad study or arguments.");
}

std::vector<WorkerCommand> workers_for(const Arguments& arguments, const std::string& program) {
  if (!arguments.mpi.empty()) return mpi_workers(program, arguments.mpi);
  if (!arguments.hosts.empty()) return remote_workers(program, arguments.hosts, arguments.ssh);
  return local_workers(program, arguments.workers);
}

std::string time_left(const StudyProgress& now) {
  const std::size_t here = now.done - now.before;
  if (here == 0) return "";
  const double left_s = now.elapsed_s / static_cast<double>(here) * static_cast<double>(now.tasks - now.done);
  return left_s < 120.0 ? ", " + std::to_string(std::lround(left_s)) + " s left"
                        : ", " + std::to_string(std::lround(left_s / 60.0)) + " min left";
}

// A line of a log for each percent, not for each task.
class Progress {
 public:
  bool show(const StudyProgress& now) {
    const double fraction = now.tasks > 0 ? static_cast<double>(now.done) / static_cast<double>(now.tasks) : 1.0;
    const int percent = static_cast<int>(100.0 * fraction);
    if (percent == percent_ && now.elapsed_s < shown_s_ + 1.0) return !interrupted();
    if (percent != percent_ || now.done != done_) {
      bar_.show(fraction, std::to_string(now.done) + " of " + std::to_string(now.tasks) + " tasks, " +
                              std::to_string(now.failed + now.not_good) + " not good" + time_left(now));
    }
    percent_ = percent;
    done_ = now.done;
    shown_s_ = now.elapsed_s;
    return !interrupted();
  }

 private:
  ProgressBar bar_{"study"};
  int percent_ = -1;
  std::size_t done_ = 0;
  double shown_s_ = 0.0;
};

StudyProgress run(const Arguments& arguments, const StudySettings& study, const std::vector<StudyTask>& tasks,
                  Journal& journal, const std::string& version) {
  Progress progress;
  const auto report = [&](const StudyProgress& now) { return progress.show(now); };
  const auto warn = [](const std::string& what) { std::cerr << "study: warning: " << what << "\n"; };
  if (arguments.slurm > 0)
    return run_tasks_by_slurm(study, tasks, journal,
                              {arguments.slurm, arguments.sbatch, arguments.output, report, warn});
  return run_tasks(study, tasks, journal, {workers_for(arguments, study.program), version, report, warn});
}

int finish(const Arguments& arguments, const StudySettings& study, const ResultsTable& table) {
  write_results(table, arguments.output);
  std::cout << study_summary(study, table);
  write_study_report(study, table, arguments.output);
  std::cout << arguments.output << "/report.html\n";
  if (interrupted()) std::cerr << "study: stopped; the same command goes on from here\n";
  return table.all_good() ? kGood : kNotGood;
}

int run_study(const Arguments& arguments) {
  if (!arguments.array_job.empty()) return run_array_job(arguments.worker, arguments.array_job), kGood;
  if (!arguments.worker.empty()) return run_worker_on_pipes(arguments.worker), kGood;
  if (arguments.study.empty()) throw std::invalid_argument("no study named; --help lists all arguments");
  if (arguments.output.empty()) throw std::invalid_argument("--output FOLDER is missing");
  const StudySettings study = read_study(arguments.study);
  const std::string version = program_version(study.program);
  const std::vector<StudyTask> tasks = make_tasks(study, version);
  Journal journal(arguments.output);
  journal.set_tasks(study, tasks);
  if (arguments.retry_failed) journal.forget_failures(tasks);
  heed_interrupts();
  run(arguments, study, tasks, journal, version);
  return finish(arguments, study, results_table(study, tasks, journal));
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Runs a program over many values of a scene's numbers, here or on many machines, without a ROS master.", "study");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return run_study(arguments); });
}
