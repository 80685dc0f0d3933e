#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# slice_moulds.sh MAKE_MOULD ROBOTS FOLDER: makes the moulds of all robots that have one, and slices each part as a printer's
# owner would. PrusaSlicer must take both files of a part for closed and of the volume that mould.json states.
# Without prusa-slicer nothing is tested.
set -euo pipefail
make_mould=$1 robots=$2 folder=$3
command -v prusa-slicer >/dev/null || exit 77
rm -rf "$folder"
mkdir -p "$folder"
fail() { echo "$*" >&2; exit 1; }

volume_of() { # FILE: in mm^3, of a closed surface
  local info
  info=$(prusa-slicer --info "$1" 2>&1)
  [[ $info == *"manifold = yes"* ]] || fail "$1: $info"
  sed -n 's/^volume = //p' <<<"$info"
}

slice() { # MOULD'S FOLDER, PART, ITS VOLUME IN mm^3
  for file in "$1/$2.stl" "$1/$2.3mf"; do
    awk -v stated="$3" -v found="$(volume_of "$file")" 'BEGIN {exit !(found / stated > 0.999 && found / stated < 1.001)}' ||
      fail "$file: $(volume_of "$file") mm^3, and mould.json states $3"
  done
  prusa-slicer --export-gcode --bed-shape 0x0,223x0,223x223,0x223 --max-print-height 205 --output "$1/$2.gcode" "$1/$2.3mf" \
    >"$1/$2.log" 2>&1 || fail "$(cat "$1/$2.log")"
  (($(grep -c '^G1 .*E' "$1/$2.gcode") > 1000)) || fail "$1/$2.gcode prints next to nothing"
  echo "$1/$2: $(sed -n 's/^; estimated printing time (normal mode) = //p' "$1/$2.gcode"), $3 mm^3"
}

mould() { # NAME, ROBOT'S FILE, ARGUMENTS: fewer parts than one is a failure
  "$make_mould" "$robots/$2" --output "$folder/$1" "${@:3}"
  local parts
  parts=$(python3 -c '
import json, sys
for part in json.load(open(sys.argv[1] + "/mould.json"))["parts"]: print(part["name"], 1e9 * part["volume_m3"])
' "$folder/$1")
  while read -r part volume_mm3; do slice "$folder/$1" "$part" "$volume_mm3"; done <<<"$parts"
}

mould hammerbot hammerbot/robot.yaml
mould hammerbot_in_halves hammerbot/deep_heads.yaml
mould spinebot spinebot/robot.yaml
mould spinebot_with_wedges spinebot_castable/robot.yaml
mould bubblebot bubblebot/robot.yaml
mould bubblefinger bubblefinger/lid.yaml
mould gripper gripper/robot.yaml
mould finger_a1 finger_a1/robot.yaml
mould finger_a2 finger_a2/robot.yaml
mould hanging_bar hanging_bar/robot.yaml
