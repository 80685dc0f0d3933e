#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# demonstration_test.sh LAUNCH DEMO PROGRAM...: what the demonstration builds are the PROGRAMs: all that its session starts without being asked
# to, what checks its arguments, and what demo.sh runs itself.
set -euo pipefail
launch=$1 demo=$2
shift 2
programs=" $* "
needed=$(grep -o '<node [^>]*pkg="soft_robot_lab" type="[^"]*"' "$launch" | grep -v ' if="' | sed 's/.*type="//; s/"//'
  grep -o 'rosrun soft_robot_lab [a-z_]*' "$demo" | sed 's/.* //'
  grep -o "'rosrun', 'soft_robot_lab', '[a-z_]*'" "$(dirname "$demo")/check_arguments.py" | sed "s/.*, '//; s/'//")
[[ $needed == *simulator_node* && $needed == *reach_target_node* && $needed == *check_scene_node* ]] || { echo "of $launch and $demo too little was read"; exit 1; }
for program in $needed; do
  [[ $programs == *" $program "* ]] || { echo "the target demonstration lacks $program"; exit 1; }
done
