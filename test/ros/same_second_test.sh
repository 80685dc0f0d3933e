#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Recorders that are started again, as after kill -9, or whose clock was set back, never write over a recording.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/environment.sh"
folder=$(mktemp -d)
master=
cleanup() {
  [[ -z $master ]] || kill "$master" 2>/dev/null || true
  wait || true
  rm -rf "$folder"
}
trap cleanup EXIT
mkdir "$folder/bin" "$folder/bags"
printf '#!/bin/bash\necho 2026-01-01_00-00-00\n' >"$folder/bin/date"
chmod +x "$folder/bin/date"
rosmaster --core -p "$master_port" >/dev/null 2>&1 &
master=$!
until rosparam list >/dev/null 2>&1; do sleep 0.1; done

bag=$folder/bags/2026-01-01_00-00-00_bar
record() { # EXPECTED SIGNAL
  PATH=$folder/bin:$PATH "$here/../../launch/record.sh" "$folder/bags" bar >/dev/null 2>&1 &
  local recorder=$! end=$((SECONDS + 30))
  until [[ -e $1.active ]]; do
    ((SECONDS < end)) || { echo "no $1.active, but:"; ls "$folder/bags"; kill -KILL "$recorder"; exit 1; }
    sleep 0.1
  done
  kill "-$2" "$recorder"
  wait "$recorder" || true
}
record "$bag.bag" KILL
[[ -e $bag.bag.active ]]
first=$(stat -c '%i %Y' "$bag.bag.active")
record "${bag}_2.bag" INT
record "${bag}_3.bag" KILL
[[ $(stat -c '%i %Y' "$bag.bag.active") == "$first" ]] || { echo "the first recording was written over"; exit 1; }
ls "$folder/bags"
