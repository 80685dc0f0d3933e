#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# record.sh FOLDER ROBOT [IMAGES]: records a session into FOLDER/DATE_ROBOT.bag until SIGINT. Everything but /clock, which
# `rosbag play --clock` makes anew, and what cameras see and the tracker's steps with it, unless IMAGES is `true`; then
# the bag is compressed without loss.
# In a namespace it records what is in it.
# Where that is taken, as after a start within the same second or a clock that was set back, it is DATE_ROBOT_2.bag, ...
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
words=() for_ros=() # __name:=..., __log:=...
for word in "$@"; do if [[ $word == *:=* ]]; then for_ros+=("$word"); else words+=("$word"); fi; done
usage 2 3 "${words[@]}"
folder=${words[0]} robot=${words[1]} images=${words[2]:-false}
session=/${ROS_NAMESPACE:-}/
session=$(tr -s / <<<"$session") # "/left/" in the namespace left, else "/"
topics=(actuators/command simulator/markers simulator/actuators simulator/surface simulator/scene tracker/markers
  tracker/parameter_updates controller/progress controller/target overlay overlay/labels reality_gap motor/state pressure/state rig/shafts plant/markers)
topics=("${topics[@]/#/$session}" /tf /tf_static /diagnostics /rosout)
compression=() # of little it would hold back for long what the lamp of the recording waits for
[[ $images != true ]] || compression=(--lz4)
[[ $images != true ]] || topics+=("${session}tracker/steps" --regex "$session[^/]+/(color|aligned_depth_to_color)/(image_raw|camera_info)")
for argument in "${for_ros[@]}"; do # ROS would end the one that runs
  [[ $argument == __name:=* ]] || continue
  reply=$(timeout 10 rosnode ping -c 1 "$session${argument#__name:=}" 2>/dev/null || true)
  [[ $reply == *"xmlrpc reply"* ]] || continue
  echo "record.sh: a recorder of this name runs already; end that session first, or start this one in a namespace" >&2
  exit 1
done
mkdir -p "$folder"
bag=$folder/$(date +%Y-%m-%d_%H-%M-%S)_$robot part=2
name=$bag
while [[ -e $name.bag || -e $name.bag.active ]]; do name=${bag}_$((part++)); done
# Whoever replays a recording misses what its buffer [MB] did not hold.
exec rosrun rosbag record --buffsize=1024 "${compression[@]}" --output-name="$name.bag" "${topics[@]}" "${for_ros[@]}"
