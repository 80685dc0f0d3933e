// SPDX-License-Identifier: BSD-3-Clause
#include "slurm.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include "robot/design/content_hash.h"
#include "robot/design/timed_process.h"
#include "settings/find_program.h"
#include "settings/limits.h"
#include "settings/read_file.h"
#include "settings/write_file.h"
#include "shell_words.h"
#include "worker_channel.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr double kSubmitLimit_s = 120.0;
constexpr int kMostSilences = 60;             // of squeue, one after the other
constexpr std::chrono::seconds kLook{1};      // between looks at the files
constexpr std::chrono::seconds kMostWait{5};  // between questions to Slurm, which begin more often
constexpr std::uintmax_t kLargestLog_bytes = limits::kLog_bytes;

// Complete lines that came into a file since the last look.
class GrowingFile {
 public:
  std::vector<std::string> new_lines(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    stream.seekg(offset_);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line) && !stream.eof();) {
      offset_ += static_cast<std::streamoff>(line.size() + 1);
      lines.push_back(line);
    }
    return lines;
  }

 private:
  std::streamoff offset_ = 0;
};

// All answers of FOLDER/slurm, each once.
class Answers {
 public:
  explicit Answers(fs::path folder) : folder_(std::move(folder)) {}

  std::vector<Json> take() {
    std::vector<Json> answers;
    std::error_code ignored;
    for (const auto& round : fs::directory_iterator(folder_, ignored))
      for (const auto& file : fs::directory_iterator(round.path(), ignored)) {
        if (file.path().extension() != ".answers") continue;
        for (const std::string& line : files_[file.path().string()].new_lines(file.path())) {
          Json answer = Json::parse(line, nullptr, false);  // one may be torn
          if (answer.is_object()) answers.push_back(std::move(answer));
        }
      }
    return answers;
  }

 private:
  fs::path folder_;
  std::map<std::string, GrowingFile> files_;
};

class SlurmRunner {
 public:
  SlurmRunner(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
              const SlurmOptions& options)
      : study_(study),
        options_(options),
        ledger_(tasks, journal, options.report),
        folder_(fs::absolute(options.folder) / "slurm"),
        answers_(folder_) {
    for (const StudyTask* task : ledger_.open) open_.emplace(task->hash, task);
    ContentHash name;
    name.add(folder_.string());
    job_name_ = "study_" + name.hex().substr(0, 12);
  }

  StudyProgress run() {
    collect();
    bool go_on = ledger_.report() && (ledger_.all_done() || wait_for_jobs());  // of a study that was stopped
    while (go_on && !ledger_.all_done()) {
      submit();
      go_on = wait_for_jobs();
      if (go_on) judge_round();
    }
    std::error_code ignored;
    if (ledger_.all_done()) fs::remove_all(folder_, ignored);
    return ledger_.progress();
  }

 private:
  void collect() {
    for (const Json& answer : answers_.take()) {
      if (answer.contains("version")) begun_.insert(answer.at("slot").get<std::size_t>());
      const auto task = answer.contains("hash") ? open_.find(answer.at("hash")) : open_.end();
      if (task == open_.end()) continue;
      if (answer.contains("refused") && !round_.empty())
        throw std::runtime_error(answer.at("refused").get<std::string>());
      if (const auto outcome = outcome_of(answer)) {
        ledger_.record(*outcome);
        open_.erase(task);
      }
    }
  }

  // Until all is done or no job is left. False: stopped.
  bool wait_for_jobs() {
    Clock::time_point asked = round_.empty() ? Clock::time_point{} : Clock::now();
    for (std::chrono::seconds wait{1};; std::this_thread::sleep_for(kLook)) {
      const bool ask = Clock::now() > asked + wait;
      if (ask) {
        asked = Clock::now();
        wait = std::min(2 * wait, kMostWait);
      }
      const bool left = !ask || jobs_are_left();
      collect();
      if (!ledger_.report()) return false;
      if (!left || ledger_.all_done()) return true;
    }
  }

  // By name, as a study that was stopped left no number.
  bool jobs_are_left() {
    WorkerChannel squeue({"squeue", {"squeue", "--name", job_name_, "--format", "%i"}});
    std::size_t lines = 0;
    while (!squeue.ended()) lines += squeue.receive().size();
    silences_ = lines == 0 ? silences_ + 1 : 0;
    if (silences_ > kMostSilences) throw std::runtime_error("squeue does not answer");
    if (silences_ > 0 && options_.warn) options_.warn("squeue does not answer; it is asked again in 5 s");
    return lines != 1;  // the heading
  }

  void submit() {
    for (int number = 0; round_.empty() || fs::exists(round_); ++number) round_ = folder_ / std::to_string(number);
    fs::create_directories(round_);
    const int jobs = std::min(options_.jobs, static_cast<int>(open_.size()));
    write_tasks(jobs);
    begun_.clear();
    const std::string errors = (round_ / "sbatch.log").string();
    const ProcessEnd end = run_with_limit(array_command(jobs), errors, kSubmitLimit_s);
    if (end.kind != ProcessEnd::Kind::exited || end.value != 0)
      throw std::runtime_error("sbatch did not take the array: " + read_regular_file(errors, kLargestLog_bytes));
  }

  std::vector<std::string> array_command(int jobs) const {
    std::vector<std::string> command = words_of(options_.sbatch);
    const std::string program = command.empty() ? "" : find_program(command[0]);
    if (program.empty()) throw std::runtime_error("--sbatch: '" + options_.sbatch + "' names no program on PATH");
    command[0] = program;
    command.push_back("--array=0-" + std::to_string(jobs - 1));
    command.emplace_back("--requeue");
    command.push_back("--job-name=" + job_name_);
    command.push_back("--output=" + (round_ / "%a.log").string());
    command.push_back("--wrap=exec " + shell_quoted(study_program()) + " --worker " + study_.program + " --array-job " +
                      shell_quoted(round_.string()));
    return command;
  }

  // In the study's order, so that each job gets some of each corner of a grid.
  void write_tasks(int jobs) {
    std::string lines;
    tasks_.assign(static_cast<std::size_t>(jobs), {});
    int number = 0;
    for (const StudyTask* task : ledger_.open) {
      if (open_.count(task->hash) == 0) continue;
      const int slot = number++ % jobs;
      Json request = task_request(study_, *task);
      request["hash"] = task->hash;
      request["slot"] = slot;
      lines += request.dump() + "\n";
      tasks_[static_cast<std::size_t>(slot)].push_back(task);
    }
    write_file((round_ / "tasks").string(), lines);
  }

  // A job that began and left tasks open ended in the first of them.
  void judge_round() {
    if (ledger_.all_done()) return;
    if (begun_.empty())
      throw std::runtime_error("no job of the array began to run tasks; see " + (round_ / "0.log").string());
    if (options_.warn) options_.warn(std::to_string(open_.size()) + " tasks have no answer; they run in another array");
    for (const std::size_t slot : begun_) {
      if (slot >= tasks_.size()) continue;
      for (const StudyTask* task : tasks_[slot]) {
        if (open_.count(task->hash) == 0) continue;
        if (!ledger_.may_run_again(*task, "its job ended")) open_.erase(task->hash);
        break;
      }
    }
  }

  const StudySettings& study_;
  const SlurmOptions& options_;
  TaskLedger ledger_;
  fs::path folder_, round_;
  Answers answers_;
  std::string job_name_;
  std::map<std::string, const StudyTask*> open_;
  std::set<std::size_t> begun_;                       // slots of this round
  std::vector<std::vector<const StudyTask*>> tasks_;  // of each slot of this round
  int silences_ = 0;
};

}  // namespace

StudyProgress run_tasks_by_slurm(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
                                 const SlurmOptions& options) {
  return SlurmRunner(study, tasks, journal, options).run();
}

}  // namespace soft_robot_lab
