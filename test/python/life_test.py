# SPDX-License-Identifier: BSD-3-Clause
"""A robot's life: what is done is kept, what broke down is tried again, and the page says why something was refused."""
import os
import tempfile
import unittest

from soft_robot_lab.life import drawing, offline, page
from soft_robot_lab.life.journal import Failure, Journal, Refusal, hash_of_files, last_words

ROBOTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'robots')


class LifeTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.part, self.robot = os.path.join(self.folder.name, 'part.yaml'), os.path.join(self.folder.name, 'robot.yaml')
        self.write(self.part, 'material: {preset: ecoflex_00_50}\n')
        self.write(self.robot, 'include: part.yaml\n')
        self.ran = []

    @staticmethod
    def write(path, text):
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)

    def live(self, broken=False):
        """Three steps, one of them refused, and one that needs what was refused."""
        def first(_, outcome):
            self.ran.append('first')
            outcome.values['number'] = 7
            outcome.say('a name', 'a <text>')

        def second(journal, _):
            self.ran.append('second')
            raise Failure('no session') if broken else Refusal('the mesh has %d holes' % journal.values('first')['number'])

        journal = Journal(self.robot, os.path.join(self.folder.name, 'life'))
        journal.run('first', [], first)
        journal.run('second', ['first'], second)
        journal.run('third', ['second'], lambda _, __: self.ran.append('third'))
        return journal

    def test_keeps_what_is_done_or_refused(self):
        journal = self.live()
        self.assertEqual([outcome.state for outcome in journal.outcomes.values()], ['done', 'refused', 'left out'])
        again = self.live()
        self.assertEqual(self.ran, ['first', 'second'])
        self.assertEqual(again.values('first'), {'number': 7})
        self.assertEqual(again.outcomes['second'].why, 'the mesh has 7 holes')
        self.assertEqual(again.outcomes['third'].why, 'it needs the step second')

    def test_tries_again_what_broke_down(self):
        self.assertEqual(self.live(broken=True).outcomes['second'].state, 'failed')
        self.assertEqual(self.live().outcomes['second'].state, 'refused')
        self.assertEqual(self.ran, ['first', 'second', 'second'])

    def test_begins_anew_where_an_included_file_changed(self):
        self.live()
        self.write(self.part, 'material: {preset: ecoflex_00_30}\n')
        self.live()
        self.assertEqual(self.ran, ['first', 'second'] * 2)

    def test_knows_the_files_of_a_robot(self):
        names = {os.path.basename(path) for path in hash_of_files(os.path.join(ROBOTS, 'mesh_arm.yaml'))}
        self.assertEqual(names, {'mesh_arm.yaml', 'mesh_arm.vtk'})

    def test_page_names_each_step_and_why(self):
        journal = self.live()
        path = os.path.join(self.folder.name, 'life.html')
        page.write(path, 'robot', journal, {'first': 'One', 'second': 'Two', 'third': 'Three'})
        with open(path, encoding='utf-8') as file:
            text = file.read()
        for said in ('Refused: the mesh has 7 holes', 'Left out: it needs the step second', 'a &lt;text&gt;', 'href="#third">Three'):
            self.assertIn(said, text)

    def test_draws_a_robot_of_a_file(self):
        simulation = offline.at_rest(os.path.join(ROBOTS, 'mesh_arm.yaml'))
        svg = drawing.robots([offline.skin('arm', simulation, '#5b8fd0')], [('tip', simulation.markers()['tip'], '#d03030')])
        self.assertGreater(svg.count('<polygon'), 40)
        self.assertNotIn('nan', svg)

    def test_says_what_no_robot_is(self):
        with self.assertRaisesRegex(Refusal, 'body'):
            offline.at_rest(self.robot)

    def test_reads_the_last_words_of_a_program(self):
        self.assertEqual(last_words('1 %\r50 %\rgo: warning: thin\nno rest state\n\n'), 'no rest state')


if __name__ == '__main__':
    unittest.main()
