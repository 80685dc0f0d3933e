#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# launch_usage_test.sh: every script of launch/ says by --help what it takes, and refuses too few words, too many and unknown options with
# its name, before it does anything.
set -euo pipefail
launch=$(cd "$(dirname "$0")/../../launch" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "launch_usage: $*: $(cat "$folder/said")" >&2; exit 1; }
ends() { # STATUS WORDS SCRIPT WORD...
  local status=0 expected=$1 words=$2 script=$3
  shift 3
  timeout 20 "$launch/$script" "$@" >"$folder/said" 2>&1 </dev/null || status=$?
  [[ $status == "$expected" ]] || fail "$script $* ends with $status, not $expected"
  grep -q -- "$words" "$folder/said" || fail "$script $* does not say $words"
  ! grep -E "unbound variable|Traceback|: line [0-9]+:" "$folder/said" || fail "$script $* breaks"
  rm "$folder/said"
  [[ -z $(ls -A "$folder") ]] || fail "$script $* leaves $(ls -A "$folder")"
}
for script in record.sh build.sh demo.sh gallery.sh install_dependencies.sh new_robot.sh take_picture.sh view.sh; do
  ends 0 "^$script" $script --help
  ends 2 "$script: unknown option --hepl" $script --hepl
done
for script in check_arguments.py free_port.py import_mesh.py; do ends 0 "$script" $script --help; done
for script in gallery.sh new_robot.sh record.sh take_picture.sh view.sh; do ends 2 "usage: $script " $script; done
ends 2 "check_arguments.py ROBOT" check_arguments.py
ends 2 "record.sh: 1 words, must be 2 to 3" record.sh bags
ends 2 "record.sh: 4 words, must be 2 to 3" record.sh bags bar true more
ends 2 "record.sh: 1 words, must be 2 to 3" record.sh bags __name:=recorder
ends 2 "demo.sh: unknown word keep" demo.sh keep
ends 2 "gallery.sh: spinbot: none of" gallery.sh pictures spinbot
ends 2 "new_robot.sh: 2 words, must be 1" new_robot.sh my robot
ends 2 "view.sh: 2 words, must be 1" view.sh my robot.yaml
ends 2 "größe 漢/my robot.yaml: cannot be read" view.sh "größe 漢/my robot.yaml"
ends 1 "'robot' must be WORD=PATH" check_arguments.py spinebot robot
ends 2 "invalid choice: 0" free_port.py 0
ends 2 "invalid int value: 'many'" free_port.py many
