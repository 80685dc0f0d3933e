#!/bin/bash
# check_includes.sh ROOT: every part includes only the parts its row names, and no part but ros/ and nodes/ knows ROS.
# Lists each offending line and ends with 1.
set -euo pipefail
root=$1
declare -A allowed=(
  [settings]="settings"
  [vision]="vision settings"
  [render]="render vision settings"
  [sim]="sim settings"
  [design]="design settings"
  [actuators]="actuators sim settings"
  [scene]="scene sim settings design"
  [control]="control sim settings"
  [experiment]="experiment control scene actuators sim design render vision settings"
  [motor]="motor settings"
  [rig]="rig motor experiment control scene sim render vision settings"
  [firmware]="motor"
  [emulator]="emulator motor"
)
ros='(ros|rosbag|pluginlib|class_loader|nodelet|tf2[a-z_]*|roslib|[a-z_]*_msgs|std_srvs|diagnostic_updater|message_filters)/'
message='soft_robot_lab/[A-Z]' # generated messages
parts=$(IFS='|'; echo "${!allowed[*]}|programs|nodes")
status=0

report() { # WHY LINES
  [[ -z $2 ]] || { echo "$1:"; echo "$2"; status=1; }
}

for part in "${!allowed[@]}"; do
  folders=()
  for folder in "$root/src/$part" "$root/include/soft_robot_lab/$part"; do
    [[ ! -d $folder ]] || folders+=("$folder")
  done
  ((${#folders[@]} > 0)) || continue
  includes=$(grep -rnE '^[[:space:]]*#[[:space:]]*include' "${folders[@]}" || true)
  report "$part/ may not know ROS" "$(grep -E "[<\"]($ros|$message)" <<<"$includes" || true)"
  report "Gmsh is GPL: only the program mesh_robot may include it" "$(grep -E '[<"]gmsh' <<<"$includes" || true)"
  [[ $part == emulator ]] ||
    report "simavr is GPL: only the program rig_emulator may include it" "$(grep -E '[<"]simavr' <<<"$includes" || true)"
  # Public headers are soft_robot_lab/PART/..., private ones PART/..., which only their own part may include.
  others=$(grep -E "[<\"](soft_robot_lab/[a-z]|($parts)/)" <<<"$includes" | grep -v "\"$part/" || true)
  for friend in ${allowed[$part]}; do
    others=$(grep -vE "[<\"]soft_robot_lab/$friend/" <<<"$others" || true)
  done
  report "$part/ may include only ${allowed[$part]}" "$others"
done
exit $status
