# SPDX-License-Identifier: BSD-3-Clause
"""A small network that brings a marker to a target by what is seen of the robot, step by step, as plain arrays."""
import os

import numpy

_FORMAT = 1
_FARTHEST = 5.0  # of an input from its mean, in standard deviations; beyond it counts as this
_WORDS = ('actuators', 'markers')
_NUMBERS = {'format': (), 'inputs_mean': ('inputs',), 'inputs_deviation': ('inputs',), 'limits': ('actuators', 2), 'marker': (),
            'largest_change': (), 'control_rate_hz': (), 'unit_m': ()}


class LearnedPolicy:
    """From markers, target and commands the network's layers (tanh between them) find a matrix of gains; gains times the way from marker to
    target are the change of the commands. So at the target commands stay, whatever the robot: what it has not learned is made up for by
    seeing. Changes are at most `largest_change` of a command's range in a step of 1 / control_rate_hz."""

    def __init__(self, arrays):
        """`arrays` is a dict as `arrays` gives it. ValueError names what is wrong."""
        self.arrays = dict(arrays)
        self._check()
        self.actuators, self.markers = ([str(name) for name in self.arrays[key]] for key in _WORDS)
        self.marker = int(self.arrays['marker'])
        self.limits = self.arrays['limits']
        self.largest_change, self.control_rate_hz, self.unit_m = (
            float(self.arrays[key]) for key in ('largest_change', 'control_rate_hz', 'unit_m'))
        self.layers = [(self.arrays['weights_%d' % i], self.arrays['biases_%d' % i]) for i in range(self._count())]

    def _count(self):
        return sum(name.startswith('weights_') for name in self.arrays)

    def _check(self):
        names = set(_WORDS) | set(_NUMBERS) | {'%s_%d' % (kind, i) for i in range(self._count()) for kind in ('weights', 'biases')}
        for name in sorted(names ^ set(self.arrays)):
            raise ValueError('%s: %s' % (name, 'is missing' if name in names else 'is not known'))
        if self._count() == 0:
            raise ValueError('weights_0: is missing')
        for key in _WORDS:
            if self.arrays[key].ndim != 1 or self.arrays[key].dtype.kind != 'U' or not len(self.arrays[key]):
                raise ValueError('%s: must be a list of names' % key)
        actuators, markers = (len(self.arrays[key]) for key in _WORDS)
        sizes = {'actuators': actuators, 'inputs': 3 * markers + 3 + actuators}
        shapes = {key: tuple(sizes.get(size, size) for size in shape) for key, shape in _NUMBERS.items()}
        width = sizes['inputs']
        for i in range(self._count()):
            last = i == self._count() - 1
            following = 3 * actuators if last else self.arrays['weights_%d' % i].shape[-1] if self.arrays['weights_%d' % i].ndim else 0
            shapes['weights_%d' % i], shapes['biases_%d' % i] = (width, following), (following,)
            width = following
        for name, shape in shapes.items():
            array = self.arrays[name]
            if array.dtype.kind not in 'iuf' or array.shape != shape or not numpy.isfinite(array).all():
                raise ValueError('%s: of shape %s, must be %s, all finite numbers' % (name, array.shape, shape))
        self._check_ranges(markers)

    def _check_ranges(self, markers):
        for name, good, allowed in (
                ('format', lambda value: value == _FORMAT, '%d' % _FORMAT),
                ('marker', lambda value: value == round(float(value)) and 0 <= value < markers, '[0, %d]' % (markers - 1)),
                ('inputs_deviation', lambda value: (value > 0).all(), '(0, inf)'),
                ('limits', lambda value: (value[:, 0] < value[:, 1]).all(), '[least, largest]'),
                ('largest_change', lambda value: 0 < value <= 1, '(0, 1]'),
                ('control_rate_hz', lambda value: 0 < value <= 10000, '(0, 10000]'),
                ('unit_m', lambda value: value > 0, '(0, inf)')):
            if not good(self.arrays[name]):
                raise ValueError('%s: %s is out of range %s' % (name, self.arrays[name].tolist(), allowed))

    @staticmethod
    def load(path):
        """From an .npz file. ValueError: file and what is wrong; OSError where it cannot be read."""
        try:
            with numpy.load(path, allow_pickle=False) as file:
                return LearnedPolicy({name: file[name] for name in file.files})
        except OSError:
            raise
        except Exception as error:
            raise ValueError('%s: %s' % (os.fspath(path), error)) from error

    def save(self, path):
        """As an .npz file of plain arrays, whole or not at all."""
        partial = '%s.%d.npz' % (os.fspath(path), os.getpid())
        numpy.savez(partial, **self.arrays)
        os.replace(partial, path)

    def actions(self, observations):
        """(n, actuators) in [-1, 1], of (n, inputs): markers as seen, target, and commands from -1 to 1 over their ranges, as an Environment
        of `observation: markers` gives them."""
        return actions(self.layers, numpy.asarray(observations, dtype=float), self)

    def commands(self, markers_m, target_m, commands):
        """(actuators,) the next commands, of (markers, 3) as seen, (3,), and (actuators,) the last commands. ValueError for a wrong shape and
        for what is not finite."""
        low, high = self.limits[:, 0], self.limits[:, 1]
        parts = []
        for name, given, shape in (('markers_m', markers_m, (len(self.markers), 3)), ('target_m', target_m, (3,)),
                                   ('commands', commands, (len(self.actuators),))):
            part = numpy.array(given, dtype=float)
            if part.shape != shape or not numpy.isfinite(part).all():
                raise ValueError('%s: of shape %s, must be %s, all finite' % (name, part.shape, shape))
            parts.append(part.ravel())
        now = numpy.clip(parts[2], low, high)
        parts[2] = (2.0 * now - (low + high)) / (high - low)
        most = self.largest_change * (high - low)
        following = numpy.clip(now + self.actions(numpy.concatenate(parts)[None])[0] * most, low, high)
        last = numpy.array(commands, dtype=float)
        return numpy.clip(following, last - most, last + most)  # from beyond the limits it comes back as slowly


class LearnedLoop:
    """A LearnedPolicy on markers that come when they come: commands for each frame that shows all markers, at most control_rate_hz. It ends
    with a reason, and then gives no more commands, so that drives hold."""

    def __init__(self, policy, target_m, commands, within_m=1.5e-3, hold_s=1.0, lost_after_s=1.0, error_growth_m=0.02, longest_s=60.0):
        """`commands`: (actuators,) as the robot has them. It has reached the target when the marker was within `within_m` for `hold_s`; tracking
        is lost after `lost_after_s` without all markers; the error grows where it is `error_growth_m` above its least so far."""
        for name, value in (('within_m', within_m), ('hold_s', hold_s), ('lost_after_s', lost_after_s), ('error_growth_m', error_growth_m),
                            ('longest_s', longest_s)):
            if not 0 < value < numpy.inf:
                raise ValueError('%s: %r is out of range (0, inf)' % (name, value))
        self.policy, self.target_m = policy, numpy.array(target_m, dtype=float)
        if self.target_m.shape != (3,) or not numpy.isfinite(self.target_m).all():
            raise ValueError('target_m: of shape %s, must be (3,), all finite' % (self.target_m.shape,))
        self.sent = numpy.array(commands, dtype=float)
        self.within_m, self.hold_s, self.lost_after_s, self.error_growth_m, self.longest_s = within_m, hold_s, lost_after_s, error_growth_m, longest_s
        self.end, self.distance_m = '', None
        self._begin_s = self._seen_s = self._sent_s = self._near_s = None
        self._least_m = numpy.inf

    def wait(self, time_s):
        """Call it where no frame came."""
        self._begin_s = time_s if self._begin_s is None else self._begin_s
        if not self.end and time_s - (self._begin_s if self._seen_s is None else self._seen_s) > self.lost_after_s:
            self.end = 'tracking is lost'

    def see(self, time_s, markers):
        """`markers` is {name: (3,)}, of the time `time_s`. Returns (actuators,) commands to be sent, or None for none."""
        self.wait(time_s)
        if self.end or not all(name in markers and numpy.isfinite(markers[name]).all() for name in self.policy.markers):
            return None
        if self._sent_s is not None and time_s - self._sent_s < (1.0 - 1e-3) / self.policy.control_rate_hz:
            return None
        self._seen_s = self._sent_s = time_s
        markers_m = numpy.array([markers[name] for name in self.policy.markers])
        self._judge(time_s, float(numpy.linalg.norm(markers_m[self.policy.marker] - self.target_m)))
        if self.end:
            return None
        self.sent = self.policy.commands(markers_m, self.target_m, self.sent)
        return self.sent

    def _judge(self, time_s, distance_m):
        self.distance_m, self._least_m = distance_m, min(self._least_m, distance_m)
        self._near_s = (time_s if self._near_s is None else self._near_s) if distance_m <= self.within_m else None
        if self._near_s is not None and time_s - self._near_s >= self.hold_s:
            self.end = 'reached'
        elif distance_m > self._least_m + self.error_growth_m:
            self.end = 'the error grows'
        elif time_s - self._begin_s > self.longest_s:
            self.end = 'time is up'


def inputs(observations, policy):
    """What the layers take."""
    normal = (observations - policy.arrays['inputs_mean']) / policy.arrays['inputs_deviation']
    return numpy.clip(normal, -_FARTHEST, _FARTHEST)


def ways(observations, policy):
    """(n, 3) from marker to target, in units of unit_m."""
    markers, at = len(policy.markers), 3 * policy.marker
    return (observations[..., 3 * markers:3 * markers + 3] - observations[..., at:at + 3]) / policy.unit_m


def actions(layers, observations, policy):
    """Of any layers, also of several networks at a time: (networks, ...) weights and biases, (networks, n, inputs) observations."""
    value = inputs(observations, policy)
    for i, (weights, biases) in enumerate(layers):
        value = value @ weights + biases[..., None, :]
        if i < len(layers) - 1:
            value = numpy.tanh(value)
    gains = value.reshape(value.shape[:-1] + (-1, 3))
    return numpy.clip((gains * ways(observations, policy)[..., None, :]).sum(axis=-1), -1.0, 1.0)
