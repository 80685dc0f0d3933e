#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# new_robot_test.sh SIMULATE: new_robot.sh writes a robot that can be simulated and viewed, and overwrites nothing.
set -euo pipefail
launch=$(cd "$(dirname "$0")/../../launch" && pwd)
simulate=$1
. "$launch/own_session.sh"
fail() { echo "new_robot: $*" >&2; exit 1; }
cd "$folder"

"$launch/new_robot.sh" finger >said || fail "it failed"
grep -qF "$folder/finger.yaml" said || fail "it does not name the file"
echo "# mine" >>finger.yaml
! "$launch/new_robot.sh" finger 2>said || fail "it wrote over a file"
grep -q "there already" said && grep -q "# mine" finger.yaml || fail "it does not name the reason"
! "$launch/new_robot.sh" "../other" 2>/dev/null || fail "it took a path for a name"
"$simulate" finger.yaml --result result.json >said || fail "the robot does not converge"
grep -q "moved \[2[0-9]\." said || fail "the tip does not move by 20 to 30 mm: $(cat said)"

! "$launch/view.sh" missing.yaml 2>said || fail "a missing file is viewed"
grep -q "cannot be read" said || fail "view.sh does not name the reason"
roslaunch -p "$master_port" soft_robot_lab view.launch scene:="$folder/finger.yaml" rviz:=false >log 2>&1 &
session=$!
wait_for has_markers || fail "view.launch ended: $(tail log)"
timeout 60 rostopic echo -n 1 /simulator/actuator_ranges | grep -q front || fail "no sliders for the cables"
