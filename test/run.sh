#!/bin/bash
# run.sh: installs what is missing, builds, and runs every test: the parts without ROS under the address and
# undefined-behaviour sanitisers, then everything. Works from any folder; a second run builds only what changed.
set -euo pipefail
package=$(cd "$(dirname "$0")/.." && pwd)
jobs=${JOBS:-2}
"$package/launch/install_dependencies.sh"

JOBS=$jobs "$package/launch/build.sh"
cmake -S "$package" -B "$package/build/sanitise" -DSOFT_ROBOT_LAB_CORES_ONLY=ON -DSOFT_ROBOT_LAB_SANITISE=ON
cmake --build "$package/build/sanitise" -j"$jobs"
# The other BLAS kernels than those this machine takes by itself: their rounding differs, and no test may hang on it.
grep -q avx512 /proc/cpuinfo && other=Haswell || other=Prescott
OPENBLAS_CORETYPE=$other ctest --test-dir "$package/build/sanitise" --output-on-failure -j"$jobs"
unset ROS_HOSTNAME
export ROS_IP=127.0.0.1 # the machine's own name need not resolve
ctest --test-dir "$package/build" --output-on-failure -j"$jobs"
