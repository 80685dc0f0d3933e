#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""python_policy_test.py MODULES: what the Python client asks for when it plays a policy; needs no session."""
import sys

sys.path.insert(0, sys.argv[1])
from soft_robot_lab.msg import Policy, PolicyStep  # noqa: E402
from soft_robot_lab.session import Session, SessionError  # noqa: E402


class Listener(Session):
    """Keeps what it would ask a session for."""

    def __init__(self):  # joins none
        self.asked = []

    def _ask(self, service, kind, request):
        self.asked.append(request)
        raise SessionError('no session')


def played(policy):
    session = Listener()
    try:
        session.play(policy)
    except SessionError as error:
        return session.asked, str(error)
    raise AssertionError('played')


# A session takes a policy without commands for the one that was found last, and the robot would move.
for empty in ({}, {1.0: {}}, Policy(), Policy(names=['left']), Policy(steps=[PolicyStep(time_s=1.0)])):
    asked, words = played(empty)
    assert not asked, empty
    assert words == 'policy: it has no commands; None plays what was found last', words
asked, _ = played(None)
assert asked and not asked[0].policy.names, 'what was found last'
asked, _ = played({2.0: {'left': 0.9}})
assert asked[0].policy.names == ['left'] and asked[0].policy.steps[0].values == [0.9], asked
