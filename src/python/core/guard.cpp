// SPDX-License-Identifier: BSD-3-Clause
#include "guard.h"

#include <stdexcept>

#include <pthread.h>

namespace soft_robot_lab {
namespace {

unsigned forks = 0;  // of which this process is the child

unsigned count_forks() {
  static const int heard = pthread_atfork(nullptr, nullptr, [] { ++forks; });
  return heard == 0 ? forks : 0;
}

}  // namespace

void SignalWatch::begin() {
  caller_ = std::this_thread::get_id();
  asked_ = false;
  last_ = std::chrono::steady_clock::now();
}

bool SignalWatch::asked() {
  if (asked_ || std::this_thread::get_id() != caller_) return asked_;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kBetweenAsking) return false;
  last_ = now;
  const pybind11::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) asked_ = true;  // what it threw waits in this thread for end()
  return asked_;
}

void SignalWatch::end() {
  if (asked_) throw pybind11::error_already_set();
}

Guarded::Guarded() : forks_(count_forks()) {}

Guarded::Use::Use(Guarded& object) : object_(object) {
  if (object.forks_ != forks)
    throw std::runtime_error("made before a fork: make it anew in this process, or start processes by 'spawn'");
  if (object.busy_.exchange(true))
    throw std::runtime_error("in use by another thread: give each thread its own clone()");
}

}  // namespace soft_robot_lab
