# SPDX-License-Identifier: BSD-3-Clause
"""Simulations from Python: the numbers of the program `simulate` to the last bit, states, and views without a copy."""
import copy
import gc
import json
import pickle
import tempfile
import unittest

import numpy

import soft_robot_lab
from scenes import BAR, bar_with, simulated, without_times

REST = 'run: {mode: equilibrium, sensitivity: true, commands: [{time_s: 0, left: 0.9}]}'
MOTION = 'run: {mode: dynamic, duration_s: 0.2, commands: [{time_s: 0, left: 0.9}, {time_s: 0.1, right: 0.95}]}'


class Values(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def test_run_is_that_of_simulate(self):
        for text in (REST, MOTION, 'solver: {method: xpbd}\n' + MOTION, 'run: {mode: modal, modes: 3}'):
            path = bar_with(self.folder, 'scene.yaml', text)
            run = soft_robot_lab.Simulation(path).run()
            self.assertEqual(without_times(run.result_json), simulated(path), text)

    def test_rest_state_and_derivatives_are_those_of_simulate(self):
        expected = simulated(bar_with(self.folder, 'scene.yaml', REST))
        simulation = soft_robot_lab.Simulation(BAR)
        simulation.set(left=0.9)
        report = simulation.settle()
        self.assertTrue(report.converged, report.message)
        self.assertEqual(report.iterations, expected['solver']['iterations'])
        self.assertEqual(report.residual, expected['solver']['residual'])
        derivatives = simulation.sensitivities()
        for i, marker in enumerate(simulation.marker_names):
            self.assertEqual(simulation.markers()[marker].tolist(), expected['markers'][marker]['position_m'])
            for j, actuator in enumerate(simulation.actuator_names):
                self.assertEqual(derivatives[3 * i:3 * i + 3, j].tolist(), expected['sensitivity'][marker][actuator])
        for cable, tension_n in simulation.tensions_n().items():
            self.assertEqual(tension_n, expected['cables'][cable]['tension_n'])
        for cable, reading in simulation.readings().items():
            self.assertEqual(reading['slack_m'], expected['cables'][cable]['slack_m'])

    def test_steps_are_those_of_simulate(self):
        path = bar_with(self.folder, 'scene.yaml', MOTION)
        expected = simulated(path)['trajectory']
        simulation = soft_robot_lab.Simulation(path)
        run = simulation.run()
        self.assertEqual(simulation.time_s, 0.0)
        places_m = [simulation.markers_m]
        for i in range(len(expected['time_s']) - 1):
            if i == 0:
                simulation.set(left=0.9)
            if i == 6:
                simulation.set({'right': 0.95})
            self.assertTrue(simulation.step().converged)
            places_m.append(simulation.markers_m)
        for i, marker in enumerate(simulation.marker_names):
            self.assertEqual(numpy.array(places_m)[:, i].tolist(), expected['markers'][marker])
        self.assertEqual(run.markers_m.tolist(), numpy.array(places_m).tolist())
        self.assertEqual(run.time_s.tolist(), expected['time_s'])
        self.assertEqual(run.commands[-1].tolist(), [0.9, 0.95])
        self.assertEqual(run.reached.shape, run.commands.shape)

    def test_overrides_are_those_of_the_file(self):
        written = soft_robot_lab.Simulation(bar_with(self.folder, 'scene.yaml', '''
body: {material: {youngs_modulus_pa: 1.0e+5}}
cables: {left: {points_m: [[-0.007, 0, 0], [-0.005, 0, -0.1]]}}
solver: {integrator: bdf2}'''))
        given = soft_robot_lab.Simulation(BAR, {'body.material': {'youngs_modulus_pa': numpy.float64(1e5)}, 'solver.integrator': 'bdf2',
                                                'cables.left.points_m': ((-0.007, 0, 0), numpy.array([-0.005, 0, -0.1]))})
        place = soft_robot_lab.Simulation(BAR, {'body.material.youngs_modulus_pa': 1e5, 'solver.integrator': 'bdf2',
                                                'cables.left.points_m[1][0]': -0.005})
        for simulation in (written, given, place):
            simulation.set(left=0.95)
            for _ in range(3):
                simulation.step()
        self.assertEqual(written.markers_m.tolist(), given.markers_m.tolist())
        self.assertEqual(written.markers_m.tolist(), place.markers_m.tolist())


class States(unittest.TestCase):
    def moved(self, method=None):
        simulation = soft_robot_lab.Simulation(BAR, method=method)
        simulation.set(left=0.9)
        for _ in range(5):
            simulation.step()
        return simulation

    def test_a_state_goes_on_to_the_last_bit(self):
        for method in (None, 'xpbd'):
            simulation = self.moved(method)
            kept = simulation.state
            other = simulation.clone()
            for _ in range(3):
                simulation.step()
                other.step()
            self.assertEqual(simulation.state, other.state)
            self.assertNotEqual(simulation.state, kept)
            simulation.state = kept.copy()
            self.assertEqual(simulation.state, kept)
            for _ in range(3):
                simulation.step()
            if method is None:  # xpbd makes its elements' forces anew
                self.assertEqual(simulation.state, other.state)

    def test_a_pickle_keeps_every_bit(self):
        simulation = self.moved()
        kept = simulation.state
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            self.assertEqual(pickle.loads(pickle.dumps(kept, protocol)), kept)
        self.assertEqual(copy.deepcopy(kept), kept)
        bytes_ = pickle.dumps(kept)
        other = soft_robot_lab.Simulation(BAR)
        for one in (simulation, other):
            one.state = pickle.loads(bytes_)
            for _ in range(5):
                one.step()
        self.assertEqual(simulation.state, other.state)

    def test_other_pickles_are_refused(self):
        state = self.moved().state
        version, bytes_ = state.__getstate__()
        blank = soft_robot_lab.State.__new__(soft_robot_lab.State)
        with self.assertRaisesRegex(ValueError, 'of format %d; this module reads format %d alone' % (version + 1, version)):
            blank.__setstate__((version + 1, bytes_))
        for wrong in (bytes_[:-1], bytes_ + b'x', b'', bytes_[:8] + b'\xff' * 16 + bytes_[24:]):
            with self.assertRaises(ValueError):
                blank.__setstate__((version, wrong))
        for wrong in ((), (version,), ('1', bytes_), (version, 'text')):
            with self.assertRaises(ValueError):
                blank.__setstate__(wrong)

    def test_a_state_that_does_not_fit_changes_nothing(self):
        fine = soft_robot_lab.Simulation(BAR, {'body.element_size_m': 0.01})
        simulation = self.moved()
        before = simulation.state
        with self.assertRaisesRegex(ValueError, 'sizes are not those of this simulation'):
            simulation.state = fine.state
        self.assertEqual(simulation.state, before)

    def test_reset_is_the_start(self):
        simulation = self.moved()
        simulation.reset()
        self.assertEqual(simulation.state, soft_robot_lab.Simulation(BAR).state)


class Skin(unittest.TestCase):
    def test_nodes_are_shown_without_a_copy(self):
        simulation = soft_robot_lab.Simulation(BAR)
        nodes_m = simulation.nodes_m
        self.assertTrue(numpy.shares_memory(nodes_m, simulation.nodes_m))
        self.assertEqual(nodes_m.__array_interface__['data'], simulation.nodes_m.__array_interface__['data'])
        self.assertFalse(nodes_m.flags.writeable)
        self.assertEqual(nodes_m.tolist(), simulation.rest_nodes_m.tolist())
        simulation.set(left=0.9)
        simulation.settle()
        self.assertEqual(nodes_m.tolist(), simulation.state.positions_m.tolist())
        simulation.reset()
        self.assertEqual(nodes_m.tolist(), simulation.rest_nodes_m.tolist())

    def test_arrays_outlive_their_simulation(self):
        simulation = soft_robot_lab.Simulation(BAR)
        arrays = simulation.nodes_m, simulation.skin_faces, simulation.elements, simulation.rest_nodes_m
        kept = [array.copy() for array in arrays]
        del simulation
        gc.collect()
        soft_robot_lab.Simulation(BAR).settle()
        for array, before in zip(arrays, kept):
            self.assertEqual(array.tolist(), before.tolist())

    def test_faces_enclose_the_body(self):
        simulation = soft_robot_lab.Simulation(BAR)
        corners_m = simulation.nodes_m[simulation.skin_faces[:, :3]]
        volume_m3 = numpy.einsum('ij,ij->', corners_m[:, 0], numpy.cross(corners_m[:, 1], corners_m[:, 2])) / 6
        self.assertAlmostEqual(volume_m3, 0.02 * 0.02 * 0.1, delta=1e-10)

    def test_result_is_json(self):
        self.assertIn('markers', json.loads(soft_robot_lab.Simulation(BAR).run().result_json))


if __name__ == '__main__':
    unittest.main()
