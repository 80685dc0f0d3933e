#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# meshing_ends_test.sh plant|design: the node is asked to end while it meshes for minutes, and ends without a mesh.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/own_session.sh"
export XDG_CACHE_HOME=$folder/cache
cat > "$folder/robot.yaml" <<YAML
body:
  solid: {box: {size_m: [0.1, 0.1, 0.1], center_m: [0, 0, 0]}}
  element: linear
  element_size_m: 0.002
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.0499]}}]
YAML
printf 'robot: {include: robot.yaml}\n' > "$folder/plant.yaml"

set -m
rosmaster --core -p "$master_port" > "$folder/master.log" 2>&1 &
session=$!
set +m
wait_for rostopic list > /dev/null 2>&1
node=$(catkin_find --first-only --libexec soft_robot_lab "$1_node")
"$node" _plant:="$folder/plant.yaml" > "$folder/said" 2>&1 &
process=$!
if [[ $1 == design ]]; then
  wait_for rosservice info /design/check > /dev/null 2>&1
  rosservice call /design/check "{robot: $folder/robot.yaml, show: false}" > /dev/null 2>&1 &
fi
meshes() { pgrep -P "$process" -x mesh_robot > /dev/null || ! kill -0 "$process" 2> /dev/null; }
wait_for meshes
sleep 2  # it says at once what it will not mesh
kill -INT "$process"
status=0
wait "$process" || status=$?
((status == 0)) || { echo "$1_node ended with status $status"; cat "$folder/said"; exit 1; }
! pgrep -f "$folder/cache/.*request.yaml" > /dev/null || { echo "the mesher goes on"; exit 1; }
[[ -z $(find "$folder/cache" -name '*.msh') ]] || { echo "$1_node waited for its mesh"; exit 1; }
