# SPDX-License-Identifier: BSD-3-Clause
"""A session of soft_robot_lab from Python: move a robot, find policies, play them, and have what it did as NumPy arrays.

    from soft_robot_lab import Session
    session = Session.start('spinebot')
    session.move(right=0.9)
    print(session.markers()['tip'])
"""
from .session import Recording, Session, SessionError

__all__ = ['Recording', 'Session', 'SessionError']
