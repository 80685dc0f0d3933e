#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The disk fills up while a session is recorded: the lamp says so, the session goes on, and the recording when there is
# space again. In a namespace of its own, in which this may mount a small disk.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
if [[ ${1-} != inside ]]; then
  folder=$(mktemp -d)
  trap 'rmdir "$folder"' EXIT
  for namespace in "unshare --mount" "unshare --mount --map-root-user"; do
    if $namespace mount -t tmpfs -o size=1m tmpfs "$folder" 2>/dev/null; then
      status=0
      $namespace "$0" inside "$folder" || status=$?
      exit "$status"
    fi
  done
  echo "skipped: neither root nor a user namespace may mount a disk here"
  exit 77
fi

folder=$2
mount -t tmpfs -o size=4g tmpfs "$folder" # with less than 5 GB free it counts as nearly full
. "$here/../../launch/environment.sh"
lamps=$(mktemp) said=$(mktemp)
session='' echo=''
cleanup() {
  [[ -z $echo ]] || kill -INT "$echo" 2>/dev/null || true
  [[ -z $session ]] || kill -INT "$session" 2>/dev/null || true
  wait || true
  rm -f "$lamps" "$said"
}
trap cleanup EXIT

await_lamp() { # WORDS
  local end=$((SECONDS + 100))
  : >"$lamps"
  until grep -qE "message: .*$1" "$lamps"; do
    ((SECONDS < end)) || { tail -20 "$said"; grep message: "$lamps" | sort | uniq -c; echo "the lamp never said: $1"; exit 1; }
    sleep 0.2
  done
  echo "the lamp says: $(grep -oE "message: .*$1.*" "$lamps" | head -1)"
}

await_growth() {
  local end=$((SECONDS + 100)) before
  before=$(du -sb "$folder" | cut -f1)
  until (($(du -sb "$folder" | cut -f1) > before + 100000)); do
    ((SECONDS < end)) || { tail -20 "$said"; echo "nothing is recorded"; exit 1; }
    sleep 0.2
  done
}

set -m
roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$here/../data/scenes/cable_bar.yaml" rviz:=false \
  record:=true bag_folder:="$folder" >"$said" 2>&1 &
session=$!
set +m
until rostopic list >/dev/null 2>&1; do
  kill -0 "$session" 2>/dev/null || { tail -20 "$said"; echo "roslaunch ended"; exit 1; }
  sleep 0.2
done
PYTHONUNBUFFERED=1 rostopic echo /diagnostics >>"$lamps" 2>&1 &
echo=$!
await_lamp "nearly full"
await_growth
mount -o remount,size="$(($(du -sb "$folder" | cut -f1) + 300000))" "$folder"
await_lamp "the disk is full"
until rosservice type /controller/execute_policy >/dev/null 2>&1; do kill -0 "$session"; sleep 0.2; done
rosservice call /controller/execute_policy '{policy: {names: [right], steps: [{time_s: 0.2, values: [0.97]}]}}' | grep "success: True"
mount -o remount,size=100g "$folder"
await_lamp "recording grows"
await_growth
kill -INT "$session"
wait "$session" || { tail -20 "$said"; echo "roslaunch ended with status $?"; exit 1; }
session=
for bag in "$folder"/*.bag; do rosbag info "$bag" >/dev/null; done
ls -l "$folder"
