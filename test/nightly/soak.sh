#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# soak.sh SOAK_CHECK SECONDS: a simulated session of Spinebot that runs so long, commanded and watched by soak_check.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/environment.sh"
session=
cleanup() {
  [[ -z $session ]] || kill -INT "$session" 2>/dev/null || true
  wait || true
}
trap cleanup EXIT

set -m
roslaunch -p "$master_port" soft_robot_lab session.launch robot:=spinebot rviz:=false &
session=$!
set +m
until rostopic list >/dev/null 2>&1; do
  kill -0 "$session"
  sleep 0.2
done
"$1" "$2"
