# SPDX-License-Identifier: BSD-3-Clause
# Source this: makes the built package known to ROS programs, with a ROS master of its own on a free port, so that a
# master that already runs is not disturbed.
package=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
set +u # not written for it
. "${SOFT_ROBOT_LAB_SETUP:-$package/devel/setup.bash}"
set -u
master_port=$("$package/launch/free_port.py")
export ROS_MASTER_URI=http://127.0.0.1:$master_port ROS_IP=127.0.0.1 ROSCONSOLE_STDOUT_LINE_BUFFERED=1
unset ROS_HOSTNAME ROS_NAMESPACE
