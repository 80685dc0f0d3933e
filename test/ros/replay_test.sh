#!/bin/bash
# replay_test.sh [emulated]: a session with rendered cameras, of the simulated robot or of the one that an emulated rig moves. The
# tracker finds the tip where it is, and its recording, read twice, gives the same markers and gaps to the last digit. The session's
# own tracker had frames from before the recording, of which a filter forgets all but micrometres at once.
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

def markers(path, topic="/tracker/markers"):
    with rosbag.Bag(path) as bag:
        return {m.header.stamp.to_nsec(): m for _, m, _ in bag.read_messages(topics=[topic])}

def positions(message):
    return {n: (p.x, p.y, p.z) for n, p in zip(message.names, message.positions)}

session, first, second = (markers(path) for path in sys.argv[1:4])
truth = markers(sys.argv[1], sys.argv[4])
assert len(first) >= 15, "only %d times markers" % len(first)
assert first.keys() == second.keys()
for stamp, message in first.items():
    assert positions(message) == positions(second[stamp]) and message.covariances == second[stamp].covariances, stamp
def gaps(path):
    return {s: (m.names, m.distances_m, m.seen, m.rms_m) for s, m in markers(path, "/reality_gap").items()}

live, replayed = gaps(sys.argv[1]), gaps(sys.argv[2])
assert len(replayed) >= 15 and replayed == gaps(sys.argv[3])
both = [s for s in replayed if s in live and s in session and "tip" in positions(session[s]) and "tip" in positions(first[s])]
apart = [math.dist(positions(session[s])["tip"], positions(first[s])["tip"]) for s in both]
gaps_apart = [abs(live[s][3] - replayed[s][3]) for s in both]
print("%d gaps, rms %.3f mm at most; %d of the session's, apart by %.2g m, markers by %.2g m" % (
    len(replayed), 1e3 * max(g[3] for g in replayed.values()), len(both), max(gaps_apart), max(apart)))
assert len(both) >= 10 and max(apart) < 1e-6 and max(gaps_apart) < 1e-6
def true_tip(stamp):  # of the nearest time, at most a time step away
    return positions(truth[min(truth, key=lambda s: abs(s - stamp))])["tip"]

off = [math.dist(positions(m)["tip"], true_tip(s)) for s, m in first.items() if "tip" in m.names]
print("%d frames; tip off by at most %.2f mm; %d of the session" % (len(off), 1e3 * max(off), len(session)))
assert len(off) >= 15 and max(off) < 3e-3
PYTHON
