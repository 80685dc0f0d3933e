#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A session's port is none that Linux may hand out before its master has it, nor one that is taken.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../launch/environment.sh"
read -r first last </proc/sys/net/ipv4/ip_local_port_range
((master_port < first || master_port > last)) || { echo "$master_port may be handed out: $first to $last"; exit 1; }
rosmaster --core -p "$master_port" >/dev/null 2>&1 &
trap 'kill %1; wait || true' EXIT
until rosparam list >/dev/null 2>&1; do sleep 0.1; done
other=$("$package/launch/free_port.py")
[[ $other != "$master_port" ]] || { echo "$other has a master"; exit 1; }
read -r one another < <("$package/launch/free_port.py" 2)
[[ -n $another && $one != "$another" ]] || { echo "two ports: $one and $another"; exit 1; }
