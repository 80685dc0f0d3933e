// SPDX-License-Identifier: BSD-3-Clause
#include "guarded.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <thread>

namespace soft_robot_lab {
namespace {

const char* const kOutcomes[] = {"crash",    "accepted",          "refused",       "refused without reason",
                                 "nonsense", "strange exception", "out of memory", "hang"};
enum Outcome { crash, accepted, refused, no_reason, nonsense, strange, out_of_memory, hang };

// What the two processes share: the number of the case that runs, then the outcome of each.
class Shared {
 public:
  explicit Shared(std::size_t count)
      : size_((1 + count) * sizeof(std::atomic<std::size_t>)),
        memory_(mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::runtime_error("no shared memory");
  }
  ~Shared() { munmap(memory_, size_); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  std::atomic<std::size_t>& at() const { return numbers()[0]; }
  std::atomic<std::size_t>& outcome(std::size_t i) const { return numbers()[1 + i]; }

 private:
  std::atomic<std::size_t>* numbers() const { return static_cast<std::atomic<std::size_t>*>(memory_); }

  std::size_t size_;
  void* memory_;
};

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) + 1.0;
}

Outcome outcome_of(const std::function<void(std::size_t)>& run, std::size_t i, std::string& reason) {
  try {
    run(i);
    return accepted;
  } catch (const std::bad_alloc&) {
    return out_of_memory;
  } catch (const Nonsense& error) {
    reason = error.what();
    return nonsense;
  } catch (const std::invalid_argument& error) {
    return *error.what() ? refused : no_reason;
  } catch (const std::runtime_error& error) {
    return *error.what() ? refused : no_reason;
  } catch (const std::exception& error) {
    reason = error.what();
    return strange;
  } catch (...) {
    return strange;
  }
}

[[noreturn]] void run_from(std::size_t first, const GuardedCases& cases, const GuardLimits& limits,
                           const Shared& shared) {
  const auto memory = static_cast<rlim_t>(limits.memory_bytes);
  const rlimit space{memory, memory};
  setrlimit(RLIMIT_AS, &space);
  for (std::size_t i = first; i < cases.count; ++i) {
    shared.at() = i;
    const rlimit time{static_cast<rlim_t>(cpu_s() + limits.cpu_s), RLIM_INFINITY};
    setrlimit(RLIMIT_CPU, &time);
    std::string reason;
    const Outcome outcome = outcome_of(cases.run, i, reason);
    shared.outcome(i) = outcome;
    if (outcome > refused) std::printf("%s: %s: %s\n", kOutcomes[outcome], cases.name(i).c_str(), reason.c_str());
  }
  shared.at() = cases.count;
  std::fflush(nullptr);
  _exit(0);
}

// How the process ended that runs cases: of a hang, by SIGXCPU or, where it waits, by our hand.
int wait_for(pid_t child, const GuardLimits& limits, const Shared& shared) {
  int status = 0;
  std::size_t at = shared.at();
  auto since = std::chrono::steady_clock::now();
  while (waitpid(child, &status, WNOHANG) == 0) {
    const auto now = std::chrono::steady_clock::now();
    if (shared.at() != at) {
      at = shared.at();
      since = now;
    }
    if (std::chrono::duration<double>(now - since).count() > limits.wall_s) kill(child, SIGXCPU);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return status;
}

}  // namespace

std::map<std::string, int> run_guarded(const GuardedCases& cases, const GuardLimits& limits) {
  const Shared shared(cases.count);
  for (std::size_t first = 0; first < cases.count; first = shared.at() + 1) {
    std::fflush(nullptr);
    shared.at() = first;
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process to run cases in");
    if (child == 0) run_from(first, cases, limits, shared);
    const int status = wait_for(child, limits, shared);
    if (shared.at() == cases.count) break;
    const bool in_vain = WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU;
    shared.outcome(shared.at()) = in_vain ? hang : crash;
    std::printf("%s: %s\n", kOutcomes[in_vain ? hang : crash], cases.name(shared.at()).c_str());
  }
  std::map<std::string, int> counts;
  for (std::size_t i = 0; i < cases.count; ++i) ++counts[kOutcomes[shared.outcome(i)]];
  return counts;
}

bool all_good(const std::map<std::string, int>& counts) {
  bool good = true;
  for (const auto& [outcome, count] : counts) {
    std::printf("%6d %s\n", count, outcome.c_str());
    good = good && (outcome == kOutcomes[accepted] || outcome == kOutcomes[refused]);
  }
  return good;
}

int run_check(int argc, char** argv, const std::string& name, const std::function<bool(std::size_t)>& check) {
  const std::size_t part = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argc > 2 || part == 0) {
    std::fprintf(stderr, "usage: %s [PART]\n", name.c_str());
    return 2;
  }
  try {
    return check(part) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

}  // namespace soft_robot_lab
