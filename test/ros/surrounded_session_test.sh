#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# surrounded_session_test.sh user|disk: a session with rendered cameras and a recording among odd surroundings tracks, plays a policy,
# and leaves a whole bag. Spaces and letters beyond ASCII in every folder's name; `user`: as nobody with files of root, umask 077, and a
# locale with a decimal comma; `disk`: umask 0, and no space at TMPDIR. Status 77: the machine does not allow it.
set -euo pipefail
case=$1
here=$(cd "$(dirname "$0")" && pwd)
data=$here/../data

if [[ $case == disk && ${2-} != inside ]]; then
  top=$(mktemp -d)
  trap 'rmdir "$top"' EXIT
  for namespace in "unshare --mount" "unshare --mount --map-root-user"; do
    if $namespace mount -t tmpfs tmpfs "$top" 2>/dev/null; then
      status=0
      TMPDIR= $namespace "$0" disk inside "$top" || status=$?
      exit "$status"
    fi
  done
  echo "skipped: neither root nor a user namespace may mount a disk here"
  exit 77
fi

. "$here/../../launch/own_session.sh"
place="$folder/größe  #1 it's"
export HOME="$place/home" LC_ALL=C.UTF-8
mkdir -p "$HOME" "$place/robots" "$place/bags"
cp "$data"/scenes/cable_bar.yaml "$data"/cameras/bar*.yaml "$place/robots"
as_user=()
if [[ $case == user ]]; then
  mkdir "$folder/locales"
  if ! localedef -i de_DE -f UTF-8 "$folder/locales/de_DE.UTF-8" 2>"$folder/said"; then
    echo "skipped: no locale with a decimal comma can be compiled here: $(cat "$folder/said")"
    exit 77
  fi
  as_user=(env LOCPATH="$folder/locales" LC_ALL=de_DE.UTF-8)
  umask 077
  if [[ $EUID == 0 ]]; then
    as_user+=(setpriv --reuid=65534 --regid=65534 --clear-groups)
    chmod 711 "$folder"
    chown 65534:65534 "$HOME" "$place/bags"
    "${as_user[@]}" rosrun soft_robot_lab simulate --help >/dev/null 2>&1 || { echo "skipped: nobody may not run what is built here"; exit 77; }
  fi
else
  mount -t tmpfs -o size=64k tmpfs "$3"
  head -c 65536 /dev/zero >"$3/fill"
  export TMPDIR=$3
  umask 0
fi

set -m
"${as_user[@]}" roslaunch -p "$master_port" soft_robot_lab session.launch scene:="$place/robots/cable_bar.yaml" rviz:=false \
  cameras:=rendered camera_setup:="$place/robots/bar.yaml" camera_names:='[eye]' overlay_camera:=eye \
  camera_poses:="$place/robots/bar_poses.yaml" tracker:="$place/robots/bar_tracker.yaml" balls:= \
  record:=true bag_folder:="$place/bags" >"$folder/log" 2>&1 &
session=$!
set +m
fail() { tail -30 "$folder/log"; echo "$*"; exit 1; }
wait_for has_markers || fail "no session starts"
wait_for_message /tracker/markers || fail "nothing is tracked"
wait_for rosservice type /controller/execute_policy >/dev/null 2>&1 || fail "the controller offers nothing"
rosservice call /controller/execute_policy '{policy: {names: [right], steps: [{time_s: 0.2, values: [0.97]}]}}' >"$folder/answer"
grep -q "success: True" "$folder/answer" || fail "no policy is played: $(cat "$folder/answer")"
recording_grows() { (($(du -sb "$place/bags" | cut -f1) > 100000)); }
wait_for recording_grows || fail "nothing is recorded"
kill -INT "$session"
wait "$session" || fail "roslaunch ended with status $?"
session=
! grep -E "Traceback|terminate called|has died" "$folder/log" || fail "a process broke"
bag=$(echo "$place"/bags/*.bag)
rosbag info "$bag" >"$folder/answer" || fail "no whole bag: $(ls "$place/bags")"
grep -q " /tracker/markers " "$folder/answer" || fail "the bag lacks markers"
open=$(find "$HOME/.cache" -perm /077)
[[ -z $open ]] || fail "others may read what is kept: $open"
mode=$(stat -c %a "$bag")
[[ $mode == $(printf '%o' $((0666 & ~0$(umask)))) ]] || fail "the bag has the mode $mode"
[[ $case != disk ]] || umount --lazy "$3"
