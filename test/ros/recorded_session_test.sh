#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A recorded session of Spinebot: it reaches for the ball, ends at SIGINT, and its bag is whole and holds every topic.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/own_session.sh"
bags=$folder

set -m
roslaunch -p "$master_port" soft_robot_lab session.launch robot:=spinebot rviz:=false record:=true bag_folder:="$bags" &
session=$!
set +m
# A search that is asked for before the recorder is connected is over, and not in the bag.
recording_grows() { (($(du -sb "$bags" | cut -f1) > 1000000)); }
wait_for recording_grows
rosrun soft_robot_lab reach_target_node "$here/../../config/robots/spinebot/tasks/ball.yaml"

kill -INT "$session"
wait "$session" || { echo "roslaunch ended with status $?"; exit 1; }
session=
bag=$(echo "$bags"/????-??-??_??-??-??_spinebot.bag)
[[ -f $bag && $(ls "$bags" | wc -l) == 1 ]] || { echo "not one whole bag:"; ls "$bags"; exit 1; }
info=$(rosbag info "$bag")
echo "$info"
for topic in /actuators/command /simulator/markers /simulator/actuators /simulator/surface /simulator/scene \
  /controller/progress /controller/target /overlay /tf_static /diagnostics /rosout; do
  grep -q " $topic " <<<"$info" || { echo "the bag lacks $topic"; exit 1; }
done
