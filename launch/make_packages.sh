#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# make_packages.sh FOLDER: builds Debian packages for the machine's own release into a folder: soft-robot-lab (nodes, programs, robots),
# soft-robot-lab-dev (headers), soft-robot-lab-study (experiments and charts) and python3-soft-robot-lab.
# Another machine installs them by `apt install FOLDER/*.deb`.
set -euo pipefail
launch=$(cd "$(dirname "$0")" && pwd)
. "$launch/usage.sh"
usage 1 1 "$@"
output=$(mkdir -p "$1" && cd "$1" && pwd)
package=$(dirname "$launch")
build=$package/build/packages
"$launch/install_dependencies.sh"
command -v dpkg-shlibdeps >/dev/null || { echo "make_packages.sh: dpkg-shlibdeps is missing: apt-get install dpkg-dev" >&2; exit 1; }
! command -v ninja >/dev/null || export CMAKE_GENERATOR=${CMAKE_GENERATOR-Ninja}
! command -v clang++ >/dev/null || export CXX=${CXX-clang++}
cmake -S "$package" -B "$build" -DSOFT_ROBOT_LAB_TESTS=OFF -DSOFT_ROBOT_LAB_LINES=OFF -DCMAKE_INSTALL_PREFIX=/usr -DCATKIN_BUILD_BINARY_PACKAGE=ON
cmake --build "$build" -j"${JOBS:-$(nproc)}"
(cd "$build" && umask 022 && cpack -B "$build/cpack")
cp "$build"/cpack/*.deb "$output"
ls -l "$output"/*.deb
