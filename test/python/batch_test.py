# SPDX-License-Identifier: BSD-3-Clause
"""Batches: the numbers of one simulation, to the last bit for any number of threads."""
import pickle
import unittest

import numpy

import soft_robot_lab
from scenes import BAR

COMMANDS = [[0.9, 1.0], [1.0, 0.95], [0.85, 1.0], [0.95, 0.9], [1.0, 1.0]]


def moved(threads, method=None):
    batch = soft_robot_lab.Batch(BAR, len(COMMANDS), threads=threads, method=method)
    batch.commands = COMMANDS
    batch.step()
    batch.step(3)
    return batch


class Batches(unittest.TestCase):
    def test_any_number_of_threads_gives_the_same(self):
        for method in (None, 'xpbd'):
            one, two, many = (moved(threads, method) for threads in (1, 2, 8))
            for other in (two, many):
                self.assertEqual(one.markers_m.tolist(), other.markers_m.tolist())
                for world in range(one.worlds):
                    self.assertEqual(one.get_state(world), other.get_state(world))

    def test_a_world_is_a_simulation(self):
        batch = moved(2)
        simulation = soft_robot_lab.Simulation(BAR)
        for world, commands in enumerate(COMMANDS):
            simulation.reset()
            simulation.commands = commands
            for _ in range(4):
                simulation.step()
            self.assertEqual(batch.get_state(world), simulation.state)
            self.assertEqual(batch.markers_m[world].tolist(), simulation.markers_m.tolist())
            self.assertEqual(batch.time_s[world], simulation.time_s)
            self.assertEqual(batch.reached[world].tolist(), simulation.reached.tolist())

    def test_rest_states_and_derivatives_are_those_of_a_simulation(self):
        batch = soft_robot_lab.Batch(BAR, len(COMMANDS), threads=2)
        batch.commands = numpy.array(COMMANDS)
        report = batch.settle()
        self.assertTrue(report.converged.all())
        derivatives = batch.sensitivities()
        simulation = soft_robot_lab.Simulation(BAR)
        for world, commands in enumerate(COMMANDS):
            simulation.reset()
            simulation.commands = commands
            alone = simulation.settle()
            self.assertEqual(report.iterations[world], alone.iterations)
            self.assertEqual(report.residual[world], alone.residual)
            self.assertEqual(report.reports[world].converged, True)
            self.assertEqual(derivatives[world].tolist(), simulation.sensitivities().tolist())

    def test_worlds_are_reset_by_number_and_by_mask(self):
        batch = moved(2)
        batch.reset([1])
        self.assertEqual((batch.time_s == 0).tolist(), [False, True, False, False, False])
        batch.reset(numpy.array([True, False, False, False, True]))
        self.assertEqual((batch.time_s == 0).tolist(), [True, True, False, False, True])
        batch.reset()
        self.assertEqual(batch.get_state(2), soft_robot_lab.Simulation(BAR).state)

    def test_states_go_from_world_to_world(self):
        batch = moved(1)
        batch.set_state(0, pickle.loads(pickle.dumps(batch.get_state(3))))
        self.assertEqual(batch.get_state(0), batch.get_state(3))

    def test_misuse(self):
        batch = soft_robot_lab.Batch(BAR, 2, threads=2)
        before = [batch.get_state(0), batch.get_state(1)]

        def refused(kind, text, call, *arguments):
            with self.assertRaisesRegex(kind, text):
                call(*arguments)
            self.assertEqual(before, [batch.get_state(0), batch.get_state(1)])
        set_ = (setattr, batch, 'commands')
        refused(ValueError, r'must be \(2, 2\)', *set_, [[1, 1]])
        refused(ValueError, r'must be \(2, 2\)', *set_, [1, 1])
        refused(ValueError, 'finite', *set_, [[1, 1], [1, float('nan')]])
        refused(ValueError, "world 1: .*'right': 9 is out of range", *set_, [[0.9, 1], [1, 9]])
        refused((TypeError, ValueError), '', *set_, [['a', 'b'], ['c', 'd']])
        refused(ValueError, 'steps: 0 is out of range', batch.step, 0)
        refused(ValueError, 'steps: -1 is out of range', batch.step, -1)
        refused(TypeError, '', batch.step, 2.5)
        refused(IndexError, r'world 2 is out of range \[0, 1\]', batch.get_state, 2)
        refused(IndexError, 'world -1', batch.set_state, -1, before[0])
        refused(IndexError, 'world 5', batch.reset, [0, 5])
        refused(ValueError, 'a truth value for each', batch.reset, [True])
        refused((TypeError, RuntimeError), '', batch.reset, ['a'])
        refused(ValueError, 'worlds: 0 is out of range', soft_robot_lab.Batch, BAR, 0)
        refused(ValueError, 'threads: 0 is out of range', soft_robot_lab.Batch, BAR, 1, 0)
        refused(TypeError, '__init__ was not called', soft_robot_lab.Batch.step, soft_robot_lab.Batch.__new__(soft_robot_lab.Batch))
        fine = soft_robot_lab.Simulation(BAR, {'body.element_size_m': 0.01})
        refused(ValueError, 'sizes', batch.set_state, 0, fine.state)


if __name__ == '__main__':
    unittest.main()
