#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# run.sh: installs what is missing, builds, and runs every test: the parts without ROS under the address and
# undefined-behaviour sanitisers, then everything. Works from any folder; a second run builds only what changed.
#   run.sh --all   afterwards runs what takes longer too: every experiment with its checks, all bad scenes, messages and
#                  bags, an hour's session, what is long under the sanitisers, and threads under theirs. Writes
#                  test/nightly/last_result.md
set -euo pipefail
package=$(cd "$(dirname "$0")/.." && pwd)
jobs=${JOBS:-2}
case "${1-}" in
  '') all= ;;
  --all) all=yes ;;
  *) echo "usage: run.sh [--all]" >&2; exit 2 ;;
esac
"$package/launch/install_dependencies.sh" ${all:+--all}
export CMAKE_GENERATOR=${CMAKE_GENERATOR-Ninja} # of new folders; it waits for no library before it compiles what links it
compiler=${CXX-clang++} # of new folders too; it takes less time than GCC

# The parts without ROS are tested under the sanitisers; with --all also as they are used.
settings=(-DSOFT_ROBOT_LAB_WARNINGS_ARE_ERRORS="${WARNINGS_ARE_ERRORS:-OFF}" -DSOFT_ROBOT_LAB_LINES="${LINES_IN_BACKTRACES:-ON}")
CXX=$compiler cmake -S "$package" -B "$package/build" -DSOFT_ROBOT_LAB_CORE_TESTS=${all:-no} "${settings[@]}"
JOBS=$jobs "$package/launch/build.sh"
CXX=$compiler cmake -S "$package" -B "$package/build/sanitise" -DSOFT_ROBOT_LAB_CORES_ONLY=ON -DSOFT_ROBOT_LAB_SANITISE=ON -DSOFT_ROBOT_LAB_STUDY=OFF "${settings[@]}"
cmake --build "$package/build/sanitise" -j"$jobs"
# The other BLAS kernels than those this machine takes by itself: their rounding differs, and no test may hang on it.
grep -q avx512 /proc/cpuinfo && other=Haswell || other=Prescott
OPENBLAS_CORETYPE=$other ctest --test-dir "$package/build/sanitise" --output-on-failure -j"$jobs"
unset ROS_HOSTNAME
export ROS_IP=127.0.0.1 # the machine's own name need not resolve
ctest --test-dir "$package/build" --output-on-failure -j$((jobs + 2)) # whole sessions count twice
[[ -n $all ]] || exit 0

status=0
ctest --test-dir "$package/build" -C nightly -L nightly --output-on-failure || status=$?
ctest --test-dir "$package/build/sanitise" -C nightly -L nightly --output-on-failure -j"$jobs" || status=$?
JOBS=$jobs "$package/test/check_threads.sh" "$package/build/thread" || status=$?
{
  echo "# What the nightly suite found last"
  echo
  echo "\`./test/run.sh --all\` on $(date -u +%Y-%m-%d), with the code of $(git -C "$package" rev-parse --short HEAD 2>/dev/null || echo 'no repository')."
  echo
  cat "$package/build/nightly/experiments.md"
} >"$package/test/nightly/last_result.md"
exit "$status"
