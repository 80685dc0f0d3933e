#!/bin/bash
# A session of a bad scene ends by itself and names file, line and key.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/environment.sh"
output=$(timeout --signal=INT 40 roslaunch -p "$master_port" soft_robot_lab session.launch rviz:=false \
  scene:="$here/../data/scenes/unknown_key.yaml" 2>&1) || { echo "$output"; echo "roslaunch had to be stopped"; exit 1; }
echo "$output"
grep -q "unknown_key.yaml:5: body: unknown key 'colour'" <<<"$output"
