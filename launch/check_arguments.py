#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""check_arguments.py ROBOT [WORD=PATH...] [SWITCH=True...] [cameras=NAME] [solver=NAME] [load=SCENE]: for launch files,
before any node starts. Prints ROBOT where all is well. Ends with an error where there is no such argument, robot, file, solver,
state of a switch or kind of cameras, and names the nearest, and where the scene to be loaded or another file is wrong: once nodes run, roslaunch ends
with status 0 whatever they end with."""
import difflib
import os
import subprocess
import sys
import xml.etree.ElementTree

CAMERAS = ('none', 'rendered')
SWITCHES = ('emulated', 'hardware', 'record', 'record_images', 'rviz', 'twin', 'wall_clock')
SOLVERS = ('newton', 'xpbd', 'reduced')  # or empty: the scene's own
READ = {'rig': '--rig', 'camera_setup': '--cameras', 'balls': '--balls', 'tracker': '--tracker'}  # by check_scene_node
RIG = ('rig', 'plant', 'tracker', 'balls')
HERE = os.path.dirname(os.path.realpath(__file__))
ROBOTS = os.path.join(HERE, '..', 'config', 'robots')


def refuse(argument, value, known):
    near = difflib.get_close_matches(value, known, 1, 0.5)
    meant = f" (did you mean '{near[0]}'?)" if near else ''
    sys.exit(f"{argument}: there is no '{value}'{meant}; known: {', '.join(known)}")


def roslaunch_words():
    """Of the roslaunch that runs this: its launch file, where that is one beside this, and the words behind it."""
    process = os.getppid()
    while process > 1:
        with open(f'/proc/{process}/cmdline', encoding='utf-8', errors='replace') as file:
            words = file.read().split('\0')
        for place, word in enumerate(words):
            if not word.endswith('.launch'):
                continue
            path = os.path.join(os.readlink(f'/proc/{process}/cwd'), word)
            if not os.path.exists(path) and words[place - 1] == 'soft_robot_lab':
                path = os.path.join(HERE, word)
            return (path, words[place + 1:]) if os.path.dirname(os.path.realpath(path)) == HERE else (None, [])
        with open(f'/proc/{process}/stat', encoding='utf-8', errors='replace') as file:
            process = int(file.read().rpartition(')')[2].split()[1])
    return None, []


def check_names():
    """roslaunch says nothing of an argument that its file does not have."""
    path, words = roslaunch_words()
    if path is None:
        return
    known = sorted({arg.get('name') for arg in xml.etree.ElementTree.parse(path).getroot().findall('arg') if 'value' not in arg.attrib})
    for word in words:
        name, is_given, _ = word.partition(':=')
        if is_given and not name.startswith('_') and name not in known:
            refuse(os.path.basename(path), name, known)


def check_file(argument, path, robot):
    """Of the package's own robots, scene, motors and plant; what else is missing the node says that reads it."""
    own = os.path.realpath(path).startswith(os.path.realpath(ROBOTS) + os.sep)
    if os.path.exists(path) or not (own or argument in ('scene', 'rig', 'plant')):
        return
    if own and not os.path.isdir(os.path.join(ROBOTS, robot)):
        refuse('robot', robot, sorted(os.listdir(ROBOTS)))
    hint = '; `rosrun soft_robot_lab new_rig ROBOT.yaml` writes the files of a rig' if argument in RIG else ''
    sys.exit(f'{argument}: there is no file {path}{hint}')


def check_scene(given):
    """With the other files of the session, where there are any: a rig has to take the scene's commands."""
    command = ['rosrun', 'soft_robot_lab', 'check_scene_node', given['load']]
    for name, option in READ.items():
        if given.get(name):
            command += [option, given[name]]
    if subprocess.run(command, stdin=subprocess.DEVNULL, stdout=sys.stderr).returncode:
        sys.exit(f"scene: {given['load']} cannot be run so")


if len(sys.argv) < 2 or sys.argv[1] in ('-h', '--help'):
    print(__doc__, file=sys.stdout if len(sys.argv) > 1 else sys.stderr)
    sys.exit(0 if len(sys.argv) > 1 else 2)
robot, given = sys.argv[1], {}
for word in sys.argv[2:]:
    name, is_given, value = word.partition('=')
    if not is_given:
        sys.exit(f"check_arguments.py: '{word}' must be WORD=PATH")
    given[name] = value
    if name == 'cameras' and value not in CAMERAS:
        refuse(name, value, CAMERAS)
    if name == 'solver' and value and value not in SOLVERS:
        refuse(name, value, SOLVERS)
    if name in SWITCHES:
        if value not in ('True', 'False', '1', '0'):
            refuse(name, value, ('true', 'false'))
    elif name not in ('cameras', 'solver', 'load') and value:
        check_file(name, value, robot)
check_names()
if 'load' in given:
    check_scene(given)
print(robot, end='')
