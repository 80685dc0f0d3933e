# SPDX-License-Identifier: BSD-3-Clause
"""What stands in README.md beside tables: plain text without measured numbers."""

FOREWORD = '''
This page is written by `run_all.py` from what it measured and stored in `results/`; no number in it is typed by hand.

    test/benchmark/run_all.py --list        # all tables
    test/benchmark/run_all.py NAME...       # measure some anew, or `all`, and write this page
    test/benchmark/run_all.py --older       # measure those anew whose subject changed

Below each table stand its command, the date, the commit, the CPU time of all of it, and the load of the machine before and after.
Times in tables are CPU times of one thread, unless a column says otherwise, on a shared machine: a ratio of two rows says more than a row.

A table's subject is what is measured: the robots, scenes, experiments and reference data, with all files that they name.
The page marks a table whose subject changed since, and a check of the suite fails (`run_all.py --check subjects`).
Comments do not count.
A change of the programs' sources makes no table older, as that would ask for hours after each: the commit says which sources were measured.
What was measured of earlier versions, and what was tried, stands in the messages of commits.
'''

SECTIONS = {
    'Speed': 'Robots at the settings of their files, in steps of a frame. `benchmark_soft_robot_lab` measures it.',
    'Reduced models': 'Trained for the commands that the robot uses, and compared with `newton` on the same mesh, in one process.\n'
                      'Distances are of all nodes, at commands and in motion that training did not use; an audit estimates the error of a state.',
    'The same rest state by every way': 'Whatever solver, time step or way leads there, a body must come to rest where its equilibrium is.',
    'Elements and materials': 'Bodies with references from elsewhere (`config/reference/`) or with finer meshes of our own.',
    'Error against CPU time': 'What accuracy costs, and what others\' programs take.',
    'Where methods fail': 'Every method in hard cases: nearly incompressible silicone, long steps, rigid cables, slivers, scrambled nodes, obstacles.\n'
                          '*Survived*: every solve converged to the right place without inverted elements. *Recovered*: the same, but a solve failed on the way, or the start was no shape.\n'
                          '*Failed silently*: it claims to have converged to something else.',
    'Contact with obstacles': 'The tests of `test/mechanics` hold these; the references R7 to R13 are others\' solutions, of nearly incompressible silicone.',
    'Self-contact': 'Skin that touches skin.',
    'Gripper': '',
    'Workspaces': 'Where robots rest over all commands, by `experiment`.',
    'Finding policies': 'Commands that bring a marker to a target, on the model.',
    'Reaching for a ball': 'Policies of the model, played on an emulated robot that differs from it, then in closed loop.\n'
                           'Distances on the emulated robot are true ones; the controller knows measured ones.',
    'A learned policy': '',
    'Emulated sessions': 'The emulated rig is our own model with other parameters: its gaps measure the tool chain, not the model of silicone.\n'
                         'Robots go through the source\'s configurations in its order, filmed by rendered cameras, beside the simulation of the same commands.',
    'Fits': 'Parameters of a robot found again from recordings of markers.',
    'What pushes a robot': '',
    'Motor rig': 'The real firmware on emulated boards.',
    'Tracker': 'Rendered cameras film simulated robots.',
    'Casting': '',
}
