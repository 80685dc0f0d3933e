#!/bin/bash
# bad_session_test.sh ERROR ARGUMENT...: a session of such arguments ends by itself and says ERROR.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
error=$1
shift
. "$here/../../launch/environment.sh"
status=0
output=$(timeout --signal=INT 40 roslaunch -p "$master_port" soft_robot_lab session.launch rviz:=false "$@" 2>&1) || status=$?
echo "$output"
((status != 124)) || { echo "roslaunch had to be stopped"; exit 1; }
grep -qF "$error" <<<"$output"
