#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# view_closes_test.sh: Ctrl+Q ends `view.sh`. rviz does not ask first whether to save a view of this package, whose camera the
# panel has set.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/environment.sh"
export ROS_HOME LIBGL_ALWAYS_SOFTWARE=1 here
ROS_HOME=$(mktemp -d)
trap 'rm -rf "$ROS_HOME"' EXIT
xvfb-run -a -s "-screen 0 1280x800x24" bash -c '
  "$here/../../launch/view.sh" "$here/../data/scenes/cable_bar.yaml" >"$ROS_HOME/said" 2>&1 &
  view=$!
  trap "kill -INT $view 2>/dev/null; wait $view 2>/dev/null" EXIT
  find_window() { xdotool search --onlyvisible --name "RViz" 2>/dev/null | head -n 1; }
  for ((i = 0; i < 120; ++i)); do # whose title has a star once the camera is set
    [[ -n $(find_window) && $(xdotool getwindowname "$(find_window)") == *\** ]] && break
    kill -0 $view || { cat "$ROS_HOME/said"; exit 1; }
    sleep 0.5
  done
  xdotool windowfocus "$(find_window)" key ctrl+q
  for ((i = 0; i < 60; ++i)); do
    kill -0 $view 2>/dev/null || exit 0
    sleep 0.5
  done
  echo "rviz is open yet" >&2
  import -window root "${PICTURE:-/dev/null}" || true
  exit 1'
