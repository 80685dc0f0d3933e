#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_arguments.py ROBOT [WORD=PATH...] [cameras=NAME]: for launch files, before any node starts. Prints ROBOT where all
is well. Ends with an error where there is no such robot, file or kind of cameras, and names the nearest."""
import difflib
import os
import sys

CAMERAS = ('none', 'rendered')
ROBOTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'config', 'robots')


def refuse(argument, value, known):
    near = difflib.get_close_matches(value, known, 1, 0.5)
    meant = f" (did you mean '{near[0]}'?)" if near else ''
    sys.exit(f"{argument}: there is no '{value}'{meant}; known: {', '.join(known)}")


def check_file(argument, path, robot):
    """Of the package's own robots, and the scene; what else is missing the node says that reads it."""
    own = os.path.realpath(path).startswith(os.path.realpath(ROBOTS) + os.sep)
    if os.path.exists(path) or not (own or argument == 'scene'):
        return
    if own and not os.path.isdir(os.path.join(ROBOTS, robot)):
        refuse('robot', robot, sorted(os.listdir(ROBOTS)))
    sys.exit(f'{argument}: there is no file {path}')


robot = sys.argv[1]
for word in sys.argv[2:]:
    name, value = word.split('=', 1)
    if name == 'cameras' and value not in CAMERAS:
        refuse(name, value, CAMERAS)
    if name != 'cameras' and value:
        check_file(name, value, robot)
print(robot, end='')
