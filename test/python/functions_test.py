# SPDX-License-Identifier: BSD-3-Clause
"""What programs do, as functions: their numbers are those of the programs; and meshes go out and in again."""
import json
import os
import subprocess
import tempfile
import unittest

import numpy

import soft_robot_lab
from scenes import BAR, PROGRAMS

TARGET_M = (-0.02, 0.0, -0.09)


class Functions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def result_of(self, program, *arguments):
        result = os.path.join(self.folder, program + '.json')
        subprocess.run([os.path.join(PROGRAMS, program), *arguments, '--result', result], stdout=subprocess.DEVNULL, check=False)
        with open(result, encoding='utf-8') as file:
            return json.load(file)

    def test_optimise_finds_what_the_program_finds(self):
        found = soft_robot_lab.optimise(BAR, {'tip': TARGET_M})
        expected = self.result_of('optimise', BAR, '--marker', 'tip', '--target', *map(str, TARGET_M), '--tolerance', '1e-5')
        self.assertTrue(found['success'])
        self.assertEqual(found['names'], expected['policy']['names'])
        self.assertEqual(found['values'][0].tolist(), expected['policy']['steps'][0]['values'])
        self.assertEqual(found['poses'][0]['final_distance_m'], expected['poses'][0]['final_distance_m'])
        simulation = soft_robot_lab.Simulation(BAR)
        simulation.commands = found['values'][0]
        self.assertTrue(simulation.settle().converged)
        self.assertLess(numpy.linalg.norm(simulation.markers()['tip'] - found['poses'][0]['nearest_m']['tip']), 1e-5)

    def test_optimise_refuses_wrong_tasks(self):
        for kind, text, arguments in (
                (ValueError, 'tipp', ({'tipp': TARGET_M},)), (ValueError, r'must be \(3,\)', ({'tip': (0, 0)},)),
                (ValueError, 'finite', ({'tip': (0, 0, float('nan'))},)), (ValueError, '', ([],)), (TypeError, '', (3,)),
                (TypeError, 'dict of markers', ([3],)), (ValueError, 'newtons', ({'tip': TARGET_M}, 'newtons'))):
            with self.assertRaisesRegex(kind, text):
                soft_robot_lab.optimise(BAR, *arguments)

    def test_fit_finds_the_stiffness_that_made_the_data(self):
        made = soft_robot_lab.Simulation(BAR, {'body.material.youngs_modulus_pa': 3e5})
        poses = []
        for commands in ({'left': 0.95}, {'left': 0.9}, {'left': 1.0, 'right': 0.92}):
            made.set(commands)
            self.assertTrue(made.settle().converged)
            poses.append((commands, made.markers()))
            made.set(left=1.0, right=1.0)
        fitted = os.path.join(self.folder, 'fitted.yaml')
        result = soft_robot_lab.fit(BAR, poses, ['youngs_modulus_pa'], output=fitted)
        value = result['values']['youngs_modulus_pa']
        self.assertTrue(result['converged'], result['message'])
        self.assertAlmostEqual(value['value'] / 3e5, 1.0, delta=0.01)
        self.assertTrue(soft_robot_lab.Simulation(fitted).settle().converged)

    def test_fit_refuses_wrong_data(self):
        pose = ({'left': 0.9}, {'tip': TARGET_M})
        for kind, text, arguments in (
                (ValueError, '', ([], ['youngs_modulus_pa'])), (ValueError, 'stiffness', ([pose], ['stiffness'])),
                (TypeError, 'tuple of two dicts', ([3], ['youngs_modulus_pa'])), (ValueError, 'sigma_m', ([pose], ['youngs_modulus_pa'], 0.0)),
                (ValueError, 'finite', ([({}, {'tip': (0, 0, float('inf'))})], ['youngs_modulus_pa']))):
            with self.assertRaisesRegex(kind, text):
                soft_robot_lab.fit(BAR, *arguments)

    def test_check_casting_says_what_the_program_says(self):
        self.assertEqual(soft_robot_lab.check_casting(BAR), self.result_of('check_casting', BAR))
        with self.assertRaises(soft_robot_lab.SettingsError):
            soft_robot_lab.check_casting('/nothing/here.yaml')

    def test_make_mould_refuses_a_folder_with_other_files(self):
        with open(os.path.join(self.folder, 'letter.txt'), 'w', encoding='utf-8') as file:
            file.write('mine')
        with self.assertRaisesRegex(RuntimeError, 'letter.txt|other files|holds'):
            soft_robot_lab.make_mould(BAR, self.folder)
        with self.assertRaisesRegex(ValueError, 'not one of two_part, lid'):
            soft_robot_lab.make_mould(BAR, os.path.join(self.folder, 'mould'), allow=['glue'])


class Meshes(unittest.TestCase):
    def test_a_mesh_goes_out_and_in_again(self):
        bar = soft_robot_lab.Simulation(BAR)
        with tempfile.TemporaryDirectory() as folder:
            soft_robot_lab.Mesh.of(bar).write(os.path.join(folder, 'bar.msh'))
            scene = os.path.join(folder, 'scene.yaml')
            with open(scene, 'w', encoding='utf-8') as file:
                file.write('body: {mesh: bar.msh, material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}, '
                           'fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]}\n')
            again = soft_robot_lab.Simulation(scene)
        self.assertEqual(again.rest_nodes_m.tolist(), bar.rest_nodes_m.tolist())
        self.assertEqual(again.elements.tolist(), bar.elements.tolist())

    def test_wrong_arrays_are_refused(self):
        nodes = numpy.vstack([numpy.zeros(3), numpy.eye(3)])
        for arguments in ((nodes[:, :2], [[0, 1, 2, 3]]), (nodes * numpy.nan, [[0, 1, 2, 3]]), (nodes, [[0, 1, 2]]), (nodes, [[0, 1, 2, 4]]),
                          (nodes, [[0, 1, 2, -1]]), (nodes, [[0.0, 1.0, 2.0, 3.0]]), (nodes, [[0, 1, 2, 3]], {'a"b': [[0, 1, 2]]}),
                          (nodes, [[0, 1, 2, 3]], {'a': [[0, 1]]})):
            with self.assertRaises(ValueError):
                soft_robot_lab.Mesh(*arguments)


if __name__ == '__main__':
    unittest.main()
