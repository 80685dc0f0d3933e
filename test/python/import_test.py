# SPDX-License-Identifier: BSD-3-Clause
"""The package is imported without ROS's Python and without a master; its client of sessions says then what it lacks."""
import os
import subprocess
import sys
import unittest

WITHOUT_ROS = 'import sys; sys.modules.update(actionlib=None, rospy=None, rosgraph=None, genpy=None)\n'


def run(code):
    environment = {name: value for name, value in os.environ.items() if not name.startswith('ROS')}
    return subprocess.run([sys.executable, '-B', '-c', WITHOUT_ROS + code], env=environment, capture_output=True, text=True)


class Import(unittest.TestCase):
    def test_needs_no_ros(self):
        done = run('import soft_robot_lab; print(soft_robot_lab.Simulation.__module__)')
        self.assertEqual((done.stdout, done.stderr), ('soft_robot_lab\n', ''))

    def test_names_what_there_is(self):
        done = run('import soft_robot_lab as s; print(set(s.__all__ + [\'Session\']) <= set(dir(s))); s.Nothing')
        self.assertEqual(done.stdout, 'True\n')
        self.assertIn("module 'soft_robot_lab' has no attribute 'Nothing'", done.stderr)

    def test_client_of_sessions_needs_ros(self):
        done = run('import soft_robot_lab; soft_robot_lab.Session')
        self.assertIn('import of actionlib halted', done.stderr)

    def test_leaves_signals_to_python(self):
        done = run('import signal, soft_robot_lab; print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)')
        self.assertEqual(done.stdout, 'True\n')


if __name__ == '__main__':
    unittest.main()
