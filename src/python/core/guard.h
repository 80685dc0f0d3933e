// SPDX-License-Identifier: BSD-3-Clause
// What stands between Python and a solve: one thread at a time, the process that made the object, and Ctrl-C.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <thread>
#include <type_traits>

#include <pybind11/pybind11.h>

namespace soft_robot_lab {

// Asks Python's handlers of signals while a solve runs without the interpreter's lock.
class SignalWatch {
 public:
  static constexpr std::chrono::milliseconds kBetweenAsking{20};

  void begin();  // with the lock held, by the thread that solves
  // From any thread, without the lock: whether a handler threw, as that of Ctrl-C does.
  bool asked();
  void end();  // with the lock held; throws what the handler threw

 private:
  std::atomic<bool> asked_{false};
  std::thread::id caller_;
  std::chrono::steady_clock::time_point last_;
};

// An object that Python holds. It serves one thread at a time, in the process that made it: a child of a fork has none
// of the threads that it may wait for.
class Guarded {
 public:
  Guarded();
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;

  // Throws std::runtime_error where another thread, or a handler of a signal within a solve, uses the object, and in
  // another process.
  class Use {
   public:
    explicit Use(Guarded& object);
    ~Use() { object_.busy_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    Guarded& object_;
  };

  SignalWatch& watch() { return watch_; }

  // Work in a thread of its own, for what asks watch() from other threads than the one that began it.
  template <class Work>
  auto beside(Work work) {
    return freely([&] {
      std::future<std::invoke_result_t<Work>> result = std::async(std::launch::async, work);
      while (result.wait_for(SignalWatch::kBetweenAsking) != std::future_status::ready) watch_.asked();
      return result.get();
    });
  }

  // Work without the interpreter's lock, which Ctrl-C ends where it asks watch().
  template <class Work>
  auto freely(Work work) {
    using Result = std::invoke_result_t<Work>;
    watch_.begin();
    try {
      if constexpr (std::is_void_v<Result>) {
        unlocked(work);
        watch_.end();
      } else {
        Result result = unlocked(work);
        watch_.end();
        return result;
      }
    } catch (const pybind11::error_already_set&) {
      throw;
    } catch (...) {
      watch_.end();
      throw;
    }
  }

 private:
  template <class Work>
  static auto unlocked(Work& work) {
    const pybind11::gil_scoped_release without_lock;
    return work();
  }

  SignalWatch watch_;
  std::atomic<bool> busy_{false};
  unsigned forks_;
};

}  // namespace soft_robot_lab
