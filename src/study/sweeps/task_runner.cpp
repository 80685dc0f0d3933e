// SPDX-License-Identifier: BSD-3-Clause
#include "task_runner.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <stdexcept>

#include <poll.h>

#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostSlots = limits::kThreads;  // of one command
constexpr int kMostStarts = 3;                        // of a worker that never answers
constexpr double kGrace_s = 60.0;                     // beyond a task's limit, until its worker counts as hung

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

class TaskRunner {
 public:
  TaskRunner(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
             const RunOptions& options)
      : study_(study), options_(options), ledger_(tasks, journal, options.report) {}

  StudyProgress run() {
    for (const WorkerCommand& command : options_.workers) crews_.push_back({&command, nullptr});
    if (!ledger_.open.empty())
      for (Crew& crew : crews_) start(crew);
    bool go_on = ledger_.report();
    while (go_on && !ledger_.all_done()) {
      if (crews_.empty()) throw std::runtime_error("no worker is left; " + last_trouble_);
      wait();
      give_out();
      go_on = ledger_.report();
    }
    return ledger_.progress();
  }

 private:
  void start(Crew& crew) {
    crew.slots.clear();
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
      const auto slot = message.is_object() ? message.find("slot") : message.end();
      if (slot == message.end() || !slot->is_number_unsigned()) continue;  // what a login prints
      const std::size_t place = *slot;
      if (message.contains("version")) greet(crew, place, message);
      if (message.contains("hash") && place < crew.slots.size()) finish(crew, crew.slots[place], message);
    }
  }

  void greet(Crew& crew, std::size_t place, const Json& message) {
    if (message.at("version") != options_.version)
      throw std::runtime_error("worker on " + crew.command->name + ": its program " + study_.program +
                               " is another version than here; install the same");
    if (place >= kMostSlots)
      throw std::runtime_error("more than " + std::to_string(kMostSlots) + " workers in one job");
    if (place >= crew.slots.size()) crew.slots.resize(place + 1);
    crew.slots[place].ready = true;
  }

  void finish(Crew& crew, Slot& slot, const Json& message) {
    if (!slot.task || message.at("hash") != slot.task->hash) return;
    if (message.contains("refused"))
      throw std::runtime_error("worker on " + crew.command->name + ": " + message.at("refused").get<std::string>());
    const StudyTask& task = *std::exchange(slot.task, nullptr);
    crew.starts = 0;
    if (message.contains("lost")) return again(task, message.at("lost"));
    if (const auto outcome = outcome_of(message)) ledger_.record(*outcome);
  }

  void again(const StudyTask& task, const std::string& why) {
    if (ledger_.may_run_again(task, why)) ledger_.open.push_front(&task);
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
      for (std::size_t i = 0; i < crew.slots.size() && !ledger_.open.empty(); ++i) {
        Slot& slot = crew.slots[i];
        if (!slot.ready || slot.task) continue;
        slot.task = ledger_.open.front();
        ledger_.open.pop_front();
        slot.until =
            Clock::now() + std::chrono::milliseconds(static_cast<long>(1e3 * (study_.time_limit_s + kGrace_s)));
        Json request = task_request(study_, *slot.task);
        request["hash"] = slot.task->hash;
        request["slot"] = i;
        crew.channel->send(request.dump());  // where it is gone, its end is heard next
      }
  }

  const StudySettings& study_;
  const RunOptions& options_;
  TaskLedger ledger_;
  std::vector<Crew> crews_;
  std::string last_trouble_;
};

}  // namespace

StudyProgress run_tasks(const StudySettings& study, const std::vector<StudyTask>& tasks, Journal& journal,
                        const RunOptions& options) {
  std::signal(SIGPIPE, SIG_IGN);  // a worker that is gone shows at its end of the pipe
  return TaskRunner(study, tasks, journal, options).run();
}

}  // namespace soft_robot_lab
