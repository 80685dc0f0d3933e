#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""study_efficiency.py STUDY [REPEATS]: how well the program `study` uses two cores with tasks of about a second.

Runs 60 tasks by one worker and by two, and prints for each run the time, its own CPU time, and what other programs took
and left idle meanwhile (/proc/stat). The efficiency is the CPU time of one worker's run over what the others left of two
cores during the run of two workers. On a machine that does nothing else this is the usual one, serial time over twice
the time of two.
"""
import os
import resource
import subprocess
import sys
import tempfile
import time

CORES = os.cpu_count()
SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENE = f'''include: {SOURCE}/config/scenes/cantilever.yaml
body: {{element_size_m: 0.0045}}
run: {{mode: dynamic, duration_s: 0.6}}
'''
STUDY = '''program: simulate
scene: bar.yaml
method: latin_hypercube
samples: 60
parameters: {body.material.youngs_modulus_pa: {range: [1.0e+5, 4.0e+5]}}
'''


def machine():
    """CPU seconds since the start: busy, and idle."""
    with open('/proc/stat', encoding='ascii') as file:
        times = [int(word) / os.sysconf('SC_CLK_TCK') for word in file.readline().split()[1:8]]
    return sum(times) - times[3] - times[4], times[3] + times[4]


def run(study, folder, workers):
    before, own, begin = machine(), resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run([study, folder + '/study.yaml', '--output', f'{folder}/{workers}', '--workers', str(workers)],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wall, after, end = time.monotonic() - begin, machine(), resource.getrusage(resource.RUSAGE_CHILDREN)
    own = end.ru_utime + end.ru_stime - own.ru_utime - own.ru_stime
    others = max(after[0] - before[0] - own, 0.0)
    print(f'{workers} workers: {wall:.1f} s, own CPU time {own:.1f} s, others {others:.1f} s, idle {after[1] - before[1]:.1f} s',
          flush=True)
    return wall, own, others


def main():
    if CORES != 2:
        sys.exit(f'study_efficiency.py: this machine has {CORES} cores; what others leave is only known on one with two')
    for _ in range(int(sys.argv[2]) if len(sys.argv) > 2 else 1):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (('bar.yaml', SCENE), ('study.yaml', STUDY)):
                with open(f'{folder}/{name}', 'w', encoding='utf-8') as file:
                    file.write(text)
            _, serial, _ = run(sys.argv[1], folder, 1)
            wall, _, others = run(sys.argv[1], folder, 2)
            print(f'efficiency {serial / (CORES * wall - others):.3f}', flush=True)


if __name__ == '__main__':
    main()
