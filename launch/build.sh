#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# build.sh [TARGET...]: builds the package, or `session` for all but the tests, into build/ beside this folder; fast when
# nothing changed.
set -euo pipefail
package=$(cd "$(dirname "$0")/.." && pwd)
# Of a new folder; it waits for no library before it compiles what links it.
! command -v ninja >/dev/null || export CMAKE_GENERATOR=${CMAKE_GENERATOR-Ninja}
cmake -S "$package" -B "$package/build"
cmake --build "$package/build" -j"${JOBS:-$(nproc)}" --target "${@:-all}"
