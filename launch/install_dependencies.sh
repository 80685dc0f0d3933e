#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# install_dependencies.sh [--check | --all]: installs the Debian 12 packages that this package is built, run and tested with. Does
# nothing where all are there; --check only ends with 1 where some are missing; --all takes in what nightly tests use.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
known_options="--check --all"
usage 0 1 "$@"
if ! getent ahostsv4 localhost >/dev/null; then # as in a bare chroot; roslaunch asks for it whatever ROS_IP says
  echo "localhost does not resolve, so ROS cannot start: add the line '127.0.0.1 localhost' to /etc/hosts" >&2
  exit 1
fi
packages=(
  g++ make ninja-build cmake git catkin ros-message-generation
  libroscpp-dev libroslib-dev pluginlib-dev librosbag-dev libbz2-dev libdiagnostic-updater-dev libtf2-ros-dev
  libstd-msgs-dev libgeometry-msgs-dev libvisualization-msgs-dev libdiagnostic-msgs-dev libstd-srvs-dev
  libros-rosgraph-msgs-dev libdynamic-reconfigure-config-init-mutex-dev python3-dynamic-reconfigure
  ros-std-msgs ros-geometry-msgs ros-visualization-msgs ros-diagnostic-msgs ros-actionlib-msgs libactionlib-dev python3-actionlib python3-actionlib-msgs python3-rospy python3-numpy ros-std-srvs
  python3-roslaunch python3-rostopic python3-rosservice python3-rosnode python3-rosparam python3-rosbag python3-rosmsg
  python3-std-srvs python3-std-msgs python3-rosgraph-msgs python3-tf2-msgs python3-geometry-msgs python3-visualization-msgs python3-diagnostic-msgs rosout rosbash
  rviz librviz-dev libqwt-qt5-dev libinteractive-markers-dev xdotool xvfb xauth imagemagick libgl1-mesa-dri gnuplot-nox
  libeigen3-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev libgmsh-dev libceres-dev libpagmo-dev libopenblas-serial-dev libmetis-dev
  pybind11-dev python3-dev
  libsqlite3-dev libboost-dev libopenmpi-dev openmpi-bin
  libbullet-dev libopencv-dev libpcl-dev libembree-dev lib3mf-dev
  libmessage-filters-dev ros-sensor-msgs libsensor-msgs-dev python3-sensor-msgs
  gcc-avr avr-libc libsimavr-dev libelf-dev
  clang lld libclang-rt-dev libomp-dev clang-format clang-tidy universal-ctags catkin-lint admesh libgtest-dev librostest-dev python3-rostest libbenchmark-dev doxygen
)
[[ ${1-} != --all ]] || packages+=(prusa-slicer)
installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null | awk '$2 == "installed" {print $1}' || true)
mapfile -t missing < <(comm -23 <(printf '%s\n' "${packages[@]}" | sort -u) <(sort -u <<<"$installed"))
((${#missing[@]} > 0)) || exit 0
[[ ${1-} != --check ]] || exit 1

echo "Installing: ${missing[*]}"
as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || { echo "Missing packages, and no sudo to install them. As root: apt-get install ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
"${as_root[@]}" apt-get update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
