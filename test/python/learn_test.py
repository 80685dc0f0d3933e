# SPDX-License-Identifier: BSD-3-Clause
"""A small network learns to reach, repeats itself, and is kept as plain arrays; what is no such file is refused."""
import os
import sys
import tempfile
import unittest

import numpy

import soft_robot_lab
from scenes import BAR, SOURCE
from soft_robot_lab.learned_policy import LearnedLoop

sys.path.insert(0, os.path.join(SOURCE, 'src', 'python', 'examples'))
import learn  # noqa: E402

TASK = """
robot: reduced.yaml
task: reach
marker: tip
targets: {reachable: 8}
control_rate_hz: 20
episode_s: 1
action: {largest_change: 0.1, limits: {left: [0.91, 1.02], right: [0.95, 1.02]}}
observation: {noise_m: 5.0e-5}
randomisation: {file: random.yaml}
"""
REDUCED = 'include: %s\nsolver: {method: reduced, tolerance_m: 2.0e-3, commands: {left: [0.9, 1.02], right: [0.94, 1.02]}}' % BAR
RANDOM = 'samples: 2\nparameters: {backlash_m.left: {range: [0, 4.0e-4]}, camera_to_base.x_m: {normal: {mean: 0, deviation: 1.0e-3}}}'


class Learns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        for name, text in (('task.yaml', TASK), ('reduced.yaml', REDUCED), ('random.yaml', RANDOM)):
            with open(os.path.join(cls.folder.name, name), 'w', encoding='utf-8') as file:
                file.write(text)
        cls.task = os.path.join(cls.folder.name, 'task.yaml')
        cls.environment = soft_robot_lab.VectorEnvironment(cls.task, 16, 2)
        cls.policy, cls.about = learn.train(cls.environment, 0.05, networks=4)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def test_it_reaches_on_robots_that_it_has_not_seen(self):
        others = soft_robot_lab.VectorEnvironment(self.task, 16, 2, {'randomisation.seed': 3, 'seed': 2})
        targets_m = others.settings['targets']['points_m']
        learned_m = learn.final_distances_m(others, targets_m, lambda seen, _: self.policy.actions(seen))
        still_m = learn.final_distances_m(others, targets_m, lambda seen, _: numpy.zeros((16, 2)))
        wishes = learn.open_loop(others, targets_m)
        open_m = learn.final_distances_m(others, targets_m, lambda seen, targets: (wishes[targets] - seen[:, -2:]) / 0.2)
        self.assertEqual(learned_m.shape, (8, 2))
        self.assertLess(numpy.median(learned_m), 0.1 * numpy.median(still_m))
        self.assertLess(numpy.median(learned_m), numpy.median(open_m))  # which cannot see the camera's error
        self.assertLess(numpy.median(open_m), numpy.median(still_m))
        self.assertIn('median', learn.summary('learned', learned_m))

    def test_it_repeats_itself(self):
        again, about = learn.train(self.environment, 0.05, networks=4)
        self.assertEqual(about['rewards'], self.about['rewards'])
        for name, array in self.policy.arrays.items():
            self.assertEqual(again.arrays[name].tolist(), array.tolist())
        other, _ = learn.train(self.environment, 0.05, networks=4, seed=2)
        self.assertNotEqual(other.arrays['weights_0'].tolist(), again.arrays['weights_0'].tolist())

    def test_tasks_that_it_is_not_for_are_refused(self):
        for old, new in (('largest_change: 0.1', 'kind: command'), ('noise_m: 5.0e-5', 'kind: markers_and_tensions')):
            with open(self.path('other.yaml'), 'w', encoding='utf-8') as file:
                file.write(TASK.replace(old, new))
            with self.assertRaisesRegex(ValueError, 'the task must be to reach, by markers alone'):
                learn.train(soft_robot_lab.VectorEnvironment(self.path('other.yaml'), 2, 1))

    def test_slopes_are_those_of_the_loss(self):
        draw = numpy.random.default_rng(4)
        parameters = [numpy.array(array) for layer in self.policy.layers for array in layer]
        observations, wishes = draw.normal(scale=0.02, size=(20, 11)), draw.uniform(-1.5, 1.5, (20, 2))

        def half_loss(parameters):
            return learn.slopes_of(parameters, observations, wishes, self.policy)[1] * wishes.shape[1] / 2
        gradients, _ = learn.slopes_of(parameters, observations, wishes, self.policy)
        for i, gradient in enumerate(gradients):
            direction = draw.normal(size=gradient.shape)
            ends = []
            for step in (1e-6, -1e-6):
                moved = list(parameters)
                moved[i] = parameters[i] + step * direction
                ends.append(half_loss(moved))
            self.assertAlmostEqual((ends[0] - ends[1]) / 2e-6, (gradient * direction).sum(), delta=1e-5 * (1 + abs((gradient * direction).sum())))

    def test_it_is_kept_to_the_last_bit(self):
        self.policy.save(self.path('policy.npz'))
        loaded = soft_robot_lab.LearnedPolicy.load(self.path('policy.npz'))
        seen, _ = self.environment.reset(seed=5)
        self.assertEqual(loaded.actions(seen).tolist(), self.policy.actions(seen).tolist())
        self.assertEqual((loaded.actuators, loaded.markers, loaded.marker), (['left', 'right'], ['tip', 'middle'], 0))
        low, high = loaded.limits.T
        commands = low + 0.5 * (seen[0, -2:] + 1) * (high - low)
        following = loaded.commands(seen[0, :6].reshape(2, 3), seen[0, 6:9], commands)
        numpy.testing.assert_allclose(following, numpy.clip(commands + 0.1 * loaded.actions(seen)[0] * (high - low), low, high), atol=1e-15)

    def test_at_the_target_commands_stay_and_limits_hold(self):
        at_m = numpy.array([[0.001, 0, -0.1], [0, 0, -0.05]])
        self.assertEqual(self.policy.commands(at_m, at_m[0], [0.95, 1.0]).tolist(), [0.95, 1.0])
        low, high = self.policy.limits.T
        draw = numpy.random.default_rng(1)
        for _ in range(100):
            commands = draw.uniform(low, high)
            following = self.policy.commands(draw.normal(size=(2, 3)), draw.normal(size=3), commands)
            self.assertTrue((following >= low).all() and (following <= high).all())
            self.assertLessEqual((abs(following - commands) / (high - low)).max(), self.policy.largest_change + 1e-12)
        for wrong, name in (((at_m[:1], at_m[0], [1, 1]), 'markers_m'), ((at_m, [0, 0], [1, 1]), 'target_m'),
                            ((at_m, at_m[0], [1, float('nan')]), 'commands')):
            with self.assertRaisesRegex(ValueError, name):
                self.policy.commands(*wrong)

    def test_from_beyond_the_limits_it_comes_back_slowly(self):
        at_m = numpy.array([[0.001, 0, -0.1], [0, 0, -0.05]])
        low, high = self.policy.limits.T
        following = self.policy.commands(at_m, at_m[0], [1.05, 0.9])
        numpy.testing.assert_allclose(following, [1.05 - 0.1 * (high[0] - low[0]), 0.9 + 0.1 * (high[1] - low[1])])

    def loop(self, **named):
        return LearnedLoop(self.policy, [0.0, 0.0, -0.1], [0.95, 1.0], **named)

    def test_a_loop_gives_commands_for_whole_frames_at_its_rate(self):
        loop = self.loop()
        away = {'tip': (0.005, 0.0, -0.1), 'middle': (0.0, 0.0, -0.05), 'other': (0.0, 0.0, 0.0)}
        first = loop.see(0.0, away)
        numpy.testing.assert_array_equal(first, self.policy.commands([away['tip'], away['middle']], [0, 0, -0.1], [0.95, 1.0]))
        self.assertIsNone(loop.see(0.02, away))  # of 20 a second
        self.assertIsNone(loop.see(0.05, {'tip': away['tip']}))
        self.assertIsNone(loop.see(0.06, dict(away, middle=(0.0, float('nan'), 0.0))))
        numpy.testing.assert_array_equal(loop.see(0.07, away), self.policy.commands([away['tip'], away['middle']], [0, 0, -0.1], first))
        self.assertEqual((loop.end, loop.distance_m), ('', 0.005))

    def test_a_loop_ends_with_its_reason(self):
        def at(x_m):
            return {'tip': (x_m, 0.0, -0.1), 'middle': (0.0, 0.0, -0.05)}
        for end, frames, named in (
                ('reached', [(0.1 * i, 0.001) for i in range(12)], {}),
                ('', [(0.1 * i, 0.001 if i % 5 else 0.002) for i in range(12)], {}),
                ('the error grows', [(0.0, 0.01), (0.1, 0.025), (0.2, 0.031)], {}),
                ('time is up', [(0.3 * i, 0.01) for i in range(12)], {'longest_s': 3.0}),
                ('tracking is lost', [(0.0, 0.01), (1.5, 0.01)], {})):
            with self.subTest(end):
                loop = self.loop(**named)
                given = [loop.see(time_s, at(x_m)) for time_s, x_m in frames]
                self.assertEqual(loop.end, end)
                self.assertEqual(given[-1] is None, end != '')
        unseen = self.loop()
        unseen.wait(5.0)
        self.assertEqual(unseen.end, '')
        unseen.wait(6.1)
        self.assertEqual(unseen.end, 'tracking is lost')
        self.assertIsNone(unseen.see(6.2, at(0.0)))

    def test_a_loop_refuses(self):
        for named, text in (({'within_m': 0}, r'within_m: 0 is out of range \(0, inf\)'), ({'longest_s': float('nan')}, 'longest_s: nan')):
            with self.assertRaisesRegex(ValueError, text):
                self.loop(**named)
        with self.assertRaisesRegex(ValueError, 'target_m'):
            LearnedLoop(self.policy, [0, 0, float('inf')], [1, 1])

    def test_what_is_no_policy_is_refused(self):
        for change, text in (
                ({'weights_0': numpy.zeros((11, 3))}, r'biases_0: of shape \(32,\), must be \(3,\)'),
                ({'weights_0': numpy.zeros(3)}, r'weights_0: of shape \(3,\), must be \(11, 3\)'),
                ({'biases_2': numpy.full(6, numpy.nan)}, 'biases_2: .*all finite'),
                ({'limits': numpy.array([[1.0, 0.9], [0.9, 1.0]])}, r'limits: .* is out of range \[least, largest\]'),
                ({'largest_change': numpy.array(1.5)}, r'largest_change: 1.5 is out of range \(0, 1\]'),
                ({'control_rate_hz': numpy.array(0.0)}, r'control_rate_hz: 0.0 is out of range \(0, 10000\]'),
                ({'marker': numpy.array(2)}, r'marker: 2 is out of range \[0, 1\]'),
                ({'format': numpy.array(2)}, 'format: 2 is out of range 1'),
                ({'actuators': numpy.array(['left'])}, 'must be'),
                ({'markers': numpy.array([1, 2])}, 'markers: must be a list of names'),
                ({'more': numpy.array(1)}, 'more: is not known'),
                ({'inputs_mean': None}, 'inputs_mean: is missing')):
            with self.subTest(text):
                arrays = dict(self.policy.arrays, **change)
                numpy.savez(self.path('wrong.npz'), **{name: array for name, array in arrays.items() if array is not None})
                with self.assertRaisesRegex(ValueError, 'wrong.npz: .*' + text):
                    soft_robot_lab.LearnedPolicy.load(self.path('wrong.npz'))
        numpy.savez(self.path('objects.npz'), **dict(self.policy.arrays, actuators=numpy.array([{}], dtype=object)))
        with open(self.path('text.npz'), 'w', encoding='utf-8') as file:
            file.write('weights')
        for name in ('objects.npz', 'text.npz', 'task.yaml'):
            with self.assertRaisesRegex(ValueError, name):
                soft_robot_lab.LearnedPolicy.load(self.path(name))
        with self.assertRaises(OSError):
            soft_robot_lab.LearnedPolicy.load(self.path('nothing.npz'))


if __name__ == '__main__':
    unittest.main()
