#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# session_rviz_test.sh SESSION_RVIZ: it leaves smooth edges out where software draws, or as its argument says. What stands for rviz
# here says how it was started.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
printf '#!/bin/bash\necho "rviz $*${SAY_LOCALE:+ $LANG ${LC_ALL-none} $LC_NUMERIC}"\n' >"$folder/rviz"
chmod +x "$folder/rviz"
export PATH=$folder:$PATH LIBGL_ALWAYS_SOFTWARE=1
expect() { # SAID ARGUMENTS...
  local said expected=$1; shift
  said=$(xvfb-run -a "$program" "$@" 2>&1 | tail -n 1) || true
  [[ $said == "$expected" ]] || { echo "session_rviz $*: '$said', not '$expected'" >&2; exit 1; }
}
program=$1
expect "rviz --disable-anti-aliasing -d a.rviz" auto -d a.rviz
expect "rviz --disable-anti-aliasing -d a.rviz" false -d a.rviz
expect "rviz -d a.rviz __name:=b" true -d a.rviz __name:=b
expect "session_rviz: smooth_edges: 'perhaps', must be auto, true or false" perhaps -d a.rviz
# What rviz loads reads files with decimal points, in whatever locale.
LC_ALL=de_DE.UTF-8 SAY_LOCALE=1 expect "rviz --disable-anti-aliasing -d a.rviz de_DE.UTF-8 none C" false -d a.rviz
