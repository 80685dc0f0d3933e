#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""python_speed.py SCENE [WORLDS THREADS DURATION_S]: what a step costs through the Python module, beside the solver's own time,
and for a batch as the program rollouts counts it: seconds of the robots over seconds of CPU. Best of five."""
import resource
import sys
import time

import numpy

import soft_robot_lab


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def of_one(scene, steps=2000):
    simulation = soft_robot_lab.Simulation(scene)
    best_us = []
    for _ in range(5):
        simulation.reset()
        simulation.settle()
        begin_s, solver_s = time.perf_counter(), 0.0
        for _ in range(steps):
            solver_s += simulation.step().wall_s
        best_us.append(1e6 * (time.perf_counter() - begin_s - solver_s) / steps)
    print('beside the solver a step costs %.2f us' % min(best_us))


def of_batch(scene, worlds, threads, duration_s):
    batch = soft_robot_lab.Batch(scene, worlds, threads)
    ranges = numpy.array([batch.limits[name][1:3] for name in batch.actuator_names])
    draw = numpy.random.default_rng(1)
    hold, rates = round(0.5 / batch.time_step_s), []
    for _ in range(5):
        batch.reset()
        begin_s, cpu_begin_s = time.monotonic(), cpu_s()
        for _ in range(round(duration_s / 0.5)):
            batch.commands = draw.uniform(numpy.maximum(ranges[:, 0], 0.75), numpy.minimum(ranges[:, 1], 1.1), (worlds, len(ranges)))
            batch.step(hold)
        rates.append((worlds * duration_s / (cpu_s() - cpu_begin_s), worlds * duration_s / (time.monotonic() - begin_s)))
    print('%d worlds, %d threads: %.0f times real time a core, %.0f in all' % ((worlds, threads) + max(rates)))


if len(sys.argv) > 2:
    of_batch(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4]))
else:
    of_one(sys.argv[1])
