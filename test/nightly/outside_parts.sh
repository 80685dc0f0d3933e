#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# outside_parts.sh CHECK_CASTING: published parts of other soft robots get a verdict. The folder OUTSIDE_PARTS holds at
# least five of them, as .stl in millimetres or .step, one of them .step; some are in SofaDefrost/SoftRobots,
# StanfordASL/soft-robot-control, SNU-SRBL/SoftRobot_sim2real and vekkax/Fin-ray-Soft-Gripper. A file without a closed
# solid must be refused by name. Without the folder nothing is tested.
set -euo pipefail
check_casting=$1
[[ -d ${OUTSIDE_PARTS:-} ]] || { echo "skipped: OUTSIDE_PARTS names no folder with parts of other robots"; exit 77; }
outside=$(cd "$OUTSIDE_PARTS" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
TIMEFORMAT='%U'
shopt -s nullglob nocaseglob

robot_of() { # FILE: the robot's file that has this part as its body
  local kind=step scale=1
  [[ ${1,,} == *.stl ]] && kind=stl scale=0.001
  printf 'body: {solid: {%s: "%s"}, scale: %s}\n' "$kind" "$1" "$scale"
}

verdicts=0 steps=0
for part in "$outside"/*.{stl,step,stp}; do
  robot_of "$part" >"$folder/robot.yaml"
  status=0
  cpu_s=$({ time "$check_casting" "$folder/robot.yaml" --surface-alone --result "$folder/verdict.json" \
    >"$folder/out" 2>"$folder/err"; } 2>&1) || status=$?
  name=$(basename "$part")
  case $status in
    0 | 1)
      verdicts=$((verdicts + 1))
      [[ ${part,,} == *.stl ]] || steps=$((steps + 1))
      echo "$name: $(head -n 1 "$folder/out"), $cpu_s s" ;;
    2)
      grep -q "$name\|body.solid" "$folder/err" || { echo "$name: refused without its name: $(cat "$folder/err")" >&2; exit 1; }
      echo "$name: $(cat "$folder/err")" ;;
    *)
      echo "$name: ended with $status: $(cat "$folder/err")" >&2
      exit 1 ;;
  esac
done
((verdicts >= 5 && steps >= 1)) || { echo "$verdicts parts have verdicts, $steps of them STEP; five and one are asked" >&2; exit 1; }
