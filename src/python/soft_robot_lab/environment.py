# SPDX-License-Identifier: BSD-3-Clause
"""Simulated robots to learn on, after Gymnasium's interface, whose package is used where it is installed."""
import os

import numpy

from . import _core, spaces
from ._core import Batch, SettingsError

try:
    import gymnasium
    import gymnasium.vector
except ImportError:
    gymnasium = None

_AXES = ('x_m', 'y_m', 'z_m', 'rx_rad', 'ry_rad', 'rz_rad')


def _box(low, high, shape):
    make = gymnasium.spaces.Box if gymnasium else spaces.Box
    return make(low, high, shape=shape, dtype=numpy.float64)


def _length(vectors):
    """Of each (..., 3), by single operations: so it does not depend on how many there are."""
    return numpy.sqrt(vectors[..., 0] ** 2 + vectors[..., 1] ** 2 + vectors[..., 2] ** 2)


def _turn(vector_rad):
    """The matrix of a rotation vector (Rodrigues)."""
    angle = float(_length(vector_rad))
    if angle == 0.0:
        return numpy.eye(3)
    x, y, z = vector_rad / angle
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(angle) * cross + (1.0 - numpy.cos(angle)) * (cross @ cross)


def _finite(given, shape, what):
    try:
        numbers = numpy.array(given, dtype=numpy.float64)
    except (TypeError, ValueError):
        raise ValueError('%s: not an array of numbers' % what) from None
    if numbers.shape != shape or not numpy.isfinite(numbers).all():
        raise ValueError('%s: of shape %s, must be %s, all finite' % (what, numbers.shape, shape))
    return numbers


class _Plants:
    """The robots of a task: changes of its file, play of drives, and where cameras believe the robot."""

    def __init__(self, task):
        random = task['randomisation']
        drawn = [{}]
        if random is not None:
            drawn = _core._draw_robots(random['file'], task['robot'], random['samples'], random['seed'])
        self.file = random['file'] if random is not None else None
        self.overrides = [{name: value for name, value in one.items() if not name.startswith(('backlash_m.', 'camera_to_base.'))}
                          for one in drawn]
        self.backlash_m = [{name.split('.', 1)[1]: max(0.0, value) for name, value in one.items() if name.startswith('backlash_m.')}
                           for one in drawn]
        six = numpy.array([self._camera(one) for one in drawn])
        self.shift_m = six[:, :3]
        self.turn = numpy.array([_turn(vector_rad) for vector_rad in six[:, 3:]])

    def __len__(self):
        return len(self.overrides)

    def _camera(self, one):
        axes = {name.split('.', 1)[1]: value for name, value in one.items() if name.startswith('camera_to_base.')}
        for axis in axes:
            if axis not in _AXES:
                raise SettingsError('%s: parameters: camera_to_base.%s is not one of %s' % (self.file, axis, ', '.join(_AXES)))
        return [axes.get(axis, 0.0) for axis in _AXES]

    def play(self, plant, readings, limits):
        """(actuators,) of one plant, in units of the commands."""
        for name in self.backlash_m[plant]:
            if name not in readings or 'rest_length_m' not in readings[name] or limits[name][3] not in ('1', 'm'):
                raise SettingsError('%s: parameters: backlash_m.%s: no actuator of the robot that is commanded by length' % (self.file, name))
        return [self.backlash_m[plant].get(name, 0.0) / (reading['rest_length_m'] if limits[name][3] == '1' else 1.0)
                if name in self.backlash_m[plant] else 0.0 for name, reading in readings.items()]


class _Worlds:
    """What environments share. All numbers of a world come from its own generator and plant by operations on single numbers, so they
    are the same to the last bit for any number of worlds and threads."""

    def __init__(self, path, worlds, threads, overrides):
        self.path = os.fspath(path)
        self.task = _core._read_learning_task(path, overrides)
        self.period_s = 1.0 / self.task['control_rate_hz']
        self.steps_of_episode = max(1, round(self.task['episode_s'] / self.period_s))
        self.plants = _Plants(self.task)
        self.batch = self._load(worlds, threads, self.plants.overrides)
        self.marker = self._marker()
        self.ranges = self._ranges()
        self.cables = []
        self._settle_plants()
        if 'targets' in self.task and 'reachable' in self.task['targets']:
            self.task['targets'] = {'points_m': self._reachable(self.task['targets']['reachable'])}
        actuators = len(self.batch.actuator_names)
        self.random = [None] * worlds
        self.plant = numpy.zeros(worlds, dtype=int)
        self.target_m = numpy.zeros((worlds, 3))
        self.count = numpy.zeros(worlds, dtype=int)
        self.running = numpy.zeros(worlds, dtype=bool)
        self.commands, self.ends = numpy.zeros((worlds, actuators)), numpy.zeros((worlds, actuators))
        self.markers_m = numpy.zeros((worlds, len(self.batch.marker_names), 3))

    # ---- made once

    def _load(self, worlds, threads, overrides):
        step = {'solver.time_step_s': self.period_s / self.task['steps']}
        return Batch(self.task['robot'], worlds, threads, [dict(one, **step) for one in overrides], self.task['method'])

    def _refuse(self, key, message):
        raise SettingsError('%s: %s: %s' % (self.path, key, message))

    def _marker(self):
        names = self.batch.marker_names
        if self.task['marker'] not in names:
            self._refuse('marker', "'%s' is not one of %s" % (self.task['marker'], ', '.join(names)))
        return names.index(self.task['marker'])

    def _ranges(self):
        """(actuators, 2)"""
        limits, asked = self.batch.limits, self.task['limits']
        for name in asked:
            if name not in limits:
                self._refuse('action.limits', "'%s' is not one of %s" % (name, ', '.join(limits)))
        ranges = []
        for name, (_, least, largest, _) in limits.items():
            low, high = asked.get(name, (least, largest))
            if not (least <= low and high <= largest):
                self._refuse('action.limits.' + name, '[%g, %g] is out of range [%g, %g]' % (low, high, least, largest))
            if not numpy.isfinite([low, high]).all():
                self._refuse('action.limits.' + name, 'is missing: its range [%g, %g] has no end' % (low, high))
            ranges.append((low, high))
        return numpy.array(ranges)

    def _start(self, commands):
        return numpy.clip(commands, self.ranges[:, 0], self.ranges[:, 1])

    def _settle_plants(self):
        """Finds where each plant hangs."""
        self.rest, self.rest_commands, self.plays = [], [], []
        worlds = self.batch.worlds
        for first in range(0, len(self.plants), worlds):
            some = list(range(first, min(first + worlds, len(self.plants))))
            here = list(range(len(some)))
            self.batch.reset(here, some)
            self.batch.commands = self._start(self.batch.commands)
            for report, plant in zip(self.batch.settle(here).reports, some):
                if not report.converged:
                    raise RuntimeError('%s: robot %d of the randomisation finds no rest: %s' % (self.path, plant, report.message))
            for world, plant in zip(here, some):
                self.rest.append(self.batch.get_state(world))
                readings = self.batch.readings(world)
                self.plays.append(self.plants.play(plant, readings, self.batch.limits))
                if not self.cables:
                    self.cables = [name for name, reading in readings.items() if 'tension_n' in reading]
            self.rest_commands.extend(self.batch.commands[here])
        self.rest_commands, self.plays = numpy.array(self.rest_commands), numpy.array(self.plays)
        if self.task['observation'] == 'markers_and_tensions' and not self.cables:
            self._refuse('observation.kind', 'markers_and_tensions: the robot has no cables; must be markers')

    def _reachable(self, count):
        """(count, 3): where the marker rests under drawn commands, of the robot as its file has it."""
        batch = self.batch if self.plants.file is None else self._load(min(count, 64), self.batch.threads, [{}])
        random = spaces.generator(self.task['seed'])
        found_m = []
        for _ in range(10):
            drawn = random.uniform(self.ranges[:, 0], self.ranges[:, 1], (count, len(self.ranges)))
            for first in range(0, count, batch.worlds):
                some = drawn[first:first + batch.worlds]
                here = list(range(len(some)))
                batch.reset(here)
                commands = batch.commands
                commands[here] = some
                batch.commands = commands
                converged = batch.settle(here).converged
                found_m.extend(batch.markers_m[here][converged, self.marker])
            if len(found_m) >= count:
                return numpy.array(found_m[:count])
        self._refuse('targets.reachable', 'the robot rests under %d of %d drawn commands' % (len(found_m), 10 * count))

    # ---- episodes

    def begin(self, worlds, options):
        """Starts episodes of these worlds."""
        points_m = self.task['targets'].get('points_m') if 'targets' in self.task else None
        for world in worlds:
            random = self.random[world]
            self.plant[world] = random.integers(len(self.plants))
            if points_m is not None:
                self.target_m[world] = points_m[random.integers(len(points_m))]
            elif 'targets' in self.task:
                self.target_m[world] = random.uniform(self.task['targets']['min_m'], self.task['targets']['max_m'])
        self._choose(worlds, options)
        self.batch.reset(worlds, self.plant[worlds].tolist())
        for world in worlds:
            self.batch.set_state(world, self.rest[self.plant[world]])
        self.commands[worlds] = self.ends[worlds] = self.rest_commands[self.plant[worlds]]
        self.count[worlds] = 0
        self.running[worlds] = True
        self.markers_m[worlds] = self._seen_m()[worlds]

    def _choose(self, worlds, options):
        """What a caller asks for in place of what is drawn."""
        options = dict(options or {})
        if 'plant' in options:
            plants = numpy.atleast_1d(numpy.array(options.pop('plant')))
            if plants.dtype.kind not in 'iu' or plants.shape != (len(worlds),) or not ((plants >= 0) & (plants < len(self.plants))).all():
                raise ValueError("options: 'plant' must be a whole number in [0, %d] for each world" % (len(self.plants) - 1))
            self.plant[worlds] = plants
        if 'target_m' in options and 'targets' in self.task:
            shape = numpy.shape(options['target_m'])
            targets_m = _finite(options.pop('target_m'), (3,) if len(worlds) == 1 and len(shape) == 1 else (len(worlds), 3), "options: 'target_m'")
            self.target_m[worlds] = targets_m
        if options:
            raise ValueError("options: '%s' is not one of %s" % (
                next(iter(options)), 'plant, target_m' if 'targets' in self.task else 'plant'))

    def _seen_m(self):
        """(worlds, markers, 3) as cameras believe, without noise."""
        at_m, turn = self.batch.markers_m, self.plants.turn[self.plant][:, None]
        return (turn[..., 0] * at_m[..., 0, None] + turn[..., 1] * at_m[..., 1, None] + turn[..., 2] * at_m[..., 2, None]
                + self.plants.shift_m[self.plant][:, None])

    def goal_m(self, later=0):
        """(worlds, 3): where the marker is to be, so many control steps later."""
        if 'path' not in self.task:
            return self.target_m
        path = self.task['path']
        time_s = (self.count + later) * self.period_s
        return numpy.stack([numpy.interp(time_s, path['time_s'], path['position_m'][:, axis]) for axis in range(3)], axis=-1)

    def distance_m(self):
        return _length(self.markers_m[:, self.marker] - self.goal_m())

    def step(self, actions):
        """Returns rewards, whether episodes are cut off, and whether all solves converged."""
        actions = numpy.clip(actions, -1.0, 1.0)
        low, high = self.ranges[:, 0], self.ranges[:, 1]
        if self.task['action'] == 'change':
            commands = numpy.clip(self.commands + actions * (self.task['largest_change'] * (high - low)), low, high)
        else:
            commands = low + 0.5 * (actions + 1.0) * (high - low)
        self.running[:] = False  # until it has moved: Ctrl-C may end the step
        self.commands = commands
        least = numpy.array([limits[1] for limits in self.batch.limits.values()])
        self.ends = numpy.clip(self.ends, numpy.maximum(least, commands - self.plays[self.plant]), commands)
        self.batch.commands = self.ends
        converged = self.batch.step(self.task['steps']).converged
        seen_m = self._seen_m()
        converged &= numpy.isfinite(seen_m).all(axis=(1, 2))
        self.markers_m = numpy.where(converged[:, None, None], seen_m, self.markers_m)
        self.count += 1
        ended = ~converged | (self.count >= self.steps_of_episode)
        self.running = ~ended
        return self._rewards(actions), ended, converged

    def _rewards(self, actions):
        squares = numpy.zeros(len(actions))
        for one in actions.T:
            squares = squares + one ** 2
        distance_m = self.distance_m()
        return self.task['within'] * (distance_m <= self.task['within_m']) - self.task['distance_per_m'] * distance_m \
            - self.task['change'] * squares

    # ---- what is seen

    def observe(self, worlds):
        """(worlds, numbers) of these."""
        markers_m = self.markers_m[worlds].reshape(len(worlds), -1)
        if self.task['noise_m'] > 0.0:
            markers_m = markers_m + self.task['noise_m'] * numpy.array(
                [self.random[world].standard_normal(markers_m.shape[1]) for world in worlds]).reshape(markers_m.shape)
        parts = [markers_m, self.goal_m()[worlds]]
        if 'path' in self.task:
            parts.append(self.goal_m(later=1)[worlds])
        low, high = self.ranges[:, 0], self.ranges[:, 1]
        parts.append((2.0 * self.commands[worlds] - (low + high)) / (high - low))
        if self.task['observation'] == 'markers_and_tensions':
            readings = [self.batch.readings(world) for world in worlds]
            tensions_n = numpy.array([[of[name]['tension_n'] for name in self.cables] for of in readings])
            parts.append(tensions_n.reshape(len(worlds), -1))
        return numpy.concatenate(parts, axis=1)

    def infos(self, worlds, converged):
        """dict of arrays, one number or vector for each of these."""
        distance_m = self.distance_m()[worlds]
        return {'distance_m': distance_m, 'is_success': distance_m <= self.task['within_m'], 'target_m': self.goal_m()[worlds],
                'commands': self.commands[worlds], 'plant': self.plant[worlds], 'converged': converged[worlds]}

    def sizes(self):
        """Of an observation and an action."""
        markers, actuators = 3 * len(self.batch.marker_names), len(self.batch.actuator_names)
        tensions = len(self.cables) if self.task['observation'] == 'markers_and_tensions' else 0
        return markers + (6 if 'path' in self.task else 3) + actuators + tensions, actuators


class _Common:
    """What both environments have."""

    _worlds = None

    @property
    def observation_space(self):
        """A Box: gymnasium.spaces.Box where that is installed, else soft_robot_lab.spaces.Box."""
        return self._observation_space

    @property
    def action_space(self):
        """A Box, [-1, 1] for each actuator."""
        return self._action_space

    def _open(self):
        if self._worlds is None:
            raise RuntimeError('the environment is closed')
        return self._worlds

    @property
    def settings(self):
        """dict: the task's file with its defaults; ranges as `limits`."""
        worlds = self._open()
        names = worlds.batch.actuator_names
        return dict(worlds.task, limits={name: tuple(map(float, ends)) for name, ends in zip(names, worlds.ranges)})

    @property
    def robots(self):
        """int: how many robots are drawn; 1 without a randomisation."""
        return len(self._open().plants)

    @property
    def batch(self):
        """The Batch that it moves, to look at."""
        return self._open().batch

    def close(self):
        """Gives back its memory; what is called after it raises RuntimeError."""
        self._worlds = None


class Environment(_Common, gymnasium.Env if gymnasium else object):
    """One world of a learning task, after gymnasium.Env: observations, actions and rewards of numbers, float64."""

    metadata = {'render_modes': []}

    def __init__(self, path, overrides=None):
        """`path` is a file as config/README.md, "Learning task", says; `overrides` as of Simulation, of that file's keys.
        SettingsError: file, key, value and range. RuntimeError: a robot that finds no rest."""
        self._worlds = _Worlds(path, 1, 1, overrides)
        observation, action = self._worlds.sizes()
        self._observation_space = _box(-numpy.inf, numpy.inf, (observation,))
        self._action_space = _box(-1.0, 1.0, (action,))

    @property
    def np_random(self):
        """numpy.random.Generator of the episodes; may be set."""
        worlds = self._open()
        if worlds.random[0] is None:
            self._begin_random(worlds.task['seed'])
        return worlds.random[0]

    @np_random.setter
    def np_random(self, generator):
        self._open().random[0] = self._np_random = generator
        self._np_random_seed = -1  # as Gymnasium has it: unknown

    def _begin_random(self, seed):
        self._worlds.random[0] = self._np_random = spaces.generator(seed)
        self._np_random_seed = seed

    def reset(self, *, seed=None, options=None):
        """A new episode, from where the robot hangs. `seed` begins the random numbers anew; the first ones are those of the file's `seed`.
        `options` may have 'plant', the number of a robot of the randomisation, and 'target_m', (3,). Returns an observation and an info."""
        worlds = self._open()
        if seed is not None or worlds.random[0] is None:
            self._begin_random(worlds.task['seed'] if seed is None else seed)
        worlds.begin([0], options)
        return worlds.observe([0])[0], self._info(numpy.array([True]))

    def step(self, action):
        """One control step. Returns observation, reward, terminated (False: the task has no end of its own), truncated and info.
        ValueError for a wrong shape or what is not finite; numbers beyond [-1, 1] are cut off there. RuntimeError after the episode's end.
        Where a solve does not converge the episode is truncated, info['converged'] is False, and what is observed is as before."""
        worlds = self._open()
        actions = _finite(action, self.action_space.shape, 'action')[None]
        if not worlds.running[0]:
            raise RuntimeError('no episode runs: reset() begins one')
        rewards, ended, converged = worlds.step(actions)
        return worlds.observe([0])[0], float(rewards[0]), False, bool(ended[0]), self._info(converged)

    def _info(self, converged):
        info = {name: of[0] for name, of in self._worlds.infos([0], converged).items()}
        for name in ('is_success', 'converged'):
            info[name] = bool(info[name])
        return dict(info, plant=int(info['plant']), distance_m=float(info['distance_m']))


class VectorEnvironment(_Common, gymnasium.vector.VectorEnv if gymnasium else object):
    """Many worlds of a learning task, after gymnasium.vector.VectorEnv, moved by several threads. World i is an Environment whose seed is
    larger by i, to the last bit, for any number of worlds and threads."""

    metadata = {'render_modes': [], 'autoreset_mode': 'SameStep'}

    def __init__(self, path, worlds, threads=None, overrides=None):
        """As Environment; `threads` is the number of cores where it is not given."""
        self._worlds = _Worlds(path, worlds, threads, overrides)
        if gymnasium and hasattr(gymnasium.vector, 'AutoresetMode'):
            self.metadata = dict(self.metadata, autoreset_mode=gymnasium.vector.AutoresetMode.SAME_STEP)
        self._num_envs = worlds
        observation, action = self._worlds.sizes()
        self._single_observation_space = _box(-numpy.inf, numpy.inf, (observation,))
        self._single_action_space = _box(-1.0, 1.0, (action,))
        self._observation_space = _box(-numpy.inf, numpy.inf, (worlds, observation))
        self._action_space = _box(-1.0, 1.0, (worlds, action))

    @property
    def num_envs(self):
        """int: the worlds."""
        return self._num_envs

    @property
    def single_observation_space(self):
        """Of one world."""
        return self._single_observation_space

    @property
    def single_action_space(self):
        """Of one world."""
        return self._single_action_space

    def reset(self, *, seed=None, options=None):
        """New episodes of all worlds. `seed` is a number, to which a world adds its own, or a list of a number for each. `options` as of
        Environment, with a row for each world. Returns observations (worlds, numbers) and an info of arrays."""
        worlds = self._open()
        if seed is None and worlds.random[0] is None:
            seed = worlds.task['seed']
        if seed is not None:
            seeds = [seed + i for i in range(self.num_envs)] if isinstance(seed, (int, numpy.integer)) else list(seed)
            if len(seeds) != self.num_envs:
                raise ValueError('seed: %d numbers, must be one, or %d' % (len(seeds), self.num_envs))
            worlds.random = [spaces.generator(one) for one in seeds]
        everyone = list(range(self.num_envs))
        worlds.begin(everyone, options)
        return worlds.observe(everyone), worlds.infos(everyone, numpy.ones(self.num_envs, dtype=bool))

    def step(self, actions):
        """One control step of each world. Returns observations, rewards, terminated, truncated, each a row for each world, and an info. A
        world whose episode ends begins the next one in the same step: its row is the new episode's first; info['final_obs'] and
        info['final_info'] have a row for each world of what the step came to, and info['_final_obs'] says which of them are ends."""
        worlds = self._open()
        actions = _finite(actions, self.action_space.shape, 'actions')
        if not worlds.running.all():
            raise RuntimeError('no episodes run: reset() begins them')
        rewards, ended, converged = worlds.step(actions)
        everyone = list(range(self.num_envs))
        observations, info = worlds.observe(everyone), worlds.infos(everyone, converged)
        some = numpy.flatnonzero(ended).tolist()
        if some:
            info = dict(info, final_obs=observations.copy(), final_info=info, _final_obs=ended, _final_info=ended)
            worlds.begin(some, None)
            observations[some] = worlds.observe(some)
            now = worlds.infos(everyone, converged)
            for name in ('distance_m', 'is_success', 'target_m', 'commands', 'plant'):
                info[name] = now[name]
        return observations, rewards, numpy.zeros(self.num_envs, dtype=bool), ended, info
