# SPDX-License-Identifier: BSD-3-Clause
"""Gymnasium's boxes of numbers, for where Gymnasium is not installed: the same fields, and no more than environments need."""
import numpy


def generator(seed):
    """As Gymnasium makes it. ValueError for what is no whole number from 0 on."""
    if isinstance(seed, bool) or not isinstance(seed, (int, numpy.integer)) or seed < 0:
        raise ValueError('seed: %r must be a whole number in [0, inf)' % (seed,))
    return numpy.random.Generator(numpy.random.PCG64(numpy.random.SeedSequence(int(seed))))


class Box:
    """All arrays of `shape` and `dtype` between `low` and `high`, which may be infinite."""

    def __init__(self, low, high, shape=None, dtype=numpy.float64, seed=None):
        """`low` and `high` are numbers or arrays. ValueError where `low` is above `high`, or one is not a number."""
        self.dtype = numpy.dtype(dtype)
        self.shape = numpy.broadcast(low, high).shape if shape is None else tuple(shape)
        self.low, self.high = (numpy.array(numpy.broadcast_to(end, self.shape), dtype=self.dtype) for end in (low, high))
        if not (self.low <= self.high).all():
            raise ValueError('low must not be above high')
        self._random = None
        if seed is not None:
            self.seed(seed)

    def seed(self, seed=None):
        """Draws from here on are those of this seed; of chance for None."""
        self._random = numpy.random.default_rng() if seed is None else generator(seed)
        return seed

    def sample(self):
        """Evenly between finite ends; exponentially from the one finite end; normally where there is none."""
        if self._random is None:
            self.seed()
        low_finite, high_finite = numpy.isfinite(self.low), numpy.isfinite(self.high)
        low, high = numpy.where(low_finite, self.low, 0.0), numpy.where(high_finite, self.high, 0.0)
        away = self._random.exponential(size=self.shape)
        drawn = numpy.where(low_finite, low + away, numpy.where(high_finite, high - away, self._random.normal(size=self.shape)))
        both = low_finite & high_finite
        return numpy.where(both, self._random.uniform(numpy.where(both, low, 0.0), numpy.where(both, high, 1.0)), drawn).astype(self.dtype)

    def contains(self, x):
        """Whether it is an array of these numbers."""
        return bool(isinstance(x, numpy.ndarray) and numpy.can_cast(x.dtype, self.dtype) and x.shape == self.shape
                    and (x >= self.low).all() and (x <= self.high).all())

    def __contains__(self, x):
        return self.contains(x)

    def __eq__(self, other):
        return isinstance(other, Box) and self.shape == other.shape and self.dtype == other.dtype and \
            bool((self.low == other.low).all() and (self.high == other.high).all())

    def __repr__(self):
        return 'Box(%s, %s, %s, %s)' % (self.low.min(initial=numpy.inf), self.high.max(initial=-numpy.inf), self.shape, self.dtype)
