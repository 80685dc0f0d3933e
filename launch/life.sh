#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# life.sh ROBOT.yaml --output FOLDER: takes a robot through check_casting, make_mould, fidelity, workspace, a policy, a path, its emulated
# rig, calibration, a recorded table, report, fit and the fitted robot's policy, and writes one page, FOLDER/life.html, with a picture a
# step, times, errors, and what was refused and why. The same command goes on where it was stopped.
# Ends with 0 where each step was done or refused for a reason, with 1 where one broke down, with 2 for a bad file.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/usage.sh"
known_options=--output
usage 3 3 "$@"
exec /usr/bin/python3 -m soft_robot_lab.life "$@"
