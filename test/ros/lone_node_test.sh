#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# lone_node_test.sh NODE... -- PROGRAM...: each ends where no master answers, instead of waiting for ever. Nodes name their
# parameters by --help, and refuse arguments that they do not know; programs get one argument.
set -u
export ROS_MASTER_URI=http://127.0.0.1:9 # where nothing listens
expect() { # STATUS TEXT COMMAND...
  local status=$1 text=$2 output ended=0
  shift 2
  output=$(timeout 60 "$@" 2>&1) || ended=$?
  [[ $ended == "$status" && $output == *"$text"* ]] && return 0
  printf '%s: status %s instead of %s, or without "%s":\n%s\n' "$*" "$ended" "$status" "$text" "$output"
  return 1
}
failed=0
argument=
for node in "$@"; do
  [[ $node == -- ]] && argument=a.yaml && continue
  expect 2 "no ROS master answers at http://127.0.0.1:9" "$node" $argument &
  [[ -n $argument ]] && continue
  expect 0 _name:=value "$node" --help || failed=1
  expect 2 "unknown argument '--hepl'" "$node" --hepl || failed=1
done
for job in $(jobs -p); do wait "$job" || failed=1; done
exit "$failed"
