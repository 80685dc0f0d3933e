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
has_markers() { rostopic list 2>/dev/null | grep -q /simulator/markers; }
