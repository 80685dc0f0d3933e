#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# gallery.sh FOLDER [ROBOT...]: a picture FOLDER/ROBOT.png of each robot, moved, as rviz shows it on a hidden screen, and all of them in
# FOLDER/gallery.png.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
usage 1 100 "$@"
launch=$(cd "$(dirname "$0")" && pwd)
output=$1
shift
declare -A poses=(
  [spinebot]='{names: [left, right], values: [1.1, 0.8]}'
  [hammerbot]='{names: [left, right], values: [0.82, 1.1]}'
  [finger_a1]='{names: [tendon], values: [0.82]}'
  [finger_a2]='{names: [left, upper], values: [0.95, 0.85]}'
  [gripper]='{names: [left, right], values: [0.92, 0.92]}'
  [tentacle]='{names: [tendon_1], values: [5]}'
  [bubblebot]='{names: [b], values: [70]}'
  [bubblefinger]='{names: [main], values: [70]}'
  [fibre_arm]='{names: [a], values: [30000]}'
  [fibre_finger]='{names: [air], values: [40000]}'
  [hollow_cuboid]='{names: [main], values: [2.5]}'
  [hanging_bar]='{names: [cable], values: [0.92]}'
)
declare -A scenes=([gripper]=gripper/ball.yaml)
(($# > 0)) || set -- spinebot hammerbot finger_a1 finger_a2 gripper tentacle bubblebot bubblefinger hollow_cuboid hanging_bar
for robot in "$@"; do [[ -n ${poses[$robot]-} ]] || { echo "gallery.sh: $robot: none of ${!poses[*]}" >&2; exit 2; }; done
mkdir -p "$output"
output=$(cd "$output" && pwd)
. "$launch/own_session.sh"

# The session's view of the robot alone.
/usr/bin/python3 - "$launch/../config/rviz/session.rviz" "$folder/gallery.rviz" <<'PYTHON'
import sys
import yaml
with open(sys.argv[1]) as file:
    view = yaml.safe_load(file)
manager = view['Visualization Manager']
manager['Displays'] = [one for one in manager['Displays'] if one['Name'] not in ('Target', 'World', 'Labels')]
for display in manager['Displays']:
    if display['Name'] == 'Overlay':
        display['Namespaces'] = {'simulated_trail': False}
with open(sys.argv[2], 'w') as file:
    yaml.safe_dump(view, file, sort_keys=False)
PYTHON

for robot in "$@"; do
  scene=$launch/../config/robots/${scenes[$robot]-$robot/robot.yaml}
  roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$scene" rviz:=false >"$folder/log" 2>&1 &
  session=$!
  wait_for has_markers || { tail "$folder/log" >&2; exit 1; }
  for ((i = 0; i < 3; ++i)); do rostopic pub -1 /actuators/command soft_robot_lab/ActuatorCommand "${poses[$robot]}" >/dev/null; done
  sleep "${POSE_DELAY_S:-8}" # until it rests there
  "$launch/take_picture.sh" "$folder/all.png" "$folder/gallery.rviz"
  end_session
  convert "$folder/all.png" -crop 660x560+544+190 +repage "$output/$robot.png" # beside the panel
  echo "$output/$robot.png"
done
cd "$output"
montage $(printf '%s.png ' "$@") -tile 5x -geometry 330x280+2+2 all.png
convert all.png -depth 8 -colors 220 gallery.png
rm all.png
echo "$output/gallery.png"
