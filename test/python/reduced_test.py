# SPDX-License-Identifier: BSD-3-Clause
"""Simulations by a reduced model, and what happens beyond what it was trained for."""
import pickle
import unittest

import soft_robot_lab
from scenes import BAR

REDUCED = {'solver': {'method': 'reduced', 'tolerance_m': 1e-3, 'commands': {'left': [0.9, 1.02], 'right': [0.95, 1.02]}}}
COMMANDS = [[0.92, 1.0], [1.0, 0.96], [0.9, 1.0]]


class Reduced(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulation = soft_robot_lab.Simulation(BAR, REDUCED)

    def setUp(self):
        self.simulation.reset()
        self.simulation.set(left=0.92)

    def test_shows_the_nodes_that_it_moves(self):
        nodes_m = self.simulation.nodes_m
        self.assertTrue(self.simulation.reduced)
        self.simulation.step()
        moved_m = nodes_m.copy()
        self.assertNotEqual(moved_m.tolist(), self.simulation.rest_nodes_m.tolist())
        self.assertEqual(moved_m.tolist(), self.simulation.state.positions_m.tolist())

    def test_a_state_keeps_what_the_reduced_model_knows(self):
        self.simulation.step()
        kept = pickle.loads(pickle.dumps(self.simulation.state))
        self.assertEqual(kept, self.simulation.state)
        ends = []
        for _ in range(2):
            self.simulation.state = kept
            for _ in range(3):
                self.simulation.step()
            ends.append(self.simulation.state)
        self.assertEqual(ends[0], ends[1])
        self.assertTrue(self.simulation.reduced)

    def test_states_of_another_model_are_refused(self):
        full = soft_robot_lab.Simulation(BAR)
        with self.assertRaisesRegex(ValueError, 'of a reduced model'):
            full.state = self.simulation.state
        other = soft_robot_lab.Simulation(BAR, dict(REDUCED, **{'solver.tolerance_m': 3e-4}))
        other.set(left=0.92)
        other.step()
        before = self.simulation.state
        with self.assertRaisesRegex(ValueError, 'sizes are not those of this reduced model'):
            self.simulation.state = other.state
        self.assertEqual(self.simulation.state, before)
        self.simulation.state = full.state
        self.assertFalse(self.simulation.reduced)

    def test_newton_goes_on_where_it_was_not_trained(self):
        self.simulation.set(left=0.8)
        kinds = [warning['kind'] for warning in self.simulation.step().warnings]
        self.assertIn('outside_training', kinds)
        self.assertFalse(self.simulation.reduced)

    def test_a_batch_gives_the_same_for_any_number_of_threads(self):
        one, two = (soft_robot_lab.Batch(BAR, len(COMMANDS), threads, REDUCED) for threads in (1, 2))
        for batch in (one, two):
            batch.commands = COMMANDS
            self.assertTrue(batch.step(5).converged.all())
        self.assertEqual(one.markers_m.tolist(), two.markers_m.tolist())
        for world, commands in enumerate(COMMANDS):
            self.simulation.reset()
            self.simulation.commands = commands
            for _ in range(5):
                self.simulation.step()
            self.assertEqual(one.get_state(world), self.simulation.state)
        self.assertTrue(one.settle().converged.all())


if __name__ == '__main__':
    unittest.main()
