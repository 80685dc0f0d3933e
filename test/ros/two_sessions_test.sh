#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# two_sessions_test.sh: two robots in two namespaces under one master move apart from one another, with frames of
# their own, and their lamps are green. A session that would take the place of one that runs is refused, and that one goes on.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/own_session.sh"
fail() { echo "two sessions: $*" >&2; tail "$folder/log" >&2; exit 1; }
hear() { timeout 60 rostopic echo -n 1 "$@"; }
roslaunch -p "$master_port" "$here/two_sessions.launch" folder:="$folder/bags" >"$folder/log" 2>&1 &
session=$!
have_controllers() {
  local services
  services=$(rosservice list 2>/dev/null || true)
  [[ $services == */left/controller/optimise_policy* && $services == */right/controller/optimise_policy* ]]
}
wait_for have_controllers || fail "the sessions ended"
[[ $(hear /left/simulator/scene) == *cable_bar.yaml* ]] || fail "the left robot is not its own"
[[ $(hear /right/simulator/scene) == *cable_bar_soft.yaml* ]] || fail "the right robot is not its own"

before=$(hear /right/simulator/actuators/commands)
for ((i = 0; i < 20; ++i)); do
  timeout 60 rostopic pub -1 /left/actuators/command soft_robot_lab/ActuatorCommand '{names: [left], values: [0.9]}' >"$folder/said"
  [[ $(hear /left/simulator/actuators/commands) == *0.9,* ]] && break
done
((i < 20)) || fail "the left robot does not move"
[[ $(hear /right/simulator/actuators/commands) == "$before" ]] || fail "the right robot moves too"

# The right robot stands beside the left one: 0.2 m on, in one tree.
frames=$(PYTHONUNBUFFERED=1 timeout 20 rostopic echo -n 2 /tf_static)
for frame in 'frame_id: "left/world"' 'frame_id: "left/robot_base"' 'frame_id: "right/robot_base"' 'x: 0.2'; do
  grep -qF "$frame" <<<"$frames" || fail "no $frame in /tf_static: $frames"
done
[[ $(hear /right/simulator/markers/header/frame_id) == *right/robot_base* ]] || fail "the right robot's frame has no prefix"
[[ $(hear /tf) == */simulated/tip* ]] || fail "no frame of a marker"

# A second session in the left namespace is refused.
processes() { rosnode info /left/{simulator,controller,overlay,recorder,session_watch} 2>/dev/null | grep '^Pid'; }
first=$(processes)
status=0
ROS_NAMESPACE=left timeout 100 roslaunch -p "$master_port" soft_robot_lab session.launch robot:=hammerbot wall_clock:=true rviz:=false \
  record:=true bag_folder:="$folder/other" >"$folder/second" 2>&1 || status=$?
# roslaunch itself fails where its first node ends before it started the last.
((status != 124)) || fail "a second session ran on"
grep -q "/left/simulator runs already, as process" "$folder/second" || fail "the second session did not say why: $(cat "$folder/second")"
[[ $(processes) == "$first" && $(wc -l <<<"$first") == 5 ]] || fail "the second session ended nodes of the first: $first"
[[ $(hear /left/simulator/scene) == *cable_bar.yaml* ]] || fail "the left robot is another"
[[ ! -e $folder/other ]] || fail "the second session recorded"

# One subscriber that reads on: asked anew for a single message, it may hear the same other node each time.
is_green() {
  awk -v RS='---\n' -v lamp="$1/session_watch: session" \
    'index($0, lamp) && /controller runs/ { found = 1; exit } END { exit !found }' \
    < <(PYTHONUNBUFFERED=1 timeout 120 rostopic echo /diagnostics 2>/dev/null)
}
for name in left right; do
  is_green "$name" || fail "no green lamp of $name"
done
