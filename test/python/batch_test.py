# SPDX-License-Identifier: BSD-3-Clause
"""Batches: the numbers of one simulation, to the last bit for any number of threads."""
import os
import pickle
import unittest

import numpy

import soft_robot_lab
from scenes import BAR, SOURCE

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

    def test_worlds_of_several_models(self):
        changes = [{'body.material.youngs_modulus_pa': modulus_pa} for modulus_pa in (2e5, 3e5, 4e5)]
        batch = soft_robot_lab.Batch(BAR, 5, 2, changes)
        self.assertEqual(batch.models.tolist(), [0, 1, 2, 0, 1])
        batch.commands = COMMANDS
        batch.step(2)
        batch.reset([3, 0], [1, 2])
        self.assertEqual(batch.models.tolist(), [2, 1, 2, 1, 1])
        self.assertEqual((batch.time_s == 0).tolist(), [True, False, False, True, False])
        batch.commands = COMMANDS
        batch.step()
        for world, (model, steps) in enumerate(((2, 1), (1, 3), (2, 3), (1, 1), (1, 3))):
            simulation = soft_robot_lab.Simulation(BAR, changes[model])
            simulation.commands = COMMANDS[world]
            for _ in range(steps):
                simulation.step()
            self.assertEqual(batch.markers_m[world].tolist(), simulation.markers_m.tolist())
            self.assertEqual(batch.get_state(world), simulation.state)
        for wrong, kind, text in (([0, 3], IndexError, r'model 3 is out of range \[0, 2\]'), ([0, -1], IndexError, 'model -1'),
                                  ([0], ValueError, 'a number for each of the 2 worlds')):
            with self.assertRaisesRegex(kind, text):
                batch.reset([0, 1], wrong)
            self.assertEqual(batch.models.tolist(), [2, 1, 2, 1, 1])

    def test_models_that_differ_too_much_are_refused(self):
        for change, text in (({'solver.time_step_s': 0.01}, 'other time steps'), ({'markers.tip.name': 'top'}, 'other markers'),
                             ({'cables.left.name': 'front'}, 'other actuators')):
            with self.assertRaisesRegex(ValueError, r'overrides\[1\]: ' + text):
                soft_robot_lab.Batch(BAR, 2, 1, [{}, change])
        with self.assertRaisesRegex(ValueError, 'at least one dict'):
            soft_robot_lab.Batch(BAR, 2, 1, [])
        with self.assertRaisesRegex(soft_robot_lab.SettingsError, 'youngs_modulus_pa: -2 is out of range'):
            soft_robot_lab.Batch(BAR, 2, 2, [{'body.material.youngs_modulus_pa': value} for value in (1e5, -2, 1e5, -3)])

    def test_some_worlds_settle_and_are_read(self):
        batch = soft_robot_lab.Batch(os.path.join(SOURCE, 'test', 'data', 'scenes', 'resting_bar.yaml'), 3, 2)
        batch.commands = COMMANDS[2:]
        before = batch.get_state(1)
        report = batch.settle([2, 0])
        self.assertEqual((len(report.reports), report.converged.all()), (2, True))
        self.assertEqual(batch.get_state(1), before)
        simulation = soft_robot_lab.Simulation(os.path.join(SOURCE, 'test', 'data', 'scenes', 'resting_bar.yaml'))
        simulation.commands = COMMANDS[4]
        self.assertEqual(report.iterations[0], simulation.settle().iterations)
        self.assertEqual(str(batch.readings(2)), str(simulation.readings()))
        self.assertEqual(str(batch.contacts(2)), str(simulation.contacts()))
        self.assertGreater(len(batch.contacts(2)), 0)
        for wrong in (batch.readings, batch.contacts):
            with self.assertRaisesRegex(IndexError, 'world 3 is out of range'):
                wrong(3)

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
