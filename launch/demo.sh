#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# demo.sh [--keep]: on a fresh Debian 12 machine, from nothing to a simulated Spinebot that reaches for a ball.
# Prints a short report and ends with status 0, or with a plain message and another status when a part failed.
# --keep leaves the session running until Ctrl-C.
set -euo pipefail
launch=$(cd "$(dirname "$0")" && pwd)
keep=false
. "$launch/usage.sh"
known_options=--keep
usage 0 1 "$@"
case "${1-}" in
  --keep) keep=true ;;
  "") ;;
  *) echo "demo.sh: unknown word $1" >&2; exit 2 ;;
esac

fail() { echo "demo: $*" >&2; exit 1; }

session=
end_session() { # roslaunch passes SIGINT on and waits for its nodes
  [[ -n $session ]] || return 0
  kill -INT "$session" 2>/dev/null || true
  wait "$session" 2>/dev/null || true
  session=
}
trap end_session EXIT
trap 'exit 130' INT TERM

package=$(cd "$launch/.." && pwd)
output=$package/build/demo
target=demonstration
if $keep || [[ -n ${DISPLAY:-} ]]; then
  target=session # whoever looks at it may use all of the panel
fi
mkdir -p "$output"

# stage TITLE LOG COMMAND...: what it prints goes to the log; a terminal shows how far it is, where it says so, and for how long.
stage() {
  local title=$1 log=$2 done_share
  shift 2
  "$@" >"$log" 2>&1 &
  local running=$! start=$SECONDS
  [[ -t 1 ]] || echo "$title ..."
  while kill -0 "$running" 2>/dev/null; do
    done_share=$(tail -c 2000 "$log" | grep -oE '^\[ *[0-9]+%\]' | tail -1 || true)
    [[ ! -t 1 ]] || printf '\r%s ... %s %d:%02d ' "$title" "$done_share" $(((SECONDS - start) / 60)) $(((SECONDS - start) % 60))
    sleep 0.3
  done
  [[ ! -t 1 ]] || echo
  wait "$running" || { tail -20 "$log" >&2; fail "$title: $log has the reason"; }
}

unbuilt() { # whether a file or folder changed since the last build
  [[ ! -e $output/built || $(<"$output/built") != "$target" || -n $(find "$package"/{src,include,launch,msg,srv,config,CMakeLists.txt,package.xml} -newer "$output/built" -print -quit) ]]
}

"$launch/install_dependencies.sh" --check || stage "Installing packages" "$output/install.log" "$launch/install_dependencies.sh"
if unbuilt; then
  echo "$target" >"$output/begun"
  stage "Building" "$output/build.log" "$launch/build.sh" "$target"
  mv "$output/begun" "$output/built"
fi
. "$launch/environment.sh"

echo "Starting the session ..."
rviz=false
[[ -z ${DISPLAY:-} ]] || rviz=true
set -m # a process group of its own, so that Ctrl-C reaches it through end_session only
scene=$package/config/robots/spinebot/touching.yaml # its joints stop each other
roslaunch -p "$master_port" soft_robot_lab session.launch robot:=spinebot scene:="$scene" rviz:=$rviz record:=true bag_folder:="$output" \
  >"$output/session.log" 2>&1 &
session=$!
set +m
until rostopic list >/dev/null 2>&1; do
  kill -0 "$session" 2>/dev/null || { tail -20 "$output/session.log" >&2; fail "the session ended: $output/session.log"; }
  sleep 0.2
done

echo "Reaching for the ball ..."
timeout --signal=INT 900 rosrun soft_robot_lab reach_target_node "$package/config/robots/spinebot/tasks/ball.yaml" >"$output/report.txt" ||
  { cat "$output/report.txt"; tail -20 "$output/session.log" >&2; fail "the task failed: $output/session.log"; }
"$launch/take_picture.sh" "$output/overlay.png" || fail "taking the picture failed"
if $keep; then
  cat "$output/report.txt"
  echo "The session runs on (ROS_MASTER_URI=$ROS_MASTER_URI); Ctrl-C ends it."
  trap : INT # ends the waiting, not the script
  wait "$session" || true
fi
end_session

bag=$(ls -t "$output"/*_spinebot.bag 2>/dev/null | head -1)
[[ -n $bag ]] && rosbag info "$bag" >"$output/bag.txt" || fail "the recording is not whole: $output"
$keep || cat "$output/report.txt"
echo "recording         $bag"
echo "picture           $output/overlay.png"
