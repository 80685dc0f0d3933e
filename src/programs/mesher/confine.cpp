// SPDX-License-Identifier: BSD-3-Clause
#include "confine.h"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdint>
#include <new>
#include <vector>

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kMachine = 0;  // no filter
#endif

using Filter = std::vector<sock_filter>;

void load(std::size_t place, Filter& filter) {
  filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(place)));
}
void answer(std::uint32_t value, Filter& filter) { filter.push_back(BPF_STMT(BPF_RET | BPF_K, value)); }
// Answers where the loaded word is `value`.
void answer_if(std::uint32_t value, std::uint32_t with, Filter& filter) {
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1));
  answer(with, filter);
}

// Threads share this process's memory, and so does the leak sanitiser's helper; a process of its own does not.
void refuse_processes(Filter& filter) {
  constexpr std::uint32_t refused = SECCOMP_RET_ERRNO | EPERM;
  answer_if(__NR_clone3, SECCOMP_RET_ERRNO | ENOSYS,
            filter);  // its flags lie in memory; the C library then takes clone
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_clone, 0, 4));
  load(offsetof(seccomp_data, args), filter);  // the lower half, where the lowest byte comes first
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_VM, 0, 1));
  answer(SECCOMP_RET_ALLOW, filter);
  answer(refused, filter);
}

Filter system_calls() {
  constexpr std::uint32_t refused = SECCOMP_RET_ERRNO | EPERM;
  Filter filter;
  load(offsetof(seccomp_data, arch), filter);
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kMachine, 1, 0));
  answer(SECCOMP_RET_KILL, filter);  // calls of another machine have other numbers
  load(offsetof(seccomp_data, nr), filter);
#if defined(__x86_64__)
  constexpr std::uint32_t x32 = 0x40000000;
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, x32, 0, 1));
  answer(refused, filter);
  for (const int call : {__NR_fork, __NR_vfork}) answer_if(static_cast<std::uint32_t>(call), refused, filter);
#endif
  for (const int call : {__NR_execve, __NR_execveat, __NR_socket, __NR_connect, __NR_process_vm_writev})
    answer_if(static_cast<std::uint32_t>(call), refused, filter);
  if (!kSanitisesAddresses) answer_if(__NR_ptrace, refused, filter);
  refuse_processes(filter);
  answer(SECCOMP_RET_ALLOW, filter);
  return filter;
}

void forbid_processes() {
  if (kMachine == 0) return;
  Filter filter = system_calls();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

bool allow_beneath(const std::string& folder, std::uint64_t access, int set) {
  landlock_path_beneath_attr beneath{};
  beneath.allowed_access = access;
  beneath.parent_fd = open(folder.c_str(), O_PATH | O_CLOEXEC);
  if (beneath.parent_fd < 0) return false;
  const bool added = syscall(__NR_landlock_add_rule, set, LANDLOCK_RULE_PATH_BENEATH, &beneath, 0) == 0;
  close(beneath.parent_fd);
  return added;
}

void forbid_writing_outside(const std::string& folder) {
  landlock_ruleset_attr rules{};
  rules.handled_access_fs = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                            LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
                            LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK |
                            LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;
  constexpr std::uint64_t truncate = 1 << 14;  // LANDLOCK_ACCESS_FS_TRUNCATE, which Debian's headers do not know yet
  if (syscall(__NR_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) >= 3)
    rules.handled_access_fs |= truncate;
  const auto set = static_cast<int>(syscall(__NR_landlock_create_ruleset, &rules, sizeof rules, 0));
  if (set < 0) return;
  allow_beneath("/dev/shm", rules.handled_access_fs, set);  // where LLVM's OpenMP notes that it is loaded
  if (allow_beneath(folder, rules.handled_access_fs, set)) syscall(__NR_landlock_restrict_self, set, 0);
  close(set);
}

// The libraries here do not all survive that memory ends, nor say so: this is where it is said.
[[noreturn]] void end_without_memory() {
  std::fprintf(
      stderr,
      "meshing takes more than %g GB of memory; a larger element_size_m, fewer solids or a smaller file take less\n",
      limits::kMemory_gb);
  _exit(2);
}

void limit_memory() {
  std::set_new_handler(end_without_memory);
  if (kSanitisesAddresses) return;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(limits::kMemory_gb * 1e9));
  limit.rlim_max = limit.rlim_cur;
  setrlimit(RLIMIT_AS, &limit);
}

}  // namespace

void confine_to(const std::string& folder) {
  limit_memory();
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return;
  forbid_writing_outside(folder);
  forbid_processes();
}

}  // namespace soft_robot_lab
