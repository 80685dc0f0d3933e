# SPDX-License-Identifier: BSD-3-Clause
# Source this: environment.sh, a folder of its own ($folder), and a place for a process ($session). Both end with the
# script.
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
folder=$(mktemp -d)
session=
end_session() {
  [[ -z $session ]] || { kill -INT "$session" && wait "$session" || true; }
  session=
}
trap 'end_session; rm -rf "$folder"' EXIT
# Until COMMAND succeeds; fails where the session ends before.
wait_for() { until "$@"; do kill -0 "$session" 2>/dev/null || return 1; sleep 0.5; done; }
# Until TOPIC has a message. One listener waits for it: where much else runs, each takes seconds to start.
wait_for_message() {
  rostopic echo -n 1 "$1" >/dev/null 2>&1 &
  local listener=$!
  while kill -0 "$listener" 2>/dev/null; do
    kill -0 "$session" 2>/dev/null || { kill -INT "$listener"; return 1; }
    sleep 0.5
  done
  wait "$listener"
}
has_markers() { rostopic list 2>/dev/null | grep -q /simulator/markers; }
