#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# install_test.sh BUILD PREFIX: installs into a temporary folder, whose name has a space and a letter beyond ASCII, from where
# programs, launch files, messages and plugins are found, programs read the config that lies there, and a session runs.
set -euo pipefail
build=$1 prefix=$2
top=$(mktemp -d) session=
trap '[[ -z $session ]] || kill -INT "$session" && wait "$session" || true; rm -rf "$top"' EXIT
root="$top/größe 1"
DESTDIR=$root cmake --install "$build" --strip >"$top/log" || { tail "$top/log"; exit 1; }
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
port=$("$here/lib/soft_robot_lab/free_port.py")
export ROS_MASTER_URI=http://127.0.0.1:$port HOME="$root/home"
mkdir "$HOME"
set -m
roslaunch -p "$port" soft_robot_lab session.launch robot:=hanging_bar cameras:=rendered rviz:=false record:=true bag_folder:="$root/bags" \
  >"$top/log" 2>&1 &
session=$!
set +m
# On a busy machine rostopic itself takes seconds to start; without a master it ends at once.
tracked=
for ((i = 0; i < 120; ++i)); do
  kill -0 "$session" 2>/dev/null || break
  ! timeout 60 rostopic echo -n 1 /tracker/markers >/dev/null 2>&1 || { tracked=yes && break; }
  sleep 0.5
done
[[ -n $tracked ]] || { tail -n 20 "$top/log"; fail "a session tracks nothing"; }
kill -INT "$session"
wait "$session" || fail "roslaunch ended with status $?"
session=
rosbag info "$root"/bags/*.bag >"$top/log" || fail "no whole bag"
