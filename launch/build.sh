#!/bin/bash
# build.sh [CMAKE_OPTION...]: builds the package into build/ beside this folder; fast when nothing changed.
set -euo pipefail
package=$(cd "$(dirname "$0")/.." && pwd)
cmake -S "$package" -B "$package/build" "$@"
cmake --build "$package/build" -j"${JOBS:-$(nproc)}"
