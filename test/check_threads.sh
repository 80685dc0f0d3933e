#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# check_threads.sh BUILD_FOLDER: builds the nodes with threads and the tests that use them there with the thread
# sanitiser, runs these, and ends with status 1 where one failed or a race was found.
set -euo pipefail
package=$(cd "$(dirname "$0")/.." && pwd)
build=$1
reports=$build/thread_reports
cmake -S "$package" -B "$build" -DSOFT_ROBOT_LAB_SANITISE=thread -DCMAKE_UNITY_BUILD=OFF
cmake --build "$build" -j"${JOBS:-2}" --target build_thread_tests
rm -rf "$reports"
mkdir "$reports"
unset ROS_HOSTNAME
export ROS_IP=127.0.0.1 # the machine's own name need not resolve
# rostest does not look at the status of nodes: what the sanitiser says of each process goes to a file.
export TSAN_OPTIONS="suppressions=$package/test/thread_suppressions.txt log_path=$reports/report history_size=7"
status=0
ctest --test-dir "$build" --output-on-failure --timeout 900 -R '_test_ros_(session|controller_faults|fit_service)\.test$' || status=$?
if [[ -n $(ls "$reports") ]]; then
  cat "$reports"/*
  exit 1
fi
exit "$status"
