#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""python_speed.py SCENE [WORLDS THREADS DURATION_S]: what a step costs through the Python module, beside the solver's own time,
and for a batch as the program rollouts counts it: seconds of the robots over seconds of CPU. Best of five.
python_speed.py --task TASK WORLDS THREADS: control steps of a VectorEnvironment in a second of CPU, with drawn actions and resets."""
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


def of_task(task, worlds, threads):
    environment = soft_robot_lab.VectorEnvironment(task, worlds, threads)
    draw = numpy.random.default_rng(1)
    environment.reset(seed=1)
    rates, returns = [], []
    for _ in range(5):
        begin_s, cpu_begin_s, total = time.monotonic(), cpu_s(), 0.0
        for step in range(200):
            total += environment.step(draw.uniform(-1, 1, environment.action_space.shape))[1].mean()
        rates.append((worlds * 200 / (cpu_s() - cpu_begin_s), worlds * 200 / (time.monotonic() - begin_s)))
        returns.append(total / 200)
    print('%d worlds, %d threads: %.0f steps a CPU-second, %.0f a second; mean reward %.4f' % ((worlds, threads) + max(rates) + (returns[0],)))


if sys.argv[1] == '--task':
    of_task(sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
elif len(sys.argv) > 2:
    of_batch(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4]))
else:
    of_one(sys.argv[1])
