#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds test/example_plugin as a stranger would, and runs its own test, a session with it:
#   example_plugin_test.sh devel SETUP             against the devel space of SETUP
#   example_plugin_test.sh install BUILD PREFIX    against what BUILD installs, moved from PREFIX
#   example_plugin_test.sh workspace               in a catkin workspace that builds both packages whole; then against the
#                                                  install space of that workspace
set -euo pipefail
package=$(cd "$(dirname "$0")/../.." && pwd)
mode=$1
work=$(mktemp -d) # not in the package, where roslaunch would find the installed launch files too
trap 'rm -rf "$work"' EXIT
cp -r "$package/test/example_plugin" "$work/example_plugin" # it needs nothing of where it lay
unset ROS_HOSTNAME ROS_NAMESPACE LD_LIBRARY_PATH CMAKE_PREFIX_PATH ROS_PACKAGE_PATH PYTHONPATH
export ROS_IP=127.0.0.1
python=(-DPYTHON_EXECUTABLE=/usr/bin/python3 -DPython3_EXECUTABLE=/usr/bin/python3)

enter() { # SETUP: not written for -u
  set +u
  . "$1"
  set -u
}

build_and_run() { # BUILD: in the space that was entered
  cmake -S "$work/example_plugin" -B "$1" "${python[@]}" -DCMAKE_BUILD_TYPE=RelWithDebInfo
  cmake --build "$1"
  run "$1"
}

run() { # BUILD
  local listed
  listed=$(ctest --test-dir "$1" -N)
  grep -q "Total Tests: 1" <<<"$listed" || { echo "not one test: $listed"; exit 1; }
  ctest --test-dir "$1" --output-on-failure
}

case $mode in
  devel)
    enter "$2"
    build_and_run "$work/build"
    ;;
  install)
    DESTDIR=$work/root cmake --install "$2" --strip >"$work/install.log" || { tail "$work/install.log"; exit 1; }
    here=$work/root$3
    export CMAKE_PREFIX_PATH=$here ROS_PACKAGE_PATH=$here/share PYTHONPATH=$here/lib/python3/dist-packages
    build_and_run "$work/build"
    ! grep -qF "$package/include" "$work/build/compile_commands.json" || { echo "built with headers of the sources"; exit 1; }
    ;;
  workspace)
    mkdir "$work/src"
    ln -s "$package" "$work/src/soft_robot_lab"
    ln -s "$work/example_plugin" "$work/src/example_plugin"
    catkin_make -C "$work" -j"${JOBS:-2}" "${python[@]}" -DSOFT_ROBOT_LAB_TESTS=OFF -DSOFT_ROBOT_LAB_STUDY=OFF
    catkin_make -C "$work" -j"${JOBS:-2}" install
    (enter "$work/devel/setup.bash" && run "$work/build/example_plugin")
    rm -rf "$work/build" "$work/devel"
    enter "$work/install/setup.bash"
    [[ $(rospack plugins --attrib=plugin soft_robot_lab) == *"$work/install/share/example_plugin/actuators.xml"* ]] ||
      { echo "the installed plugin is not found"; exit 1; }
    build_and_run "$work/build"
    ;;
esac
