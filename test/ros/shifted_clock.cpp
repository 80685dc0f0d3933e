// SPDX-License-Identifier: BSD-3-Clause
// Preloaded, it shows a program another wall clock: shifted by the seconds in the file SHIFTED_CLOCK, which may change
// at any time. What the machine counts from its start stays as it is.
#include <cstdint>
#include <cstdlib>

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

namespace {

const volatile std::int64_t* open_shift() {
  static const std::int64_t none = 0;
  const char* path = std::getenv("SHIFTED_CLOCK");
  const int file = path == nullptr ? -1 : open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0 || ftruncate(file, sizeof(std::int64_t)) != 0) return &none;
  void* place = mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
  close(file);
  return place == MAP_FAILED ? &none : static_cast<const std::int64_t*>(place);
}

std::int64_t shift_s() {
  static const volatile std::int64_t* shift = open_shift();
  return *shift;
}

template <typename Function>
Function real(const char* name, const char* version) {
  void* found = dlvsym(RTLD_NEXT, name, version);
  return reinterpret_cast<Function>(found != nullptr ? found : dlsym(RTLD_NEXT, name));
}

int real_time(clockid_t clock, timespec* time) {
  static const auto function = real<int (*)(clockid_t, timespec*)>("clock_gettime", "GLIBC_2.17");
  return function(clock, time);
}

std::int64_t distance_s(std::int64_t a, std::int64_t b) { return a < b ? b - a : a - b; }

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) {
  const int status = real_time(clock, time);
  if (status == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) time->tv_sec += shift_s();
  return status;
}

int gettimeofday(timeval* time, void*) {
  timespec now{};
  const int status = clock_gettime(CLOCK_REALTIME, &now);
  time->tv_sec = now.tv_sec;
  time->tv_usec = now.tv_nsec / 1000;
  return status;
}

time_t time(time_t* time) {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (time != nullptr) *time = now.tv_sec;
  return now.tv_sec;
}

// Of which clock a deadline is, only its size says.
int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* deadline) {
  static const auto function =
      real<int (*)(pthread_cond_t*, pthread_mutex_t*, const timespec*)>("pthread_cond_timedwait", "GLIBC_2.3.2");
  timespec shown{}, monotonic{}, real_deadline = *deadline;
  clock_gettime(CLOCK_REALTIME, &shown);
  real_time(CLOCK_MONOTONIC, &monotonic);
  if (distance_s(deadline->tv_sec, shown.tv_sec) < distance_s(deadline->tv_sec, monotonic.tv_sec))
    real_deadline.tv_sec -= shift_s();
  return function(condition, mutex, &real_deadline);
}
}
