# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C ends a solve, a run and a load with KeyboardInterrupt, and leaves the state as it was."""
import signal
import subprocess
import sys
import unittest

from scenes import BAR

LONG = '''
import signal, sys, soft_robot_lab
fine = {'body.element_size_m': 0.0033}
simulation = soft_robot_lab.Simulation(%r, dict(fine))
before = simulation.state
simulation.set(left=0.7)
commanded = simulation.state
print('begins', flush=True)
try:
    while True:
        simulation.state = commanded
        %s
except KeyboardInterrupt:
    print('interrupted', simulation.state == commanded or simulation.state.time_s > 0)
simulation.state = before
print(simulation.settle().converged)
'''


def interrupted(call):
    process = subprocess.Popen([sys.executable, '-B', '-c', LONG % (BAR, call)], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == 'begins\n'
    process.send_signal(signal.SIGINT)
    return process.communicate()[0]


class Interrupt(unittest.TestCase):
    def test_ends_a_long_settle(self):
        self.assertEqual(interrupted('simulation.settle()'), 'interrupted True\nTrue\n')

    def test_a_handler_may_do_something_else(self):
        said = interrupted('''signal.signal(signal.SIGINT, lambda *_: (print('heard', flush=True), sys.exit(3)))
        simulation.settle()''')
        self.assertIn('heard', said)
        self.assertNotIn('interrupted', said)


if __name__ == '__main__':
    unittest.main()
