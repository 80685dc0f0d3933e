#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# camera_names_test.sh SCENE CAMERAS: a session whose camera_names name no camera says so in its log, and which there are.
set -euo pipefail
. "$(cd "$(dirname "$0")/../../launch" && pwd)/own_session.sh"
roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$1" cameras:=rendered camera_setup:="$2" \
  camera_names:="[camera_lft]" camera_rate_hz:=1 rviz:=false >"$folder/log" 2>&1 &
session=$!
for ((i = 0; i < 120; ++i)); do
  grep "camera 'camera_lft'" "$folder/log" | grep "Cameras that publish: /" && exit 0
  kill -0 "$session" 2>/dev/null || break
  sleep 1
done
tail "$folder/log" >&2
exit 1
