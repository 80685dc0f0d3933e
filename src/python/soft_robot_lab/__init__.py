# SPDX-License-Identifier: BSD-3-Clause
"""Soft robots from Python: simulated here without ROS, and in running sessions.

    import soft_robot_lab
    simulation = soft_robot_lab.Simulation('robot.yaml')
    simulation.set(left=0.9)
    simulation.settle()
    print(simulation.markers()['tip'])

    session = soft_robot_lab.Session.start('spinebot')  # needs ROS
    session.move(right=0.9)
"""
from ._core import (Batch, BatchReport, RunResult, SettingsError, Simulation, SolveReport, State, check_casting, fit, make_mould,
                    optimise)
from .environment import Environment, VectorEnvironment
from .learned_policy import LearnedPolicy
from .mesh import Mesh

__all__ = ['Batch', 'BatchReport', 'Environment', 'LearnedPolicy', 'Mesh', 'RunResult', 'SettingsError', 'Simulation', 'SolveReport',
           'State', 'VectorEnvironment', 'check_casting', 'fit', 'make_mould', 'optimise']
_OF_SESSIONS = ['Recording', 'Session', 'SessionError']


def __getattr__(name):
    """A client of sessions needs ROS's Python, which nothing else here does."""
    if name not in _OF_SESSIONS:
        raise AttributeError('module %r has no attribute %r' % (__name__, name))
    from . import session
    return getattr(session, name)


def __dir__():
    return sorted(set(globals()) | set(_OF_SESSIONS))


for _one in (Batch, BatchReport, Environment, LearnedPolicy, Mesh, RunResult, SettingsError, Simulation, SolveReport, State,
             VectorEnvironment):
    _one.__module__ = __name__
del _one
