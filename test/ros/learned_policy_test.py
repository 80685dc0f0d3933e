#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The node of learned policies brings a simulated bar to a place, gives up where it cannot, and refuses another robot's policy."""
import os
import subprocess
import sys
import tempfile
import unittest

import numpy
import rostest

from soft_robot_lab import LearnedPolicy, Session

TARGET_M = (0.012, 0.0, -0.099)


def policy(**changes):
    """Of gains that are the same everywhere: what lies towards +x is come to by paying out the left cable and pulling the right one."""
    arrays = {'format': 1, 'actuators': ['left', 'right'], 'markers': ['tip', 'middle'], 'marker': 0, 'limits': [[0.85, 1.1], [0.85, 1.1]],
              'largest_change': 0.05, 'control_rate_hz': 28, 'unit_m': 0.01, 'inputs_mean': numpy.zeros(11), 'inputs_deviation': numpy.ones(11),
              'weights_0': numpy.zeros((11, 6)), 'biases_0': [1.0, 0.0, 0.0, -1.0, 0.0, 0.0]}
    return LearnedPolicy({name: numpy.array(array) for name, array in dict(arrays, **changes).items()})


class Node(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.session = Session()
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    @classmethod
    def tearDownClass(cls):
        cls.session.close()

    def run_node(self, made, *more):
        path = os.path.join(self.folder.name, 'policy.npz')
        made.save(path)
        done = subprocess.run(['rosrun', 'soft_robot_lab', 'learned_policy_node.py', path, '--markers', 'simulator', *more],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=100, check=False, universal_newlines=True)
        return done.returncode, done.stdout + done.stderr

    def test_it_reaches(self):
        self.session.play({0.5: {'left': 1.0, 'right': 1.0}})
        status, said = self.run_node(policy(), '--target', *map(str, TARGET_M))
        self.assertEqual(status, 0, said)
        self.assertIn('reached after', said)
        self.session.record(1.0)
        self.assertLess(numpy.linalg.norm(self.session.markers()['tip'] - TARGET_M), 1.5e-3, said)
        self.assertLess(self.session.commands['right'], 1.0)

    def test_it_gives_up_and_holds(self):
        self.session.play({0.5: {'left': 1.0, 'right': 1.0}})
        status, said = self.run_node(policy(largest_change=0.002), '--target', '0.1', '0', '-0.05', '--longest', '2')
        self.assertEqual(status, 1, said)
        self.assertIn('time is up', said)
        held = self.session.commands
        self.session.record(0.5)
        self.assertEqual(self.session.commands, held)
        low, high = 1.0 - 2.5 * 28 * 0.002 * 0.25, 1.0  # at the largest change of a range of 0.25
        self.assertTrue(low <= held['right'] < high, held)

    def test_it_refuses_another_robots_policy(self):
        for made, words in ((policy(actuators=['left', 'front']), "the policy moves 'front'; the session has: left, right"),
                            (policy(markers=['tip', 'elbow']), 'markers that the session has not: elbow'),
                            (policy(limits=[[0.1, 1.1], [0.85, 1.1]]), r'left: the policy commands [0.1, 1.1], the session takes [0.5, 1.5] 1')):
            status, said = self.run_node(made, '--target', '0', '0', '-0.1')
            self.assertEqual(status, 2, said)
            self.assertIn(words, said)
        done = subprocess.run(['rosrun', 'soft_robot_lab', 'learned_policy_node.py', '/no/policy.npz', '--target', '0', '0', '0'],
                              stderr=subprocess.PIPE, timeout=60, check=False, universal_newlines=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn('/no/policy.npz', done.stderr)


if __name__ == '__main__':
    rostest.rosrun('soft_robot_lab', 'learned_policy', Node, sys.argv)
