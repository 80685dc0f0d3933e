#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# whole_life.sh ROBOT FOLDER: the whole life of test/data/robots/ROBOT.yaml, or of what new_robot.sh writes (new_robot), in a new folder. No step
# breaks down or is left out, what is refused is refused for a known reason, a second run does nothing again, and it all takes less
# than 20 minutes of CPU.
set -euo pipefail
robot=$1 folder=$2
test=$(cd "$(dirname "$0")/.." && pwd)
package=$(dirname "$test")
. "$package/launch/environment.sh"
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
file=$test/data/robots/$robot.yaml
if [[ $robot == new_robot ]]; then
  rosrun soft_robot_lab new_robot.sh finger >/dev/null
  file=$folder/finger.yaml
fi
rosrun soft_robot_lab life.sh "$file" --output life
rosrun soft_robot_lab life.sh "$file" --output life >again
/usr/bin/python3 -B - "$robot" life again <<'PYTHON'
import glob
import json
import os
import sys

robot, life, again = sys.argv[1:]
REFUSED = {'mesh_arm': {'mould'}}  # a mesh has no shapes to make a mould of
steps = {}
for path in glob.glob(os.path.join(life, '*', 'step.json')):
    with open(path, encoding='utf-8') as file:
        steps[os.path.basename(os.path.dirname(path))] = json.load(file)
with open(again, encoding='utf-8') as file:
    lines = file.read().splitlines()[:-1]
assert len(lines) == len(steps) == 12, (lines, list(steps))
assert all('as before' in line for line in lines), lines
refused = {name for name, step in steps.items() if step['state'] != 'done'}
assert refused == REFUSED.get(robot, set()), {name: steps[name]['why'] for name in refused}
assert all(steps[name]['why'] for name in refused)
assert all(step['pictures'] for name, step in steps.items() if name not in refused)
cpu_s = sum(step['cpu_s'] for step in steps.values())
off_m = steps['again']['values']['off_m']
print('%s: %.0f CPU-s, policies end %s' % (robot, cpu_s, off_m))
assert cpu_s < 1200.0, cpu_s
assert off_m['of the fitted model'] < 0.003, off_m
size = os.path.getsize(os.path.join(life, 'life.html'))
assert size > 100000, size
PYTHON
