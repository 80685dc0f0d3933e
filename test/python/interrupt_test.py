# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C ends a solve, a run and a load with KeyboardInterrupt, and leaves the state as it was."""
import subprocess
import sys
import unittest

from scenes import BAR

# Ctrl-C is pressed by a thread that finds the object in use.
BEGIN = '''
import os, signal, sys, threading, soft_robot_lab
def press_while_busy(busy):
    def press():
        while True:
            try:
                busy.time_s
            except RuntimeError:
                return os.kill(os.getpid(), signal.SIGINT)
    threading.Thread(target=press, daemon=True).start()
'''
SIMULATION = BEGIN + '''
simulation = soft_robot_lab.Simulation(%r, {'body.element_size_m': 0.003, 'run': {'mode': 'dynamic', 'duration_s': 100}})
simulation.set(left=0.6)
before = simulation.state
''' % BAR
SHORT = SIMULATION.replace('0.003', '0.007').replace('left=0.6', 'left=0.8')
CAUGHT = '''
press_while_busy(simulation)
try:
    %s
    print('ended')
except KeyboardInterrupt:
    print('interrupted', simulation.state == before)
simulation.reset()
print(simulation.step().converged)
'''


def said(code):
    return subprocess.run([sys.executable, '-B', '-c', code], stdout=subprocess.PIPE, text=True, check=False, timeout=200).stdout


class Interrupt(unittest.TestCase):
    def test_ends_a_long_settle(self):
        self.assertEqual(said(SIMULATION + CAUGHT % 'simulation.settle()'), 'interrupted True\nTrue\n')

    def test_ends_a_run(self):
        self.assertEqual(said(SIMULATION + CAUGHT % 'simulation.run()'), 'interrupted True\nTrue\n')

    def test_a_handler_that_throws_nothing_lets_it_go_on(self):
        heard = 'signal.signal(signal.SIGINT, lambda *_: print("heard"))\n'
        self.assertEqual(said(SHORT + heard + CAUGHT % 'simulation.settle()'), 'heard\nended\nTrue\n')

    def test_a_handler_may_throw_something_else(self):
        thrown = 'signal.signal(signal.SIGINT, lambda *_: 1 / 0)\n'
        code = SIMULATION + thrown + (CAUGHT % 'simulation.settle()').replace('KeyboardInterrupt', 'ZeroDivisionError')
        self.assertEqual(said(code), 'interrupted True\nTrue\n')

    def test_a_handler_cannot_use_what_is_solved(self):
        used = '''
def use(*_):
    try:
        simulation.step()
    except RuntimeError as error:
        print(error)
signal.signal(signal.SIGINT, use)
'''
        self.assertEqual(said(SHORT + used + CAUGHT % 'simulation.settle()'),
                         'in use by another thread: give each thread its own clone()\nended\nTrue\n')

    def test_ends_a_batch(self):
        code = BEGIN + '''
batch = soft_robot_lab.Batch(%r, 4, threads=2, overrides={'body.element_size_m': 0.005})
batch.commands = [[0.7, 1.0]] * 4
press_while_busy(batch)
try:
    batch.step(1000000)
except KeyboardInterrupt:
    print('interrupted')
batch.reset()
print(batch.step().converged.all())
''' % BAR
        self.assertEqual(said(code), 'interrupted\nTrue\n')

    def test_ends_the_training_of_a_reduced_model(self):
        code = BEGIN + '''
import time
threading.Thread(target=lambda: (time.sleep(0.5), os.kill(os.getpid(), signal.SIGINT)), daemon=True).start()
try:
    soft_robot_lab.Simulation(%r, {'body.element_size_m': 0.005}, method='reduced')
except KeyboardInterrupt:
    print('interrupted')
print(soft_robot_lab.Simulation(%r).settle().converged)
''' % (BAR, BAR)
        self.assertEqual(said(code), 'interrupted\nTrue\n')


if __name__ == '__main__':
    unittest.main()
