// SPDX-License-Identifier: BSD-3-Clause
#include "task_runner.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>

#include <poll.h>

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr int kMostAttempts = 5;   // of a task
constexpr int kMostStarts = 3;     // of a worker that never answers
constexpr double kGrace_s = 60.0;  // beyond a task's limit, until its worker counts as hung

struct Slot {
  bool ready = false;
  const StudyTask* task = nullptr;
  Clock::time_point until = {};
};

struct Crew {
  const WorkerCommand* command = nullptr;
  std::unique_ptr<WorkerChannel> channel;
  std::vector<Slot> slots = {};
  int starts = 0;  // since it last answered
};

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

class TaskRunner {
 public:
  TaskRunner(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
             const RunOptions& options)
      : study_(study), journal_(journal), options_(options) {
    std::set<std::string> known;
    for (const StudyTask& task : tasks)
      if (known.insert(task.hash).second) take(task);
    progress_.before = progress_.done;
  }

  RunProgress run() {
    for (const WorkerCommand& command : options_.workers) crews_.push_back({&command, nullptr});
    if (!queue_.empty())
      for (Crew& crew : crews_) start(crew);
    bool go_on = report();
    while (go_on && progress_.done < progress_.tasks) {
      if (crews_.empty()) throw std::runtime_error("no worker is left; " + last_trouble_);
      wait();
      give_out();
      go_on = report();
    }
    return progress_;
  }

 private:
  void take(const StudyTask& task) {
    ++progress_.tasks;
    if (const auto outcome = journal_.find(task.hash))
      count(*outcome);
    else
      queue_.push_back(&task);
  }

  void count(const TaskOutcome& outcome) {
    ++progress_.done;
    if (outcome.state == TaskOutcome::State::failed) ++progress_.failed;
    if (outcome.state == TaskOutcome::State::not_good) ++progress_.not_good;
  }

  bool report() {
    progress_.elapsed_s = since(begin_);
    return !options_.report || options_.report(progress_);
  }

  void start(Crew& crew) {
    crew.slots.assign(static_cast<std::size_t>(crew.command->slots), {});
    crew.channel.reset();
    ++crew.starts;
    crew.channel = std::make_unique<WorkerChannel>(*crew.command);
  }

  void wait() {
    std::vector<pollfd> files;
    for (const Crew& crew : crews_) files.push_back({crew.channel->output(), POLLIN, 0});
    poll(files.data(), files.size(), 1000);
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (files[i].revents != 0) listen(crews_[i]);
      if (crews_[i].channel->ended() || hangs(crews_[i])) restart(crews_[i]);
    }
    crews_.erase(std::remove_if(crews_.begin(), crews_.end(), [](const Crew& crew) { return !crew.channel; }),
                 crews_.end());
  }

  void listen(Crew& crew) {
    for (const std::string& line : crew.channel->receive()) {
      const Json message = Json::parse(line, nullptr, false);
      const int place = message.is_object() ? message.value("slot", -1) : -1;
      if (place < 0 || place >= crew.command->slots) continue;  // what a login prints
      Slot& slot = crew.slots[static_cast<std::size_t>(place)];
      message.contains("version") ? greet(crew, slot, message) : finish(crew, slot, message);
    }
  }

  void greet(const Crew& crew, Slot& slot, const Json& message) {
    if (message.at("version") != options_.version)
      throw std::runtime_error("worker on " + crew.command->name + ": its program " + study_.program +
                               " is another version than here; install the same");
    slot.ready = true;
  }

  void finish(Crew& crew, Slot& slot, const Json& message) {
    if (!slot.task || message.at("hash") != slot.task->hash) return;
    if (message.contains("refused"))
      throw std::runtime_error("worker on " + crew.command->name + ": " + message.at("refused").get<std::string>());
    const StudyTask& task = *std::exchange(slot.task, nullptr);
    crew.starts = 0;
    if (message.contains("lost")) return again(task, message.at("lost"));
    record({task.hash, state_named(message.at("state")), message.at("reason"),
            message.contains("result") ? message.at("result").dump() : "", message.at("wall_s")});
  }

  void record(const TaskOutcome& outcome) {
    journal_.add(outcome);
    count(outcome);
  }

  void again(const StudyTask& task, const std::string& why) {
    if (++attempts_[task.hash] < kMostAttempts) return queue_.push_front(&task);
    record({task.hash, TaskOutcome::State::failed, "given up after " + std::to_string(kMostAttempts) + " times: " + why,
            "", 0.0});
  }

  static bool hangs(const Crew& crew) {
    return std::any_of(crew.slots.begin(), crew.slots.end(),
                       [](const Slot& slot) { return slot.task && Clock::now() > slot.until; });
  }

  void restart(Crew& crew) {
    last_trouble_ = "the worker on " + crew.command->name + (crew.channel->ended() ? " ended" : " does not answer");
    if (options_.warn) options_.warn(last_trouble_);
    for (Slot& slot : crew.slots)
      if (slot.task) again(*std::exchange(slot.task, nullptr), last_trouble_);
    crew.channel.reset();
    if (crew.starts < kMostStarts) start(crew);
  }

  // Whoever is idle gets the next task; none is given out twice at a time.
  void give_out() {
    for (Crew& crew : crews_)
      for (std::size_t i = 0; i < crew.slots.size() && !queue_.empty(); ++i) {
        Slot& slot = crew.slots[i];
        if (!slot.ready || slot.task) continue;
        slot.task = queue_.front();
        queue_.pop_front();
        slot.until =
            Clock::now() + std::chrono::milliseconds(static_cast<long>(1e3 * (study_.time_limit_s + kGrace_s)));
        Json request = task_request(study_, *slot.task);
        request["hash"] = slot.task->hash;
        request["slot"] = i;
        crew.channel->send(request.dump());  // where it is gone, its end is heard next
      }
  }

  const StudySettings& study_;
  Journal& journal_;
  const RunOptions& options_;
  Clock::time_point begin_ = Clock::now();
  RunProgress progress_;
  std::deque<const StudyTask*> queue_;
  std::map<std::string, int> attempts_;
  std::vector<Crew> crews_;
  std::string last_trouble_;
};

}  // namespace

RunProgress run_tasks(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
                      const RunOptions& options) {
  std::signal(SIGPIPE, SIG_IGN);  // a worker that is gone shows at its end of the pipe
  return TaskRunner(study, tasks, journal, options).run();
}

}  // namespace soft_robot_lab
