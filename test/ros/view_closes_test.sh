#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# view_closes_test.sh LATE_WINDOW: Ctrl+Q ends `view.sh` after its camera was turned. rviz does not ask first whether to write that
# into a view of this package. Its window is made as late as on a busy machine (late_window.cpp).
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/environment.sh"
late_window=$1
export ROS_HOME LIBGL_ALWAYS_SOFTWARE=1 here late_window
ROS_HOME=$(mktemp -d)
trap 'rm -rf "$ROS_HOME"' EXIT
xvfb-run -a -s "-screen 0 1280x800x24" bash -c '
  find_window() { xdotool search --onlyvisible --name "RViz" 2>/dev/null | head -n 1; }
  LD_PRELOAD=$late_window "$here/../../launch/view.sh" "$here/../data/scenes/cable_bar.yaml" >"$ROS_HOME/said" 2>&1 &
  view=$!
  trap "kill -INT $view 2>/dev/null; wait $view 2>/dev/null" EXIT
  for ((i = 0; i < 120; ++i)); do
    [[ -z $(find_window) ]] || break
    kill -0 $view 2>/dev/null || break
    sleep 0.5
  done
  [[ -n $(find_window) ]] || { cat "$ROS_HOME/said"; exit 1; }
  changed() { [[ $(xdotool getwindowname "$(find_window)") == *\** ]]; }
  for ((i = 0; i < 20; ++i)); do # the camera is turned
    xdotool windowfocus "$(find_window)" key m mousemove 900 400 mousedown 1 sleep 0.2 mousemove 950 420 sleep 0.2 mouseup 1 sleep 0.5
    ! changed || break
  done
  changed || { echo "the view did not change" >&2; exit 1; }
  xdotool windowfocus "$(find_window)" key ctrl+q
  for ((i = 0; i < 60; ++i)); do
    kill -0 $view 2>/dev/null || exit 0
    sleep 0.5
  done
  echo "rviz is open yet" >&2
  import -window root "${PICTURE:-/dev/null}" || true
  exit 1'
