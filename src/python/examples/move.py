#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pulls each cable of Spinebot a little, and prints how far the tip moves."""
import numpy

from soft_robot_lab import Session

with Session.start('spinebot') as session:
    session.play({1.0: session.commands})  # hangs at rest
    rest_m = session.markers()['tip']
    for name, (rest, *_) in session.actuators.items():
        session.play({1.0: {name: 0.95 * rest}})
        print('%s: %.1f mm' % (name, 1e3 * numpy.linalg.norm(session.markers()['tip'] - rest_m)))
        session.play({1.0: {name: rest}})
