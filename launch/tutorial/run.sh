#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# run.sh [--pictures]: does what the README beside it says, in a folder of its own: writes its files, runs its commands but those
# that open a window, and draws its figure. --pictures also takes its pictures anew, on a hidden screen, into config/doc.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
launch=$here/..
. "$launch/own_session.sh"
cd "$folder"

# Each block as a file: 01_bash, 02_long_finger.yaml, ...
awk '/^```(bash|yaml)/ { name = sprintf("%02d_%s", ++n, $2 == "" ? "bash" : $2); inside = 1; next } /^```/ { inside = 0 } inside { print >name }' \
  "$here/README.md"
for block in [0-9][0-9]_*; do
  case $block in
    *_bash) echo "$(cat "$block")"; bash -euo pipefail "$block" </dev/null || { echo "tutorial: this failed" >&2; exit 1; } ;;
    *.yaml) cp "$block" "${block:3}" ;;
  esac
done
"$here/draw_concepts.py" concepts.svg
[[ ${1-} == --pictures ]] || exit 0
cp concepts.svg "$here/../../config/doc"

picture() { # NAME COMMAND: of NAME.yaml, once it is commanded
  roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$folder/$1.yaml" rviz:=false >"$folder/log" 2>&1 &
  session=$!
  wait_for has_markers
  for ((i = 0; i < 5; ++i)); do rostopic pub -1 /actuators/command soft_robot_lab/ActuatorCommand "$2" >/dev/null; done
  "$launch/take_picture.sh" "$here/../../config/doc/tutorial_$1.png"
  end_session
}
picture finger '{names: [front], values: [0.85]}'
picture air '{names: [air], values: [1.5]}'
