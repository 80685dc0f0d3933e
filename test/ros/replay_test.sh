#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# replay_test.sh [emulated]: a session with rendered cameras, of the simulated robot or of the one that an emulated rig moves. The
# tracker finds the tip where it is, and its recording gives the session's markers and gaps again, to the last digit, however often it
# is read; although the session's tracker had frames from before the recording, which a filter never quite forgets.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
data=$here/../data
. "$here/../../launch/own_session.sh"
bags=$folder

robot=(cameras:=rendered) truth=/simulator/markers
if [[ ${1:-} == emulated ]]; then
  # On a machine under load the emulated board may answer late.
  sed 's/^watchdog_s: .*/watchdog_s: 5/' "$data/../../config/robots/spinebot/motors.yaml" >"$bags/rig.yaml"
  robot=(emulated:=true rig:="$bags/rig.yaml" plant:="$data/plant/bar.yaml") truth=/plant/markers
fi
cameras=(camera_names:='[eye]' camera_poses:="$data/cameras/bar_poses.yaml" tracker:="$data/cameras/bar_tracker.yaml")
set -m
roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$data/scenes/cable_bar.yaml" rviz:=false \
  "${robot[@]}" camera_setup:="$data/cameras/bar.yaml" "${cameras[@]}" \
  record:=true record_images:=true bag_folder:="$bags" &
session=$!
set +m
wait_for has_markers
wait_for_message /tracker/markers
rosrun soft_robot_lab run_table_node "$data/bar_table.yaml"
kill -INT "$session"
wait "$session" || { echo "roslaunch ended with status $?"; exit 1; }
session=
[[ $(rosbag info -y -k compression "$bags"/*_spinebot.bag) == lz4 ]] || { echo "images are not compressed"; exit 1; }

for run in first second; do
  roslaunch -p "$master_port" soft_robot_lab replay.launch bag:="$(echo "$bags"/*_spinebot.bag)" output:="$bags/$run.bag" \
    cameras:='[eye]' poses:="$data/cameras/bar_poses.yaml" tracker:="$data/cameras/bar_tracker.yaml"
done
/usr/bin/python3 - "$bags"/*_spinebot.bag "$bags/first.bag" "$bags/second.bag" $truth <<'PYTHON'
import math, sys
import rosbag

def messages(path, topic="/tracker/markers"):  # by stamp; where a camera's frame came late there are several at one
    with rosbag.Bag(path) as bag:
        found = {}
        for _, m, _ in bag.read_messages(topics=[topic]):
            m.header.seq = 0  # which publishers count by
            found.setdefault(m.header.stamp.to_nsec(), []).append(m)
        return found

def alike(ones, others):  # to the last digit
    both = ones.keys() & others.keys()
    for stamp in both:
        assert all(m in others[stamp] for m in ones[stamp]), (ones[stamp], others[stamp])
    return len(both)

session, first, second = sys.argv[1:4]
for topic in "/tracker/markers", "/reality_gap":
    live, replayed, again = (messages(path, topic) for path in (session, first, second))
    assert replayed == again
    print("%s: %d times in the session, %d in its replay, of them alike %d" % (
        topic, len(live), len(replayed), alike(replayed, live)))
    assert alike(replayed, live) >= 15

truth = messages(session, sys.argv[4])
def tip(message):
    return {n: (p.x, p.y, p.z) for n, p in zip(message.names, message.positions)}["tip"]

def true_tip(stamp):  # of the nearest time, at most a time step away
    return tip(truth[min(truth, key=lambda s: abs(s - stamp))][0])

off = [math.dist(tip(m), true_tip(s)) for s, at in messages(first).items() for m in at if "tip" in m.names]
print("%d frames; tip off by at most %.2f mm" % (len(off), 1e3 * max(off)))
assert len(off) >= 15 and max(off) < 3e-3
PYTHON
