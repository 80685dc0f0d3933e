#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# bad_session_test.sh ERROR ARGUMENT...: a session of such arguments ends by itself and says ERROR.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
error=$1
shift
. "$here/../../launch/environment.sh"
said=$(mktemp)
trap 'rm -f "$said"' EXIT
for attempt in 1 2 3; do
  status=0
  timeout --signal=INT --kill-after=5 40 roslaunch -p "$master_port" soft_robot_lab session.launch rviz:=false "$@" \
    >"$said" 2>&1 || status=$?
  cat "$said"
  # A race of roslaunch's own: where a node ends while it still starts others, it may hang, and leaves nodes behind.
  pkill -f -- "rosmaster --core -p $master_port " || true
  run=$(grep -om1 '[0-9a-f-]*/roslaunch-' "$said" | cut -d/ -f1) || true
  [[ -z $run ]] || pkill -f -- "__log:=.*/$run/" || true
  grep -qF "after process monitor has been shut down" "$said" || break
  echo "attempt $attempt was lost to roslaunch"
done
((status != 124 && status != 137)) || { echo "roslaunch had to be stopped"; exit 1; }
grep -qF "$error" "$said"
