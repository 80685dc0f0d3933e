# SPDX-License-Identifier: BSD-3-Clause
"""Small scenes for the tests of the Python module, and what the program `simulate` makes of them."""
import json
import os
import subprocess

SOURCE = os.environ['SOFT_ROBOT_LAB_SOURCE']
SIMULATE = os.environ['SOFT_ROBOT_LAB_SIMULATE']
PROGRAMS = os.path.dirname(SIMULATE)
BAR = os.path.join(SOURCE, 'test', 'data', 'scenes', 'cable_bar.yaml')


def bar_with(folder, name, text):
    """A file in `folder` that includes the bar."""
    path = os.path.join(folder, name)
    with open(path, 'w', encoding='utf-8') as file:
        file.write('include: %s\n%s\n' % (BAR, text))
    return path


def simulated(path):
    """result.json of `simulate`, without wall times."""
    said = subprocess.run([SIMULATE, path], stdout=subprocess.PIPE, check=True).stdout
    return without_times(said)


def without_times(text):
    result = json.loads(text)
    del result['solver']['wall_s']
    return result
