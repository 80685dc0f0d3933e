#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# new_robot.sh NAME: writes NAME.yaml here, a finger with three cables whose comments explain each line. Overwrites nothing.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
usage 1 1 "$@"
name=$1
[[ $name =~ ^[A-Za-z][A-Za-z0-9_]*$ ]] || { echo "NAME: '$name' must begin with a letter, and have only letters, digits and _" >&2; exit 2; }
file=$PWD/$name.yaml
[[ ! -e $file ]] || { echo "$file is there already; choose another name" >&2; exit 1; }
cat >"$file" <<'YAML'
# A finger of silicone with three cables. It hangs from its top face; z is up, and all lengths are in metres.
# Each line may be changed. config/README.md of soft_robot_lab explains every key.
body:
  solid:
    cylinder: {start_m: [0, 0, 0], end_m: [0, 0, -0.1], radius_m: 0.012}
  element: quadratic             # curved and without locking; `linear` is faster and much stiffer
  element_size_m: 0.02           # halve it to see how much the result still changes
  material: {preset: ecoflex_00_50}
  fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]   # what lies in this box is clamped: the top face
gravity_m_s2: [0, 0, -9.81]
cables:                          # a cable starts at the top, and its plug at the end of its path is pulled up
  - {name: front, path_m: [[0.008, 0, 0], [0.008, 0, -0.09]], plug_radius_m: 0.002, min_contraction: 0.8}
  - {name: left, path_m: [[-0.004, 0.00693, 0], [-0.004, 0.00693, -0.09]], plug_radius_m: 0.002, min_contraction: 0.8}
  - {name: right, path_m: [[-0.004, -0.00693, 0], [-0.004, -0.00693, -0.09]], plug_radius_m: 0.002, min_contraction: 0.8}
markers:                         # points that are measured, and that an optimisation can aim at
  - {name: tip, position_m: [0, 0, -0.1]}
run:                             # what the program `simulate` does; a session has its own commands
  commands: [{time_s: 0, front: 0.9}]   # 0.9: the front cable is pulled to 90 % of its length
YAML
cat <<TEXT
wrote $file
look at it    rosrun soft_robot_lab view.sh $name.yaml
simulate it   rosrun soft_robot_lab simulate $name.yaml --result $name.json
a session     roslaunch soft_robot_lab session.launch scene:=$file
its rig       rosrun soft_robot_lab new_rig $name.yaml
all of it     rosrun soft_robot_lab life.sh $name.yaml --output ${name}_life
TEXT
