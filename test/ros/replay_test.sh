#!/bin/bash
# replay_test.sh [emulated]: a session with rendered cameras, of the simulated robot or of the one that an emulated rig moves. The
# tracker finds the tip where it is, and its recording gives the session's markers and gaps again, to the last digit, however often it
# is read; although the session's tracker had frames from before the recording, which a filter never quite forgets.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
data=$here/../data
. "$here/../../launch/environment.sh"
bags=$(mktemp -d)
session=
cleanup() {
  [[ -z $session ]] || kill -INT "$session" 2>/dev/null || true
  wait || true
  rm -rf "$bags"
}
trap cleanup EXIT

robot=(cameras:=rendered) truth=/simulator/markers
if [[ ${1:-} == emulated ]]; then
  robot=(emulated:=true rig:="$data/../../config/rigs/spinebot.yaml" reality:="$data/reality/bar.yaml") truth=/reality/markers
fi
cameras=(camera_names:='[eye]' camera_poses:="$data/cameras/bar_poses.yaml" tracker:="$data/cameras/bar_tracker.yaml")
set -m
roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$data/scenes/cable_bar.yaml" rviz:=false \
  "${robot[@]}" camera_rig:="$data/cameras/bar.yaml" "${cameras[@]}" \
  record:=true record_images:=true bag_folder:="$bags" &
session=$!
set +m
until timeout 5 rostopic echo -n 1 /tracker/markers >/dev/null 2>&1; do
  kill -0 "$session"
  sleep 0.2
done
rosrun soft_robot_lab run_table_node "$data/bar_table.yaml"
kill -INT "$session"
wait "$session" || { echo "roslaunch ended with status $?"; exit 1; }
session=

for run in first second; do
  roslaunch -p "$master_port" soft_robot_lab replay.launch bag:="$(echo "$bags"/*_spinebot.bag)" output:="$bags/$run.bag" \
    cameras:='[eye]' poses:="$data/cameras/bar_poses.yaml" tracker:="$data/cameras/bar_tracker.yaml"
done
/usr/bin/python3 - "$bags"/*_spinebot.bag "$bags/first.bag" "$bags/second.bag" $truth <<'PYTHON'
import math, sys
import rosbag

def messages(path, topic="/tracker/markers"):
    with rosbag.Bag(path) as bag:
        return {m.header.stamp.to_nsec(): m for _, m, _ in bag.read_messages(topics=[topic])}

def fields(message):  # as plain numbers, but for what publishers count by
    message.header.seq = 0
    return str(message)  # as many digits as there are

def in_both(ones, others):
    both = ones.keys() & others.keys()
    for stamp in both:
        assert fields(ones[stamp]) == fields(others[stamp]), (ones[stamp], others[stamp])
    return len(both)

session, first, second = sys.argv[1:4]
for topic in "/tracker/markers", "/reality_gap":
    live, replayed = messages(session, topic), messages(first, topic)
    assert len(replayed) >= 15, "%s: only %d" % (topic, len(replayed))
    assert replayed.keys() == messages(second, topic).keys() and in_both(replayed, messages(second, topic))
    alike = in_both(live, replayed)
    print("%s: %d replayed, of them %d of the session's %d, to the last digit" % (topic, len(replayed), alike, len(live)))
    assert alike >= 15

truth = messages(session, sys.argv[4])
def tip(message):
    return {n: (p.x, p.y, p.z) for n, p in zip(message.names, message.positions)}["tip"]

def true_tip(stamp):  # of the nearest time, at most a time step away
    return tip(truth[min(truth, key=lambda s: abs(s - stamp))])

off = [math.dist(tip(m), true_tip(s)) for s, m in messages(first).items() if "tip" in m.names]
print("%d frames; tip off by at most %.2f mm" % (len(off), 1e3 * max(off)))
assert len(off) >= 15 and max(off) < 3e-3
PYTHON
