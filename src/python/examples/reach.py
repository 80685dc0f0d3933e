#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Lets Spinebot's tip reach for three places, one after the other."""
from soft_robot_lab import Session

with Session.start('spinebot') as session:
    for target_m in ((0.03, 0, -0.09), (0.02, 0, -0.095), (-0.02, 0, -0.095)):
        print('%s: %.2f mm from it' % (target_m, 1e3 * session.reach('tip', target_m)))
