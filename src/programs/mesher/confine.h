// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// What this process can do no more, whatever a file makes Gmsh do: start programs or processes, open connections, write
// or make files outside of the folder, or take more than limits::kMemory_gb. Each is done as far as the kernel lets it
// be done: seccomp needs Linux 3.17, and some containers refuse it; Landlock needs Linux 5.13.
void confine_to(const std::string& folder);

// Whether the address sanitiser is built in, which needs terabytes of addresses, and for its search for leaks ptrace:
// then neither is limited.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitisesAddresses = true;
#elif defined(__has_feature)
inline constexpr bool kSanitisesAddresses = __has_feature(address_sanitizer);
#else
inline constexpr bool kSanitisesAddresses = false;
#endif

}  // namespace soft_robot_lab
