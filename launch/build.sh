#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# build.sh [TARGET...]: builds the package into build/ beside this folder, or of it `session`, all that sessions need, or
# `demonstration`, what demo.sh needs; fast when nothing changed.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
usage 0 100 "$@"
package=$(cd "$(dirname "$0")/.." && pwd)
# Of a new folder: Ninja waits for no library before it compiles what links it, and Clang takes less time than GCC.
! command -v ninja >/dev/null || export CMAKE_GENERATOR=${CMAKE_GENERATOR-Ninja}
! command -v clang++ >/dev/null || export CXX=${CXX-clang++}
cmake -S "$package" -B "$package/build"
cmake --build "$package/build" -j"${JOBS:-$(nproc)}" --target "${@:-all}"
