#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# take_picture.sh OUTPUT.png [VIEW]: what rviz shows of the running session, drawn on a hidden screen. VIEW: `session`,
# `session_cameras`, whose docked image a full screen would hide, or an rviz file.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
usage 1 2 "$@"
output=$1
view=${2:-session}
[[ $view == *.rviz ]] || view=$(cd "$(dirname "$0")/../config/rviz" && pwd)/$view.rviz
screen=--fullscreen
[[ ${2:-session} == session ]] || screen=
export LIBGL_ALWAYS_SOFTWARE=1 output view screen
xvfb-run -a -s "-screen 0 1280x800x24" bash -c '
  rosrun soft_robot_lab session_rviz true $screen -d "$view" __name:=picture >/dev/null 2>&1 &
  rviz=$!
  trap "kill $rviz 2>/dev/null; wait $rviz 2>/dev/null" EXIT
  sleep "${PICTURE_DELAY_S:-12}" # until it has drawn
  kill -0 $rviz || { echo "rviz ended early" >&2; exit 1; }
  import -window root "$output"'
[[ -s $output ]]
