#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# install_test.sh BUILD PREFIX: installs into a temporary folder, from where programs, launch files, messages and plugins are
# found, and programs read the config that lies there.
set -euo pipefail
build=$1 prefix=$2
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
DESTDIR=$root cmake --install "$build" --strip >"$root/log" || { tail "$root/log"; exit 1; }
here=$root$prefix
package=$here/share/soft_robot_lab
fail() { echo "installed: $*" >&2; exit 1; }
# says WORD COMMAND...: not by a pipe, which a command that says more after the word would find closed.
says() { local word=$1 said; shift; said=$("$@") && [[ $said == *"$word"* ]]; }

unset LD_LIBRARY_PATH
export CMAKE_PREFIX_PATH=$here ROS_PACKAGE_PATH=$here/share PYTHONPATH=$here/lib/python3/dist-packages ROS_IP=127.0.0.1
[[ $(rospack find soft_robot_lab) == "$package" ]] || fail "rospack does not find the package"
says "$package/config/actuator_plugins.xml" rospack plugins --attrib=plugin soft_robot_lab || fail "no plugins"
[[ ! -e $package/config/doc ]] || fail "pictures of the documentation are installed"
says names rosmsg show soft_robot_lab/ActuatorCommand || fail "no messages"
for launch in session.launch motor.launch; do
  says "$package/launch/$launch" roslaunch --files soft_robot_lab "$launch" emulated:=true || fail "no $launch"
done
# Every program and script that the launch files start.
for type in $(grep -ho 'pkg="soft_robot_lab" type="[^"]*"' "$package"/launch/*.launch | sed 's/.*type="//; s/"//' | sort -u); do
  [[ -x $here/lib/soft_robot_lab/$type ]] || fail "no $type"
done
for program in "$here"/lib/soft_robot_lab/*; do
  missing=$(ldd "$program" 2>/dev/null | grep 'not found\|/devel/' || true)
  [[ -z $missing ]] || fail "$program: $missing"
done
says SCENE rosrun soft_robot_lab simulate --help || fail "simulate does not start"
# Where this build's own sources are at hand too, those beside the program come first.
echo "colour: green" >"$package/config/experiments/cantilever.yaml"
said=$(rosrun soft_robot_lab experiment cantilever 2>&1) && fail "experiment read other settings"
grep -qF "$package/config/experiments/cantilever.yaml" <<<"$said" || fail "experiment says: $said"
