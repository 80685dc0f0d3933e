# SPDX-License-Identifier: BSD-3-Clause
"""Environments: what they see and pay, their repeatability to the last bit, and what is refused."""
import importlib
import os
import pickle
import sys
import tempfile
import types
import unittest

import numpy

import soft_robot_lab
from scenes import BAR, SOURCE
from soft_robot_lab import environment, spaces

TASK = """
robot: %s
task: reach
marker: tip
targets: {points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]}
control_rate_hz: 30
episode_s: 0.2
""" % BAR
RANDOM = """
samples: 3
parameters:
  body.material.youngs_modulus_pa: {range: [2.0e+5, 3.0e+5]}
  backlash_m.left: {range: [3.0e-4, 5.0e-4]}
  camera_to_base.rz_rad: {normal: {mean: 0, deviation: 0.1}}
  camera_to_base.x_m: {normal: {mean: 0, deviation: 1.0e-3}}
"""
DRAWN = TASK + """
randomisation: {file: random.yaml}
observation: {kind: markers_and_tensions, noise_m: 1.0e-4}
action: {limits: {left: [0.85, 1.05], right: [0.85, 1.05]}}
"""


class Tasks(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.written('random.yaml', RANDOM)

    def written(self, name, text):
        path = os.path.join(self.folder.name, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def task(self, text=TASK, more=''):
        return self.written('task.yaml', text + more)

    def refused(self, kind, text, call, *arguments, **named):
        with self.assertRaisesRegex(kind, text):
            call(*arguments, **named)


def played(made, steps=9, seed=5):
    """All that a vector of worlds says through more than one episode, as bytes."""
    said = [made.reset(seed=seed)]
    actions = numpy.random.default_rng(3)
    for _ in range(steps):
        said.append(made.step(actions.uniform(-1, 1, (2, 2)) if made.num_envs == 2 else actions.uniform(-1, 1, made.action_space.shape)))
    return pickle.dumps(said)


class Episodes(Tasks):
    def test_an_episode(self):
        made = soft_robot_lab.Environment(self.task())
        seen, info = made.reset(seed=1)
        self.assertEqual(seen.shape, (6 + 3 + 2,))
        self.assertTrue(made.observation_space.contains(seen))
        simulation = soft_robot_lab.Simulation(BAR, {'solver.time_step_s': 1 / 60})
        simulation.settle()
        self.assertEqual(seen[:6].tolist(), simulation.markers_m.ravel().tolist())
        self.assertIn(seen[6:9].tolist(), [[0.01, 0, -0.099], [-0.01, 0, -0.099]])
        low, high = made.settings['limits']['left']
        self.assertAlmostEqual(seen[9], 2 * (1.0 - low) / (high - low) - 1)
        for count in range(1, 7):
            seen, reward, terminated, truncated, info = made.step([-1.0, 0.0])
            self.assertAlmostEqual(info['commands'][0], max(low, 1.0 - 0.1 * count * (high - low)))
            simulation.commands = info['commands']
            simulation.step()
            simulation.step()
            self.assertEqual(seen[:6].tolist(), simulation.markers_m.ravel().tolist())
            distance_m = numpy.linalg.norm(simulation.markers()['tip'] - seen[6:9])
            self.assertAlmostEqual(info['distance_m'], distance_m, places=15)
            self.assertAlmostEqual(reward, -100 * distance_m, places=12)
            self.assertEqual((terminated, truncated), (False, count == 6))
        self.refused(RuntimeError, 'reset', made.step, [0.0, 0.0])

    def test_commands_and_bonus(self):
        made = soft_robot_lab.Environment(self.task(TASK, """
within_m: 0.5
reward: {distance_per_m: 0, change: 0.5, within: 3}
action: {kind: command, limits: {left: [0.8, 1.0]}}
"""))
        made.reset(seed=1)
        _, reward, _, _, info = made.step(numpy.array([0.5, -7.0]))  # what is beyond 1 counts as 1
        self.assertEqual(info['commands'].tolist(), [0.95, made.settings['limits']['right'][0]])
        self.assertTrue(info['is_success'])
        self.assertAlmostEqual(reward, 3 - 0.5 * 1.25)

    def test_a_path_moves_the_goal(self):
        text = TASK.replace('task: reach', 'task: track').replace('targets: {points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]}', """
path: [{time_s: 0, position_m: [0, 0, -0.1]}, {time_s: 0.1, position_m: [0.03, 0, -0.1]}]""")
        made = soft_robot_lab.Environment(self.task(text))
        seen, _ = made.reset()
        self.assertEqual(seen.shape, (6 + 6 + 2,))
        goals_m = [seen[6]]
        for _ in range(4):
            seen, reward, _, _, info = made.step([0.0, 0.0])
            goals_m.append(seen[6])
            self.assertAlmostEqual(seen[9], min(seen[6] + 0.01, 0.03))
            self.assertAlmostEqual(-reward / 100, numpy.linalg.norm(seen[:3] - seen[6:9]))
        numpy.testing.assert_allclose(goals_m, [0, 0.01, 0.02, 0.03, 0.03], atol=1e-15)
        self.refused(ValueError, "'target_m' is not one of plant", made.reset, options={'target_m': [0, 0, 0]})

    def test_targets_by_region_and_reach(self):
        box = TASK.replace('points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]', 'min_m: [0, 0, -0.1], max_m: [0.01, 0, -0.09]')
        made = soft_robot_lab.Environment(self.task(box))
        targets_m = numpy.array([made.reset()[1]['target_m'] for _ in range(20)])
        self.assertTrue((targets_m >= [0, 0, -0.1]).all() and (targets_m <= [0.01, 0, -0.09]).all())
        self.assertEqual(len(set(map(tuple, targets_m))), 20)
        reach = TASK.replace('points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]', 'reachable: 3') + \
            'action: {limits: {left: [0.9, 1.0], right: [1.0, 1.05]}}\nrandomisation: {file: random.yaml}'
        targets_m = soft_robot_lab.Environment(self.task(reach)).settings['targets']['points_m']
        found = soft_robot_lab.optimise(BAR, [{'tip': target_m} for target_m in targets_m])
        self.assertEqual(targets_m.shape, (3, 3))
        self.assertLess(max(pose['final_distance_m'] for pose in found['poses']), 2e-5)

    def test_what_is_drawn(self):
        made = soft_robot_lab.Environment(self.task(DRAWN))
        firsts = {}
        for plant in range(3):
            seen, info = made.reset(options={'plant': plant, 'target_m': [0, 0, -0.1]})
            self.assertEqual((info['plant'], info['target_m'].tolist()), (plant, [0, 0, -0.1]))
            self.assertEqual(seen.shape, (6 + 3 + 2 + 2,))
            firsts[plant] = seen
            before = made.batch.reached[0]
            made.step([1.0, 0.0])  # pays out: the play takes it up
            self.assertGreater(made.step([1.0, 0.0])[4]['commands'][0] - made.batch.commands[0, 0], 3e-4 / 0.1)
            self.assertLess(before[0], 1.01)
        self.assertGreater(numpy.linalg.norm(firsts[0][:6] - firsts[1][:6]), 1e-4)
        self.assertEqual(len({made.reset()[1]['plant'] for _ in range(30)}), 3)
        with_other_seed = soft_robot_lab.Environment(self.task(DRAWN), {'randomisation.seed': 2, 'randomisation.samples': 2})
        self.assertNotEqual(with_other_seed.reset(options={'plant': 0})[0][0], firsts[0][0])

    def test_a_camera_is_off_as_drawn(self):
        self.written('random.yaml', 'samples: 2\nparameters: {camera_to_base.rz_rad: {values: [1.5707963267948966]}, '
                                    'camera_to_base.y_m: {values: [0.002]}}')
        made = soft_robot_lab.Environment(self.task(TASK, 'randomisation: {file: random.yaml}'))
        seen, _ = made.reset()
        at_m = made.batch.markers_m[0, 0]
        numpy.testing.assert_allclose(seen[:3], [-at_m[1], at_m[0] + 0.002, at_m[2]], atol=1e-12)


class Repeats(Tasks):
    def test_equal_for_any_number_of_threads(self):
        path = self.task(DRAWN)
        one, two, many = (played(soft_robot_lab.VectorEnvironment(path, 5, threads)) for threads in (1, 2, 5))
        self.assertEqual(one, two)
        self.assertEqual(one, many)

    def test_reduced_ones_too(self):
        robot = self.written('reduced.yaml', 'include: %s\nsolver: {method: reduced, tolerance_m: 1.0e-3, '
                                             'commands: {left: [0.9, 1.02], right: [0.95, 1.02]}}' % BAR)
        path = self.task(TASK.replace(BAR, robot), 'action: {limits: {left: [0.9, 1.02], right: [0.95, 1.02]}}')
        made = soft_robot_lab.VectorEnvironment(path, 3, 1)
        self.assertEqual(played(made), played(soft_robot_lab.VectorEnvironment(path, 3, 3)))
        full = soft_robot_lab.VectorEnvironment(path, 3, 1, {'method': 'newton'})
        worlds = [environment.reset(seed=2)[0] for environment in (made, full)]
        self.assertLess(abs(worlds[0] - worlds[1]).max(), 1e-3)
        self.assertNotEqual(worlds[0].tolist(), worlds[1].tolist())

    def test_a_world_is_an_environment(self):
        path = self.task(DRAWN)
        many, one = soft_robot_lab.VectorEnvironment(path, 3, 2), soft_robot_lab.Environment(path)
        seen, infos = many.reset(seed=7)
        actions = numpy.random.default_rng(1).uniform(-1, 1, (8, 3, 2))
        steps = [many.step(action) for action in actions]
        for world in range(3):
            first, info = one.reset(seed=7 + world)
            self.assertEqual(first.tolist(), seen[world].tolist())
            self.assertEqual(info['target_m'].tolist(), infos['target_m'][world].tolist())
            for action, (observations, rewards, _, ended, infos_now) in zip(actions, steps):
                last, reward, _, truncated, info = one.step(action[world])
                self.assertEqual((reward, truncated), (rewards[world], ended[world]))
                if truncated:
                    self.assertEqual(last.tolist(), infos_now['final_obs'][world].tolist())
                    self.assertEqual(info['distance_m'], infos_now['final_info']['distance_m'][world])
                    self.assertTrue(infos_now['_final_obs'][world])
                    last, info = one.reset()
                self.assertEqual(last.tolist(), observations[world].tolist())
                self.assertEqual(info['distance_m'], infos_now['distance_m'][world])

    def test_a_seed_repeats_whatever_was_before(self):
        made = soft_robot_lab.VectorEnvironment(self.task(DRAWN), 2, 1)
        self.assertEqual(played(made), played(made))
        self.assertNotEqual(played(made), played(made, seed=6))
        self.assertEqual(made.reset(seed=[4, 4])[0][0].tolist(), made.reset(seed=4)[0][0].tolist())
        fresh = [soft_robot_lab.Environment(self.task(DRAWN)).reset()[0].tolist() for _ in range(2)]
        self.assertEqual(fresh[0], fresh[1])


class Failures(Tasks):
    def test_a_solve_that_fails_ends_the_episode(self):
        robot = self.written('hasty.yaml', 'include: %s\nsolver: {max_iterations: 1}' % BAR)
        path = self.task(TASK.replace(BAR, robot), 'action: {kind: command, limits: {left: [0.55, 1.45], right: [0.55, 1.45]}}')
        made = soft_robot_lab.Environment(path)
        before, first = made.reset(seed=1)
        seen, reward, terminated, truncated, info = made.step([-1.0, 1.0])
        self.assertEqual((terminated, truncated, info['converged']), (False, True, False))
        self.assertEqual(seen[:9].tolist(), before[:9].tolist())
        self.assertEqual((info['distance_m'], reward), (first['distance_m'], -100 * first['distance_m']))
        self.refused(RuntimeError, 'reset', made.step, [0.0, 0.0])
        self.assertEqual(made.reset(seed=1)[0].tolist(), before.tolist())
        self.assertTrue(made.step([0.0, 0.0])[4]['converged'])
        many = soft_robot_lab.VectorEnvironment(path, 2, 1)
        many.reset(seed=1)
        seen, _, _, truncated, info = many.step([[0.0, 0.0], [-1.0, 1.0]])
        self.assertEqual((truncated.tolist(), info['converged'].tolist()), ([False, True], [True, False]))
        self.assertTrue(numpy.isfinite(seen).all())
        self.assertFalse(many.step(numpy.zeros((2, 2)))[3].any())

    def test_a_robot_that_finds_no_rest(self):
        restless = os.path.join(SOURCE, 'test', 'data', 'scenes', 'restless_bar.yaml')
        self.refused(RuntimeError, 'robot 0 .* finds no rest', soft_robot_lab.Environment, self.task(TASK.replace(BAR, restless)))

    def test_wrong_calls_change_nothing(self):
        made = soft_robot_lab.Environment(self.task(DRAWN))
        self.refused(RuntimeError, 'no episode runs', made.step, [0.0, 0.0])
        made.reset(seed=1)
        for wrong in ([0.0], [[0.0, 0.0]], [0.0, float('nan')], [0.0, float('inf')], 'much', None, ['a', 'b']):
            self.refused(ValueError, 'action', made.step, wrong)
        self.refused(ValueError, r'seed: -1 must be .* in \[0, inf\)', made.reset, seed=-1)
        self.refused(ValueError, 'seed: 1.5', made.reset, seed=1.5)
        self.refused(ValueError, r"'plant' must be a whole number in \[0, 2\]", made.reset, options={'plant': 3})
        self.refused(ValueError, "'plant' must", made.reset, options={'plant': 0.5})
        self.refused(ValueError, "'target_m'", made.reset, options={'target_m': [0, 0, float('nan')]})
        self.refused(ValueError, "'planet' is not one of plant, target_m", made.reset, options={'planet': 1})
        many = soft_robot_lab.VectorEnvironment(self.task(DRAWN), 2, 1)
        self.refused(ValueError, 'seed: 3 numbers, must be one, or 2', many.reset, seed=[1, 2, 3])
        self.refused(RuntimeError, 'no episodes run', many.step, numpy.zeros((2, 2)))
        many.reset()
        self.refused(ValueError, r'actions: of shape \(2,\), must be \(2, 2\)', many.step, [0.0, 0.0])
        self.refused(ValueError, 'worlds: 0 is out of range', soft_robot_lab.VectorEnvironment, self.task(), 0)
        many.close()
        self.refused(RuntimeError, 'closed', many.reset)

    def test_wrong_files(self):
        made = soft_robot_lab.Environment
        error = soft_robot_lab.SettingsError
        for old, new, text in (
                ('marker: tip', 'marker: tpi', "marker: 'tpi' is not one of tip, middle"),
                ('marker: tip', 'marker: tip\nmarkr: tip', "unknown key 'markr'"),
                ('task: reach', 'task: grasp', "task.yaml:3: task: 'grasp' is not there yet; must be one of reach, track"),
                ('task: reach', 'task: push', 'must be one of reach, track'),
                ('task: reach', 'task: dance', "'dance' is not one of reach, track"),
                ('task: reach', 'task: track', "'path' is missing"),
                ('control_rate_hz: 30', 'control_rate_hz: 0', r'control_rate_hz: 0 is out of range \(0, 10000\]'),
                ('control_rate_hz: 30', 'control_rate_hz: .nan', 'control_rate_hz'),
                ('control_rate_hz: 30', 'control_rate_hz: fast', 'control_rate_hz'),
                ('episode_s: 0.2', 'episode_s: -1', r'episode_s: -1 is out of range \(0, '),
                ('episode_s: 0.2', '', "'episode_s' is missing"),
                ('episode_s: 0.2', 'episode_s: 1\nsteps: 0', r'steps: 0 is out of range \[1, 1000\]'),
                ('episode_s: 0.2', 'episode_s: 1\nseed: 0', r'seed: 0 is out of range \[1, 1000000\]'),
                ('episode_s: 0.2', 'episode_s: 1\naction: {kind: push}', "'push' is not one of change, command"),
                ('episode_s: 0.2', 'episode_s: 1\naction: {largest_change: 1.5}', r'largest_change: 1.5 is out of range \(0, 1\]'),
                ('episode_s: 0.2', 'episode_s: 1\naction: {kind: command, largest_change: 0.1}', "unknown key 'largest_change'"),
                ('episode_s: 0.2', 'episode_s: 1\naction: {limits: {lefft: [0.8, 1]}}', "limits: 'lefft' is not one of left, right"),
                ('episode_s: 0.2', 'episode_s: 1\naction: {limits: {left: [1, 0.8]}}', r'limits.left: must be \[least, largest\]'),
                ('episode_s: 0.2', 'episode_s: 1\naction: {limits: {left: [0.1, 1]}}', r'limits.left: \[0.1, 1\] is out of range \[0.5, 1.5\]'),
                ('episode_s: 0.2', 'episode_s: 1\nobservation: {kind: sound}', "'sound' is not one of markers, markers_and_tensions"),
                ('episode_s: 0.2', 'episode_s: 1\nobservation: {noise_m: -1}', r'noise_m: -1 is out of range \[0, 1\]'),
                ('episode_s: 0.2', 'episode_s: 1\nreward: {distance_per_m: .inf}', 'distance_per_m'),
                ('episode_s: 0.2', 'episode_s: 1\nrandomisation: {file: nothing.yaml}', 'nothing.yaml.*cannot be read'),
                ('[[0.01, 0, -0.099], [-0.01, 0, -0.099]]', '[]', 'must have at least one point'),
                ('[[0.01, 0, -0.099], [-0.01, 0, -0.099]]', '[[0.01, 0]]', r'has 2 numbers, must be \[x, y, z\]'),
                ('points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]', 'min_m: [0, 0, 1], max_m: [0, 0, 0]', 'min_m must not be above max_m'),
                ('points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]', 'reachable: 0', r'reachable: 0 is out of range \[1, 10000\]'),
                ('points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]', '', 'must have one of points_m, min_m with max_m, and reachable')):
            with self.subTest(new):
                self.assertIn(old, TASK)
                self.refused(error, text, made, self.task(TASK.replace(old, new)))
        self.refused(error, 'task.yaml.*control_rate_hz: -3 is out of range', made, self.task(), {'control_rate_hz': -3})
        track = TASK.replace('task: reach', 'task: track').replace('targets: {points_m: [[0.01, 0, -0.099], [-0.01, 0, -0.099]]}', 'path: %s')
        for path, text in (('[]', 'must have at least one point'), ('[{time_s: 1, position_m: [0, 0, 0]}, {time_s: 1, position_m: [0, 0, 0]}]',
                                                                     'must be after the point before')):
            self.refused(error, text, made, self.task(track % path))

    def test_wrong_randomisations(self):
        for line, text in (('camera_to_base.q_m: {range: [0, 1]}', 'camera_to_base.q_m is not one of x_m'),
                           ('backlash_m.middle: {range: [0, 1]}', 'backlash_m.middle: no actuator'),
                           ('body.nothing: {range: [0, 1]}', 'body.nothing')):
            with self.subTest(line):
                self.written('random.yaml', 'samples: 2\nparameters: {%s}' % line)
                self.refused(soft_robot_lab.SettingsError, text, soft_robot_lab.Environment,
                             self.task(TASK, 'randomisation: {file: random.yaml}'))


class Spaces(unittest.TestCase):
    def test_box(self):
        box = spaces.Box([0.0, -numpy.inf, -numpy.inf, 2.0], [1.0, numpy.inf, -3.0, numpy.inf], seed=1)
        self.assertEqual((box.shape, box.dtype), ((4,), numpy.float64))
        drawn = [box.sample() for _ in range(50)]
        self.assertTrue(all(box.contains(one) and one in box for one in drawn))
        self.assertGreater(numpy.std(drawn, axis=0).min(), 0.1)
        box.seed(1)
        self.assertEqual(box.sample().tolist(), drawn[0].tolist())
        for wrong in ([0.5, 0, -4, 3], numpy.array([2.0, 0, -4, 3]), numpy.zeros(3), numpy.full(4, numpy.nan), None):
            self.assertFalse(box.contains(wrong))
        self.assertEqual(spaces.Box(-1, 1, (2,)), spaces.Box([-1, -1], [1, 1]))
        self.assertNotEqual(spaces.Box(-1, 1, (2,)), spaces.Box(-1, 2, (2,)))
        with self.assertRaisesRegex(ValueError, 'above'):
            spaces.Box(1, 0, (2,))
        with self.assertRaisesRegex(ValueError, 'seed'):
            spaces.Box(0, 1, (2,), seed=-1)


class WithGymnasium(Tasks):
    """Its package is found where it is: here one that has no more than its names."""

    def setUp(self):
        super().setUp()
        self.made = []

        class Box(spaces.Box):
            pass
        packages = {'gymnasium': {'Env': type('Env', (), {}), '__path__': []},
                    'gymnasium.spaces': {'Box': Box},
                    'gymnasium.vector': {'VectorEnv': type('VectorEnv', (), {}), 'AutoresetMode': types.SimpleNamespace(SAME_STEP='same')}}
        for name, members in packages.items():
            package = types.ModuleType(name)
            vars(package).update(members)
            sys.modules[name] = package
            if '.' in name:
                setattr(sys.modules['gymnasium'], name.split('.')[1], package)
        self.gymnasium = sys.modules['gymnasium']
        self.with_it = importlib.reload(environment)
        self.addCleanup(self.take_away)

    def take_away(self):
        for name in ('gymnasium', 'gymnasium.spaces', 'gymnasium.vector'):
            del sys.modules[name]
        importlib.reload(environment)

    def test_classes_and_spaces_are_its_own(self):
        path = self.task()
        one, many = self.with_it.Environment(path), self.with_it.VectorEnvironment(path, 2, 1)
        self.assertIsInstance(one, self.gymnasium.Env)
        self.assertIsInstance(many, self.gymnasium.vector.VectorEnv)
        for space in (one.observation_space, one.action_space, many.observation_space, many.single_action_space):
            self.assertIsInstance(space, self.gymnasium.spaces.Box)
        self.assertEqual(many.metadata['autoreset_mode'], 'same')
        self.assertEqual(one.reset(seed=3)[0].tolist(), many.reset(seed=3)[0][0].tolist())
        self.assertEqual(one._np_random_seed, 3)
        self.assertNotIsInstance(soft_robot_lab.Environment(path), self.gymnasium.Env)


if __name__ == '__main__':
    unittest.main()
