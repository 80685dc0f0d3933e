#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# new_rig_test.sh NEW_RIG: a robot of one's own gets its rig, and the session that new_rig names runs, emulated: one command moves the
# robot on the rig, and cameras see it. Whatever stands in the folder's name.
set -euo pipefail
launch=$(cd "$(dirname "$0")/../../launch" && pwd)
new_rig=$1
. "$launch/own_session.sh"
fail() { echo "new_rig: $*" >&2; exit 1; }
mkdir "$folder/it's my lab"
cd "$folder/it's my lab"
"$launch/new_robot.sh" finger >/dev/null
"$new_rig" finger.yaml >said 2>&1 || fail "it failed: $(cat said)"
! grep warning said || fail "it warns of a robot that all cameras see"
command=$(sed -n 's/^an emulated session *//p' said)
eval "${command/roslaunch/roslaunch -p $master_port}" rviz:=false camera_rate_hz:=2 camera_poses:=/no_such_folder/poses.yaml >log 2>&1 &
session=$!

# Where topic $1 has the tip, x [mm]; nothing where it is not known yet.
tip_mm() {
  timeout 20 rostopic echo -n 1 "$1" 2>/dev/null | /usr/bin/python3 -c '
import sys, yaml
message = next(yaml.safe_load_all(sys.stdin), None)
if message and "tip" in message["names"]:
    print(round(1000 * message["positions"][message["names"].index("tip")]["x"]))' || true
}
is_seen() { [[ -n $(tip_mm /tracker/markers) ]]; }
is_pulled() {
  timeout 20 rostopic pub -1 /actuators/command soft_robot_lab/ActuatorCommand '{names: [front], values: [0.85]}' >/dev/null 2>&1 || true
  local there; there=$(tip_mm /plant/markers)
  [[ -n $there ]] && ((there > 5))
}
follows() { local seen real; seen=$(tip_mm /tracker/markers) real=$(tip_mm /plant/markers); [[ -n $seen && -n $real ]] && ((seen - real < 6 && real - seen < 6 && seen > 5)); }
wait_for is_seen || fail "the session ended: $(tail log)"
wait_for is_pulled || fail "the robot on the rig does not move: $(tail log)"
wait_for follows || fail "cameras do not see where it went: $(tail log)"
