#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# soak.sh SOAK_CHECK SECONDS: a simulated session of Spinebot that runs so long, commanded and watched by soak_check.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/own_session.sh"

set -m
roslaunch -p "$master_port" soft_robot_lab session.launch robot:=spinebot rviz:=false &
session=$!
set +m
wait_for rostopic list >/dev/null 2>&1
"$1" "$2"
