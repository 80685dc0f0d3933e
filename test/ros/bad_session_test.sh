#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# bad_session_test.sh ERROR STATUS ARGUMENT...: a session of such arguments ends by itself with that status, says ERROR, and
# leaves nothing behind. The status is 1 where something is refused before nodes start; whatever they end with, it is 0, but where a
# busy machine lets a node end while roslaunch still starts others.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
error=$1 expected=$2
shift 2
. "$here/../../launch/environment.sh"
said=$(mktemp)
trap 'rm -f "$said"; pkill -f -- "rosmaster --core -p $master_port " || true' EXIT
status=0
timeout --signal=INT --kill-after=5 60 roslaunch -p "$master_port" soft_robot_lab session.launch rviz:=false "$@" \
  >"$said" 2>&1 || status=$?
cat "$said"
((status != 124 && status != 137)) || { echo "roslaunch had to be stopped"; exit 1; }
if ((expected == 0)) && grep -qF "after process monitor has been shut down" "$said"; then expected=1; fi
((status == expected)) || { echo "status $status"; exit 1; }
! pgrep -f -- "rosmaster --core -p $master_port " >/dev/null || { echo "the master was left behind"; exit 1; }
grep -qF "$error" "$said"
