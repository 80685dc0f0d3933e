#!/bin/bash
# record.sh FOLDER ROBOT: records a session into FOLDER/DATE_ROBOT.bag until SIGINT. Everything but /clock, which
# `rosbag play --clock` makes anew.
set -euo pipefail
folder=$1 robot=$2
shift 2 # the rest is for ROS: __name:=..., __log:=...
mkdir -p "$folder"
exec rosrun rosbag record --output-name="$folder/$(date +%Y-%m-%d_%H-%M-%S)_$robot.bag" \
  /actuators/command /simulator/markers /simulator/actuators /simulator/surface /simulator/scene /tracker/markers \
  /controller/progress /controller/target /overlay /tf /tf_static /diagnostics /rosout "$@"
