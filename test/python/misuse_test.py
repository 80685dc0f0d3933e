# SPDX-License-Identifier: BSD-3-Clause
"""What is wrong raises an exception that says what is allowed, and changes nothing; nothing ends the interpreter."""
import os
import tempfile
import threading
import unittest

import numpy

import soft_robot_lab
from scenes import BAR, bar_with


class Misuse(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.simulation = soft_robot_lab.Simulation(BAR)

    def refused(self, kind, text, call, *arguments, **named):
        before = self.simulation.state
        with self.assertRaisesRegex(kind, text):
            call(*arguments, **named)
        self.assertEqual(self.simulation.state, before)

    def test_wrong_files_are_settings_errors(self):
        load = soft_robot_lab.Simulation
        self.assertTrue(issubclass(soft_robot_lab.SettingsError, ValueError))
        self.refused(soft_robot_lab.SettingsError, 'cannot be read', load, '/nothing/here.yaml')
        self.refused(soft_robot_lab.SettingsError, "unknown key 'materail' .did you mean 'material'", load, BAR, {'body.materail.x': 1})
        self.refused(soft_robot_lab.SettingsError, r'youngs_modulus_pa: -1 is out of range', load, BAR, {'body.material.youngs_modulus_pa': -1})
        self.refused(soft_robot_lab.SettingsError, "'sofa' is not one of newton, xpbd, reduced", load, BAR, method='sofa')

    def test_wrong_overrides(self):
        load = soft_robot_lab.Simulation
        self.refused(ValueError, 'not a finite number', load, BAR, {'body.material.youngs_modulus_pa': float('nan')})
        self.refused(ValueError, 'is no path', load, BAR, {'body..x': 1})
        self.refused(ValueError, 'is no path', load, BAR, {'': 1})
        self.refused(TypeError, 'must be a str, not', load, BAR, {3: 1})
        self.refused(TypeError, 'number, str, bool, list or dict', load, BAR, {'body': object()})
        self.refused(TypeError, 'incompatible constructor arguments', load, BAR, [])
        self.refused(TypeError, 'incompatible constructor arguments', load)
        self.refused(TypeError, 'incompatible constructor arguments', load, 'a\0b')
        deep = []
        deep.append(deep)
        self.refused(ValueError, '20 deep', load, BAR, {'body': deep})

    def test_parameters_keep_their_ranges(self):
        with tempfile.TemporaryDirectory() as folder:
            path = bar_with(folder, 'scene.yaml', 'parameters: {stiffness: {range: [1, 2], factors: {body.material.youngs_modulus_pa: 1.0e+5}}}')
            self.refused(ValueError, "parameter 'stiffness': 3 is out of range", soft_robot_lab.Simulation, path, {'stiffness': 3})
            soft_robot_lab.Simulation(path, {'stiffness': 1.5})

    def test_wrong_commands(self):
        set_ = self.simulation.set
        self.refused(ValueError, "unknown actuator 'lefft'; known: left, right", set_, lefft=1.0)
        self.refused(ValueError, r"'left': 3 is out of range \[0.5, 1.5\]", set_, right=0.9, left=3)
        for wrong in (float('nan'), float('inf')):
            self.refused(ValueError, 'out of range', set_, left=wrong)
        self.refused(TypeError, 'real number', set_, left='much')
        self.refused(TypeError, 'must be a dict', set_, 0.9)
        self.refused(TypeError, 'real number', set_, left=None)
        for wrong in ([1.0], [1.0, 1.0, 1.0], [[1.0, 1.0]], 1.0, []):
            self.refused(ValueError, r'must be \(2,\)', setattr, self.simulation, 'commands', wrong)
        self.refused(ValueError, 'finite', setattr, self.simulation, 'commands', [1.0, float('nan')])
        self.refused((TypeError, ValueError), '', setattr, self.simulation, 'commands', ['a', 'b'])
        self.refused((TypeError, ValueError), '', setattr, self.simulation, 'commands', None)
        self.simulation.commands = numpy.array([1, 1])  # whole numbers are numbers

    def test_wrong_states(self):
        self.refused(TypeError, '', setattr, self.simulation, 'state', None)
        self.refused(TypeError, '', setattr, self.simulation, 'state', self.simulation)

    def test_objects_that_were_never_made(self):
        blank = soft_robot_lab.State.__new__(soft_robot_lab.State)
        self.refused(TypeError, '__init__ was not called', setattr, self.simulation, 'state', blank)
        self.refused(TypeError, '__init__ was not called', blank.copy)
        self.refused(TypeError, '__init__ was not called', lambda: blank == self.simulation.state)
        self.refused(TypeError, 'No constructor', soft_robot_lab.State)
        for kind in (soft_robot_lab.Simulation, soft_robot_lab.RunResult, soft_robot_lab.SolveReport):
            blank = kind.__new__(kind)
            for name in (name for name in dir(kind) if not name.startswith('_')):
                with self.assertRaisesRegex(TypeError, '__init__ was not called', msg=name):
                    member = getattr(blank, name)
                    member() if callable(member) else None

    def test_derivatives_of_a_motion_are_refused(self):
        moving = self.simulation.clone()
        moving.set(left=0.9)
        moving.step()
        with self.assertRaisesRegex(RuntimeError, 'equilibrium|rest'):
            moving.sensitivities()

    def test_arrays_are_read_only(self):
        for array in (self.simulation.nodes_m, self.simulation.skin_faces, self.simulation.elements, self.simulation.rest_nodes_m):
            with self.assertRaisesRegex(ValueError, 'read-only'):
                array[0] = 0
            with self.assertRaisesRegex(ValueError, 'WRITEABLE'):
                array.flags.writeable = True

    def test_two_threads_do_not_share_a_simulation(self):
        simulation = soft_robot_lab.Simulation(BAR, {'body.element_size_m': 0.006})
        simulation.set(left=0.8)
        begun, refused = threading.Event(), []

        def settle():
            begun.set()
            self.assertTrue(simulation.settle().converged)
        thread = threading.Thread(target=settle)
        thread.start()
        begun.wait()
        while thread.is_alive() and not refused:
            try:
                simulation.time_s  # a moment's use; may come before the solve
            except RuntimeError as error:
                refused.append(str(error))
        thread.join()
        self.assertIn('in use by another thread', refused[0])
        self.assertTrue(simulation.settle().converged)

    def test_a_child_of_a_fork_makes_its_own(self):
        child = os.fork()
        if child == 0:
            status = 1
            try:
                self.simulation.step()
            except RuntimeError as error:
                status = 0 if 'before a fork' in str(error) and soft_robot_lab.Simulation(BAR).settle().converged else 2
            os._exit(status)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertTrue(self.simulation.clone().settle().converged)


if __name__ == '__main__':
    unittest.main()
