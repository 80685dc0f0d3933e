#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Lets go of a pulled cable, and prints how the tip swings: its sideways place twenty times a second."""
from soft_robot_lab import Session

with Session.start('spinebot') as session:
    session.play({1.0: {'right': 0.9}})
    session.move(right=1.0)  # within the drive's speed
    seen = session.record(2.0)
    for step in range(40):
        i = seen.time_s.searchsorted(seen.time_s[0] + 0.05 * step)
        print('%.2f s: %6.2f mm' % (seen.time_s[i] - seen.time_s[0], 1e3 * seen.markers_m['tip'][i, 0]))
