#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# required_nodes_test.sh [ARGUMENT:=VALUE...] KILL|TERM NODE...: a session of a coarse bar with cameras ends when one of
# these nodes gets this signal, says which, and leaves no process, link or socket.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
data=$here/../data
arguments=()
while [[ ${1-} == *:=* ]]; do arguments+=("$1") && shift; done
signal=$1
shift
said=$(mktemp)
session=
cleanup() {
  [[ -z $session ]] || kill -INT "$session" 2>/dev/null || true
  wait || true
  rm -f "$said"
}
trap cleanup EXIT

pid_of() { pgrep -P "$session" -f -- "__name:=$1( |$)"; }

await() { # SECONDS COMMAND...
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    ((SECONDS < end)) || return 1
    sleep 0.1
  done
}

runs() { kill -0 "$1" 2>/dev/null; }
has_ended() { ! runs "$1"; }
is_complete() { rosservice list 2>/dev/null | grep -q /controller/execute_policy && pid_of "$1" >/dev/null; }

expect_end() { # NODE
  . "$here/../../launch/environment.sh"
  local device pid
  set -m
  roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$data/scenes/cable_bar.yaml" rviz:=false \
    plant:="$data/plant/bar.yaml" cameras:=rendered camera_setup:="$data/cameras/bar.yaml" camera_names:="[eye]" \
    overlay_camera:=eye camera_poses:="$data/cameras/bar_poses.yaml" tracker:="$data/cameras/bar_tracker.yaml" balls:= \
    "${arguments[@]}" >"$said" 2>&1 &
  session=$!
  set +m
  await 60 is_complete "$1" || { cat "$said"; echo "$1 did not start"; exit 1; }
  device=$(rosparam get /motor/device 2>/dev/null || true)
  pid=$(pid_of "$1")
  kill "-$signal" "$pid"
  await 60 has_ended "$session" || { cat "$said"; echo "the session did not end without $1"; exit 1; }
  wait "$session" || true
  session=
  grep -qE "REQUIRED process \[$1-[0-9]+\] has died" "$said" && grep -qE "$how" "$said" ||
    { cat "$said"; echo "nothing says that $1 ended the session"; exit 1; }
  [[ -z $device ]] || [[ ! -L $device && ! -e $device.control ]] || { echo "$device was left"; exit 1; }
  echo "without $1 the session ended, and said so"
}

how="exit code -$(kill -l "$signal")"
[[ $signal == KILL ]] || how="$how|finished cleanly" # the emulator's own answer to it
for node in "$@"; do expect_end "$node"; done
