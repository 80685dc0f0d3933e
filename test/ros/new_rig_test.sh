#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# new_rig_test.sh NEW_RIG ROBOT_SESSION_TEST: a robot of one's own gets its rig, and the session that new_rig names runs, emulated: one
# command moves the robot on the rig, and cameras see it, as in robot_session.test. Whatever stands in the folder's name.
set -euo pipefail
launch=$(cd "$(dirname "$0")/../../launch" && pwd)
new_rig=$1 session_test=$2
. "$launch/own_session.sh"
fail() { echo "new_rig: $*" >&2; exit 1; }
mkdir "$folder/it's my lab"
cd "$folder/it's my lab"
"$launch/new_robot.sh" finger >/dev/null
"$new_rig" finger.yaml >said 2>&1 || fail "it failed: $(cat said)"
! grep warning said || fail "it warns of a robot that all cameras see"
command=$(sed -n 's/^an emulated session *//p' said)
eval "exec ${command/roslaunch/roslaunch -p $master_port}" rviz:=false camera_rate_hz:=2 camera_poses:=/no_such_folder/poses.yaml >log 2>&1 &
session=$!
wait_for has_markers || fail "the session ended: $(tail log)"
"$session_test" _robot:=finger _emulated:=true >moved 2>&1 || fail "it does not move as it is commanded: $(cat moved) $(tail log)"
