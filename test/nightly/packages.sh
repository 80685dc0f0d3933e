#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# packages.sh [FOLDER]: installs Debian packages, those of the folder or newly made ones, into a fresh Debian 12 by debootstrap, and lets a
# session run there without a compiler: Spinebot reaches for a ball and is recorded, as in the demonstration. Before that lintian looks at them,
# where there is one. As root; needs debootstrap and a Debian mirror, that of this machine's apt.
set -euo pipefail
package=$(cd "$(dirname "$0")/../.." && pwd)
((EUID == 0)) || { echo "skipped: debootstrap needs root"; exit 77; }
command -v debootstrap >/dev/null || { echo "skipped: no debootstrap"; exit 77; }
work=$(mktemp -d)
end() { umount "$work/root/proc" "$work/root/sys" "$work/root/dev" 2>/dev/null || true; rm -rf --one-file-system "$work"; }
trap end EXIT
folder=${1:-$work/packages}
[[ -n ${1-} ]] || "$package/launch/make_packages.sh" "$folder"
# Some of our small libraries call nothing of libc themselves, only of libstdc++.
! command -v lintian >/dev/null || lintian --allow-root --fail-on error,warning --suppress-tags library-not-linked-against-libc "$folder"/*.deb

mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | head -1)
debootstrap --variant=minbase bookworm "$work/root" "$mirror" >"$work/log" || { tail "$work/log"; exit 1; }
for file in /etc/apt/sources.list /etc/apt/sources.list.d /etc/apt/apt.conf.d /etc/resolv.conf; do
  [[ ! -e $file ]] || cp -rL "$file" "$work/root$(dirname "$file")/"
done
echo "127.0.0.1 localhost" >"$work/root/etc/hosts"
mkdir "$work/root/packages"
cp "$folder"/*.deb "$work/root/packages"
for system in proc sys dev; do mount --bind "/$system" "$work/root/$system"; done
inside() { chroot "$work/root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive ROS_IP=127.0.0.1 "$@"; }
inside apt-get update -q >"$work/log" 2>&1
start=$SECONDS
inside bash -c 'apt-get install -y -q --no-install-recommends /packages/*.deb' >"$work/log" 2>&1 || { tail -n 20 "$work/log"; exit 1; }
echo "installed in $((SECONDS - start)) s"
! inside bash -c 'command -v g++ || command -v clang++' || echo "with a compiler, which -dev wants"
inside rosrun soft_robot_lab simulate /usr/share/soft_robot_lab/config/robots/spinebot/robot.yaml --result /tmp/result.json
inside bash -c 'cd /tmp && rosrun soft_robot_lab new_robot.sh finger'
inside python3 -c 'import soft_robot_lab; s = soft_robot_lab.Simulation("/tmp/finger.yaml"); s.settle(); print(s.markers()["tip"])'
start=$SECONDS
inside bash -c '
  port=$(/usr/lib/soft_robot_lab/free_port.py)
  robot=/usr/share/soft_robot_lab/config/robots/spinebot
  roslaunch -p $port soft_robot_lab session.launch robot:=spinebot scene:=$robot/touching.yaml rviz:=false record:=true bag_folder:=/tmp/bags >/tmp/session.log 2>&1 &
  export ROS_MASTER_URI=http://127.0.0.1:$port
  until rostopic list >/dev/null 2>&1; do kill -0 $! || { cat /tmp/session.log; exit 1; }; sleep 0.2; done
  timeout 600 rosrun soft_robot_lab reach_target_node $robot/tasks/ball.yaml || { cat /tmp/session.log; exit 1; }
  kill -INT $!
  wait
  rosbag info /tmp/bags/*.bag | grep messages:'
echo "a session, a reached ball and a recording in $((SECONDS - start)) s"
