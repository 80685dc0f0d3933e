#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Brings a marker of the running session to a target by a policy that was learned, from what is seen of the markers.

Each frame that shows all markers gives new commands, at most as often as the policy was trained for, within its limits and its largest change.
It ends when the marker has stayed near for a second, when tracking is lost, the error grows, or time is up; drives then hold where they are.
Exit status: 0 reached, 1 not, 2 bad policy or arguments."""
import argparse
import sys
import threading
import time

import rospy

from soft_robot_lab import LearnedPolicy, Session, SessionError
from soft_robot_lab.learned_policy import LearnedLoop
from soft_robot_lab.msg import MarkerObservations

_GOOD, _NOT_GOOD, _BAD = 0, 1, 2


def arguments_of(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('policy', metavar='POLICY.npz', help='as learn.py writes it')
    parser.add_argument('--target', nargs=3, type=float, required=True, metavar=('X', 'Y', 'Z'), help='[m, robot_base]')
    parser.add_argument('--markers', choices=('tracker', 'simulator'), default='tracker', help='whose are seen')
    parser.add_argument('--within', type=float, default=1.5e-3, metavar='M', help='of the target [m] (%(default)s)')
    parser.add_argument('--longest', type=float, default=60.0, metavar='S', help='then it gives up [s] (%(default)s)')
    return parser.parse_args(words)


class Frames:
    """The newest markers of a source."""

    def __init__(self, source):
        self._changed, self._newest = threading.Condition(), None
        rospy.Subscriber('%s/markers' % source, MarkerObservations, self._on_markers, queue_size=1)

    def _on_markers(self, message):
        with self._changed:
            self._newest = message
            self._changed.notify_all()

    def next(self, longest_s):
        """(time in seconds, {name: position}), or None where none came."""
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not None, longest_s)
            message, self._newest = self._newest, None
        return message and (message.header.stamp.to_sec(), {name: (p.x, p.y, p.z) for name, p in zip(message.names, message.positions)})


def require_fits(policy, session):
    """ValueError where the session's robot is not the policy's."""
    there = session.actuators
    for name, (low, high) in zip(policy.actuators, policy.limits):
        if name not in there:
            raise ValueError("the policy moves '%s'; the session has: %s" % (name, ', '.join(there)))
        _, least, most, unit = there[name]
        if low < least or high > most:
            raise ValueError('%s: the policy commands [%g, %g], the session takes [%g, %g] %s' % (name, low, high, least, most, unit))
    missing = set(policy.markers) - set(session.markers())
    if missing:
        raise ValueError('the policy sees markers that the session has not: ' + ', '.join(sorted(missing)))


def follow(policy, session, frames, asked):
    loop = LearnedLoop(policy, asked.target, [session.commands[name] for name in policy.actuators], asked.within, longest_s=asked.longest)
    while not loop.end and not rospy.is_shutdown():
        seen = frames.next(0.1)
        if seen is None:
            loop.wait(rospy.get_time())
            continue
        commands = loop.see(*seen)
        if commands is not None:
            session.move(**dict(zip(policy.actuators, commands.tolist())))
    return loop


def main(words):
    asked = arguments_of(words)
    try:
        policy = LearnedPolicy.load(asked.policy)
        session = Session()
        require_fits(policy, session)
        begin_s = time.monotonic()
        loop = follow(policy, session, Frames(asked.markers), asked)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return _BAD
    except SessionError as error:
        print(error, file=sys.stderr)
        return _NOT_GOOD
    distance = 'no marker was seen' if loop.distance_m is None else '%.2f mm from the target' % (1e3 * loop.distance_m)
    print('%s after %.1f s, %s' % (loop.end or 'stopped', time.monotonic() - begin_s, distance))
    for name, value in zip(policy.actuators, loop.sent):
        print('command           %s = %.4f' % (name, value))
    return _GOOD if loop.end == 'reached' else _NOT_GOOD


if __name__ == '__main__':
    sys.exit(main(rospy.myargv(sys.argv)[1:]))
