#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Actions and the Python module: it moves a simulated bar, lets it reach a point, and records it."""
import os
import sys
import tempfile
import threading
import time
import unittest

import actionlib
import numpy
import rospy
import rostest
from actionlib import CommState
from actionlib_msgs.msg import GoalStatus

from soft_robot_lab import Session, SessionError
from soft_robot_lab.msg import FollowPathAction, FollowPathGoal, OptimisePolicyAction, OptimisePolicyGoal, ReachAction, ReachGoal
from soft_robot_lab.session import _links


class Client(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.session = Session()

    @classmethod
    def tearDownClass(cls):
        cls.session.close()

    def setUp(self):
        self.session.reset()
        self.session.play({0.5: {'left': 1.0, 'right': 1.0}})
        self.rest_m = self.session.markers()['tip']

    def test_moves_and_measures(self):
        self.session.move(left=0.9)
        self.assertEqual(self.session.commands, {'left': 0.9, 'right': 1.0})
        seen = self.session.record(1.0)
        self.assertGreater(numpy.linalg.norm(seen.markers_m['tip'][-1] - self.rest_m), 5e-3)
        self.assertGreater(self.session.tensions_n['left'], self.session.tensions_n['right'])

    def test_knows_where_a_policy_ended(self):
        answer = self.session.play({0.5: {'left': 0.9, 'right': 1.0}})
        self.assertEqual(self.session.commands['left'], 0.9)
        end_m = next(p for name, p in zip(answer.markers.names, answer.markers.positions) if name == 'tip')
        self.assertAlmostEqual(self.session.markers()['tip'][0], end_m.x, delta=5e-4)

    def test_records_arrays_of_one_length(self):
        seen = self.session.record(0.5)
        count = len(seen.time_s)
        self.assertTrue((numpy.diff(seen.time_s) > 0).all())
        self.assertGreaterEqual(seen.time_s[-1] - seen.time_s[0], 0.5)
        self.assertEqual({name: places.shape for name, places in seen.markers_m.items()}, {'tip': (count, 3), 'middle': (count, 3)})
        self.assertEqual({name: values.shape for name, values in seen.commands.items()}, {'left': (count,), 'right': (count,)})
        numpy.testing.assert_allclose(seen.markers_m['tip'], numpy.tile(self.rest_m, (count, 1)), atol=2e-3)

    def test_optimises_and_plays(self):
        target_m = (0.02, 0.0, -0.095)
        found = self.session.optimise('tip', target_m)
        self.assertLess(found.summary.final_distance_m, found.summary.initial_distance_m)
        self.session.play(found.policy)
        gap_m = numpy.linalg.norm(self.session.markers()['tip'] - target_m)
        self.assertAlmostEqual(gap_m, found.summary.final_distance_m, delta=1e-3)

    def test_reaches_a_place_by_one_action(self):
        client = self.client('/controller/reach', ReachAction)
        goal, stages, iterations = ReachGoal(marker='tip'), set(), []
        goal.target.header.frame_id = 'world'
        goal.target.pose.position.x, goal.target.pose.position.z = 0.02, -0.095
        client.send_goal(goal, feedback_cb=lambda heard: (stages.add(heard.stage), iterations.append(heard.progress.iteration)))
        self.assertTrue(client.wait_for_result(rospy.Duration(100.0)))
        result = client.get_result()
        self.assertEqual(client.get_state(), GoalStatus.SUCCEEDED, result.message)
        self.assertAlmostEqual(result.final_distance_m, result.summary.final_distance_m, delta=1e-3)
        self.assertEqual(stages, {'searches', 'moves'})
        self.assertGreater(max(iterations), 0)
        goal.marker = 'elbow'
        self.assertIn('elbow', self.refusal(client, goal))
        goal.marker, goal.target.header.frame_id = 'tip', 'nowhere'
        self.assertEqual("header.frame_id: no transform leads from 'nowhere' to 'robot_base'", self.refusal(client, goal))

    def path(self, top_m=0.0026, marker='tip', duration_s=2.0):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = os.path.join(folder.name, 'path.yaml')
        with open(file, 'w', encoding='utf-8') as out:
            out.write('{marker: %s, plane: {center_m: [0, 0, -0.1], across: [1, 0, 0], up: [0, 0, 1]}, curve: {polyline_m: '
                      '[[0.0063, 0.0011], [0.0125, %g]]}, tolerance_m: 0.0005, duration_s: %g, samples: 8}' % (marker, top_m, duration_s))
        return file

    def test_follows_a_path(self):
        planned = self.session.follow(self.path(), plan_only=True)
        self.assertLess(planned.out_of_reach_m, 5e-4)
        self.assertAlmostEqual(planned.duration_s, 2.0, delta=0.5)
        self.assertEqual(len(planned.policy.steps), 8)
        self.assertEqual(self.session.commands, {'left': 1.0, 'right': 1.0})
        followed = self.session.follow(self.path())
        self.assertLess(followed.simulated_rms_m[0], 1e-3)
        self.assertEqual(list(followed.measured_rms_m), [-1.0])
        self.session.record(0.3)  # until the last command is heard
        for name, value in zip(followed.policy.names, followed.policy.steps[-1].values):
            self.assertAlmostEqual(self.session.commands[name], value, delta=1e-9)

    def test_says_why_a_path_is_not_followed(self):
        client = self.client('/controller/follow_path', FollowPathAction)
        for goal, words in ((FollowPathGoal(path='path.yaml'), "path: 'path.yaml' is no whole path"),
                            (FollowPathGoal(path='/nowhere/path.yaml'), '/nowhere/path.yaml'),
                            (FollowPathGoal(path=self.path(), rounds=3), 'rounds: learning needs feedback'),
                            (FollowPathGoal(path=self.path(), rounds=-1, feedback=True), 'rounds: -1 is not in'),
                            (FollowPathGoal(path=self.path(), duration_s=float('nan')), 'duration_s: nan'),
                            (FollowPathGoal(path=self.path(marker='elbow')), 'elbow'),
                            (FollowPathGoal(path=self.path(top_m=0.02)), 'curve: out of reach by'),
                            (FollowPathGoal(path=self.path(), feedback=True), "marker 'tip' was not seen for 2")):
            self.assertIn(words, self.refusal(client, goal))

    def test_ends_a_path_that_is_preempted(self):
        client = self.client('/controller/follow_path', FollowPathAction)
        along = threading.Event()
        client.send_goal(FollowPathGoal(path=self.path(duration_s=60.0)),
                         feedback_cb=lambda heard: along.set() if heard.stage == 'follows' and heard.path_s > 1.0 else None)
        self.assertTrue(along.wait(60.0))
        client.cancel_goal()
        self.assertTrue(client.wait_for_result(rospy.Duration(60.0)))
        self.assertEqual(client.get_state(), GoalStatus.PREEMPTED)
        self.session.record(0.3)  # until the last command is heard
        held = self.session.commands
        self.session.record(0.5)
        self.assertEqual(self.session.commands, held)

    # rospy counts a link before it is there; what is sent meanwhile is lost.
    def client(self, name, kind):
        client = actionlib.SimpleActionClient(name, kind)
        self.assertTrue(client.wait_for_server(rospy.Duration(60.0)))
        for _ in range(600):
            if any(link[1] == rospy.get_name() and link[4] == name + '/feedback' for link in _links('/controller')):
                return client
            time.sleep(0.1)
        raise AssertionError('no feedback comes from ' + name)

    # SimpleActionClient drops an answer that comes before its send_goal returns, and then waits for ever.
    def refusal(self, client, goal):
        refused = client.action_client.send_goal(goal)
        for _ in range(600):
            if refused.get_comm_state() == CommState.DONE:
                break
            time.sleep(0.1)
        self.assertEqual(refused.get_goal_status(), GoalStatus.ABORTED)
        return refused.get_result().message

    def test_ends_an_action_that_is_preempted(self):
        client = self.client('/controller/optimise_policy', OptimisePolicyAction)
        heard = threading.Event()
        goal = OptimisePolicyGoal(method='cma_es', marker='tip', max_iterations=100000, tolerance_m=1e-9)
        goal.target.x, goal.target.z = 0.02, -0.095
        client.send_goal(goal, feedback_cb=lambda _: heard.set())
        self.assertTrue(heard.wait(60.0))
        client.cancel_goal()
        self.assertTrue(client.wait_for_result(rospy.Duration(100.0)))
        self.assertEqual(client.get_state(), GoalStatus.PREEMPTED)
        self.assertTrue(client.get_result().policy.steps, 'the best so far counts')

    def test_refuses_in_the_sessions_words(self):
        for wrong, words in ((lambda: self.session.move(elbow=0.9), "no actuator 'elbow'; there are: left, right"),
                             (lambda: self.session.move(left=7.0), r'left: 7 is not in \['),
                             (lambda: self.session.optimise('elbow', (0, 0, 0)), 'elbow'),
                             (lambda: self.session.play({1.0: {'left': 0.9}, 2.0: {'right': 0.9}}), 'each step needs all'),
                             (lambda: self.session.load('/no/such/file.yaml'), 'no/such/file.yaml'),
                             (lambda: self.session.markers('tracker'), 'no markers of the tracker')):
            with self.assertRaisesRegex(SessionError, words):
                wrong()


if __name__ == '__main__':
    rostest.rosrun('soft_robot_lab', 'python_client', Client, sys.argv)
