#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# view.sh ROBOT.yaml: shows a robot or scene in rviz, with sliders. It disturbs no running session: its ROS master is its own.
# Ctrl-C, or closing the window, ends it.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
usage 1 1 "$@"
[[ -r $1 ]] || { echo "$1: cannot be read" >&2; exit 2; }
scene=$(realpath "$1")
export ROS_IP=127.0.0.1
unset ROS_HOSTNAME ROS_NAMESPACE
port=$("$(dirname "$0")/free_port.py")
exec roslaunch -p "$port" soft_robot_lab view.launch scene:="$scene"
